"""Mixed model: a published split-plot table, recovery of variances, tests at their level."""

import numpy as np
import pytest

from surrogate.errors import FitError, StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.mixed_model import MixedModel
from surrogate.regressors.polynomial import Linear
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.study import Study

#: Tensile strength of paper: replicates x preparation methods x temperatures.
PAPER = np.array(
    [
        [[30, 35, 37, 36], [34, 41, 38, 42], [29, 26, 33, 36]],
        [[28, 32, 40, 41], [31, 36, 42, 40], [31, 30, 32, 40]],
        [[31, 37, 41, 40], [35, 40, 39, 44], [32, 34, 39, 45]],
    ],
    dtype=float,
)


def levels(name, count):
    return Parameter(name, levels=tuple(f"{name}{k}" for k in range(count)))


def test_the_paper_experiment_of_montgomery():
    """Design and Analysis of Experiments, table 14.16: mean squares 9.07 on 4 degrees of freedom
    between whole plots and 3.97 on 18 within them, so s_u^2 = (9.07 - 3.97) / 4."""
    names = {"rep": 3, "method": 3, "temperature": 4, "plot": 9}
    space = Space(tuple(levels(*one) for one in names.items()))
    rep, method, temperature = (one.ravel() for one in np.indices(PAPER.shape))
    index = [rep, method, temperature, 3 * rep + method]
    coded = np.column_stack(
        [p.coded_levels[k] for p, k in zip(space.parameters, index, strict=True)]
    )
    own = _Split("plot", space=space).fit(coded, PAPER.ravel())
    assert own.within_**2 == pytest.approx(3.97, abs=0.005)
    assert own.between_**2 == pytest.approx((9.07 - 3.97) / 4, abs=0.005)
    assert own.freedoms == (4, 18)


class _Split(MixedModel):
    """Montgomery's model: replicates, methods, temperatures, and methods with temperatures."""

    def select(self, values, y):
        of = [column.parameter for column in self.columns_]
        mains = [(), *(((j, 1),) for j, p in enumerate(of) if p < 3)]
        pairs = [
            ((i, 1), (j, 1)) for i, p in enumerate(of) for j, q in enumerate(of) if (p, q) == (1, 2)
        ]
        return mains + pairs


SPACE = Space((Parameter("a", uniform(-1, 1)), Parameter("b", uniform(-1, 1)), levels("batch", 20)))


def split_plot(seed, between=1.0, within=0.5, effect=0.0):
    """20 batches of 6 runs: a is set once a batch, b in each run."""
    r = np.random.default_rng(seed)
    batch = np.repeat(np.arange(20), 6)
    a, b = r.choice([-1.0, 1.0], 20)[batch], np.tile([-1.0, 1.0], 60)
    coded = np.column_stack([a, b, SPACE["batch"].coded_levels[batch]])
    y = effect * a + 0.3 * b + between * r.normal(size=20)[batch] + within * r.normal(size=120)
    return coded, y


def test_both_variances_are_recovered():
    """Over 60 samples: s_u = 1 and s_e = 0.5, in the mean of the variances."""
    found = [MixedModel("batch", space=SPACE).fit(*split_plot(seed)) for seed in range(60)]
    assert np.mean([one.between_**2 for one in found]) == pytest.approx(1.0, abs=0.15)
    assert np.mean([one.within_**2 for one in found]) == pytest.approx(0.25, rel=0.05)


def test_whole_plot_terms_are_tested_at_their_level():
    """No effect of a: p below 5 % in 5 % of 200 samples; least squares finds one far too often."""
    mixed, plain = [], []
    for seed in range(200):
        coded, y = split_plot(seed)
        table = MixedModel("batch", space=SPACE).fit(coded, y).regression_table()
        mixed.append(float(table["p"].sel(term="a")) < 0.05)
        if seed < 40:
            alone = Linear(Space(SPACE.parameters[:2])).fit(coded[:, :2], y)
            plain.append(float(alone.regression_table()["p"].sel(term="a")) < 0.05)
    assert 0.01 <= np.mean(mixed) <= 0.09
    assert np.mean(plain) > 0.2


def test_equal_batches_give_least_squares():
    """Without scatter between batches the estimate of s_u is zero or small."""
    coded, y = split_plot(3, between=0.0)
    own = MixedModel("batch", space=SPACE).fit(coded, y)
    plain = Linear(Space(SPACE.parameters[:2])).fit(coded[:, :2], y)
    assert own.between_ < 0.2
    assert own.coef_ == pytest.approx(plain.coef_, abs=0.02)


def test_predictions_are_of_a_new_batch():
    coded, y = split_plot(1)
    own = fit(SPACE, coded, y, MixedModel("batch"))
    moved = coded.copy()
    moved[:, 2] = SPACE["batch"].coded_levels[0]
    assert (own.predict(moved) == own.predict(coded)).all()
    assert own.rmse == pytest.approx(np.sqrt(1.25), rel=0.35)


def test_notes_tell_both_scatters():
    notes = MixedModel("batch", space=SPACE).fit(*split_plot(0)).regression_table().attrs["notes"]
    assert "between levels of batch" in notes and "(1, a) are tested with 18 degrees" in notes


@pytest.mark.parametrize("random", ["a", "machine"])
def test_a_parameter_without_levels_is_refused(random):
    with pytest.raises(FitError, match=f"random: '{random}' is no parameter with levels.*batch"):
        fit(SPACE, *split_plot(0), MixedModel(random))


def test_single_runs_of_each_level_are_refused():
    coded, y = split_plot(0)
    with pytest.raises(FitError, match="20 levels of batch in 20 runs"):
        MixedModel("batch", space=SPACE).fit(coded[::6], y[::6])


def test_a_study_tells_it_before_any_run():
    words = {
        "study": "demo",
        "solver": "ishigami",
        "parameters": {"X1": [-1, 1], "X2": [-1, 1]},
        "designs": {"train": {"method": "latin_hypercube", "runs": 20, "seed": 1}},
        "surrogates": {"mixed": {"method": "mixed_model", "options": {"random": "X1"}}},
    }
    with pytest.raises(StudyError, match="surrogates.mixed.options: random: 'X1' is no parameter"):
        Study.from_mapping(words)
