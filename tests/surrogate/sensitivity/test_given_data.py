"""First-order indices from a table of runs: truth, coverage, zero, levels, fields, the study."""

import numpy as np
import pytest
from reader import read

from surrogate.cli import results
from surrogate.errors import StudyError
from surrogate.sensitivity.given_data import Runs, given_data
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.study import Study

SPACE = Space(tuple(Parameter(name, uniform(-1, 1)) for name in "abcd"))
#: Ishigami and Homma 1990, a = 7, b = 0.1; the fourth input has no effect.
ISHIGAMI = np.array([0.3139, 0.4424, 0.0, 0.0])


def ishigami(x):
    a, b, c = np.pi * x[:, :3].T
    return np.sin(a) + 7.0 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)


def plane(x):
    """Shares 0.8, 0.2, 0, 0."""
    return x[:, 0] + 0.5 * x[:, 1]


def found(f, n, seed, **options):
    x = np.random.default_rng(seed).uniform(-1, 1, (n, 4))
    return given_data(Runs("y", x, f(x)), SPACE, **options).isel(output=0)


@pytest.mark.parametrize(
    ("f", "truth"), [(ishigami, ISHIGAMI), (plane, np.array([0.8, 0.2, 0.0, 0.0]))]
)
@pytest.mark.parametrize("n", [60, 200, 1000])
def test_intervals_hold_the_truth_and_zero(f, truth, n):
    """Over 60 samples: 95 % intervals hold each index in 87 % and more, estimates are centred."""
    held, mean = np.zeros(4), np.zeros(4)
    for seed in range(60):
        table = found(f, n, seed)
        low, high = table["first_order_low"].values, table["first_order_high"].values
        held += (low <= truth) & (truth <= high)
        mean += table["first_order"].values / 60
    assert (held >= 52).all() and (held[2:] >= 57).all()
    # Estimates below zero are shown as zero, so those of inputs without effect are above it.
    assert mean[:2] == pytest.approx(truth[:2], abs=0.045 if n == 60 else 0.02)


def test_intervals_shrink_as_the_root_of_the_runs():
    few, many = (found(plane, n, 1)["first_order_sampling"].values[1] for n in (250, 4000))
    assert few / many == pytest.approx(4.0, rel=0.2)


def test_levels_are_compared_by_their_means():
    """Of y = [0, 0, 3][level] + x: between means 2, within 1/3 (one-way analysis of variance)."""
    r = np.random.default_rng(3)
    space = Space((Parameter("kind", levels=("p", "q", "r")), Parameter("x", uniform(-1, 1))))
    coded = np.column_stack([r.integers(-1, 2, 3000), r.uniform(-1, 1, 3000)]).astype(float)
    y = 3.0 * (coded[:, 0] == 1.0) + coded[:, 1]
    table = given_data(Runs("y", coded, y), space).isel(output=0)
    assert table["first_order"].values == pytest.approx([2 / (7 / 3), 1 / 7], abs=0.03)


def test_a_field_has_the_index_of_its_components_weighted_by_variance():
    x = np.random.default_rng(0).uniform(-1, 1, (2000, 4))
    y = np.stack([2.0 * x[:, 0], x[:, 1]], axis=1)
    table = given_data(Runs("y", x, y), SPACE).isel(output=0)
    assert table["first_order"].values == pytest.approx([0.8, 0.2, 0.0, 0.0], abs=0.02)


def test_failures_have_indices_of_their_own():
    """[a > 0.5] depends on a alone; p = 1/4."""
    table = found(plane, 4000, 2, above=0.75)
    other = found(lambda x: (plane(x) > 0.75).astype(float), 4000, 2)
    assert table["first_order"].values == pytest.approx(other["first_order"].values, abs=1e-12)
    assert table.attrs["event"] == "above 0.75"


def test_an_output_that_rests_has_no_indices():
    table = found(lambda x: np.full(len(x), 3.0), 50, 0)
    assert (table["first_order"].values == 0.0).all()


@pytest.mark.parametrize(
    ("n", "options", "told"),
    [
        (19, {}, "needs 20 runs or more, but y has 19"),
        (40, {"harmonics": 21}, "harmonics: 21 is not between 1 and 20"),
        (40, {"above": 1.0, "below": 0.0}, "give above: or below:, not both"),
    ],
)
def test_mistakes_are_told(n, options, told):
    with pytest.raises(StudyError, match=told):
        found(plane, n, 0, **options)


STUDY = {
    "study": "demo",
    "solver": "ishigami",
    "parameters": {name: [-3.14159265, 3.14159265] for name in ("X1", "X2", "X3")},
    "designs": {"train": {"method": "sobol", "runs": 1024, "seed": 1}},
    "sensitivity": "given_data",
}


def test_a_study_needs_no_surrogate_for_it(tmp_path):
    study = Study.from_mapping(STUDY)
    runs = study.run(results=tmp_path / "demo", workers=1)
    done = results.analyse(study, tmp_path / "demo", runs)
    table = done.summary["sensitivity"]
    assert table["first_order"]["values"][0] == pytest.approx(ISHIGAMI[:3], abs=0.05)
    page = read(done.report.read_text())
    assert any("regression on ranks of 1024 runs" in one.text for one in page.all("p"))


def test_a_surrogate_beside_it_is_refused():
    words = {**STUDY, "surrogates": {"gp": "gaussian_process"}}
    words["sensitivity"] = {"method": "given_data", "surrogate": "gp"}
    with pytest.raises(StudyError, match="given_data reads the runs and no surrogate"):
        Study.from_mapping(words)
