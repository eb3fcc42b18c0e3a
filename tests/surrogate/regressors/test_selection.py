"""Selection of terms: recovery, heredity, groups, honesty."""

import numpy as np
import pytest
from sklearn.utils.estimator_checks import check_estimator

from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.fitting.fit import fit
from surrogate.regressors.polynomial import Quadratic
from surrogate.regressors.selection import SELECTED, Lasso, Stepwise
from surrogate.sensitivity.sobol import sobol
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(name, uniform(0, 1)) for name in "abcdef"))
LEVELS = Space(
    (
        Parameter("a", uniform(0, 1)),
        Parameter("cloth", levels=("p", "q", "r")),
        Parameter("b", uniform(0, 1)),
    )
)


def runs(n=60, noise=0.1, seed=0):
    x = SPACE.sample(n, seed=seed)
    y = 2 + 3 * x[:, 0] - 2 * x[:, 1] + 1.5 * x[:, 0] * x[:, 1] + x[:, 2] ** 2
    return x, y + noise * np.random.default_rng(seed).normal(size=n)


@pytest.mark.parametrize("model", [Stepwise(heredity=False), Stepwise(), Lasso()], ids=str)
def test_true_terms_are_among_the_selected(model):
    """The four true terms out of 28 are always found; stepwise adds at most eight."""
    x, y = runs()
    names = set(fit(SPACE, x, y, model).estimator.model_.names)
    assert {"1", "a", "b", "a:b", "c^2"} <= names
    assert len(names) < (14 if isinstance(model, Stepwise) else 28)


def test_without_noise_stepwise_finds_exactly_the_true_terms():
    x, y = runs(noise=0.0)
    fitted = fit(SPACE, x, y, Stepwise(heredity=False)).estimator
    assert fitted.model_.names == ("1", "a", "b", "a:b", "c^2")
    np.testing.assert_allclose(fitted.coef_, [2, 3, -2, 1.5, 1], atol=1e-12)


def test_heredity_brings_the_main_effects():
    """c^2 needs c, though c itself does nothing."""
    x, y = runs()
    names = fit(SPACE, x, y, Stepwise()).estimator.model_.names
    for name in names:
        parents = {part.removesuffix("^2") for part in name.split(":")} - {"1"}
        assert parents <= set(names)


def test_levels_enter_together():
    """One of three levels differs; both its columns enter."""
    x = LEVELS.sample(60, seed=1)
    y = x[:, 0] + np.where(x[:, 1] == 1.0, 2.0, 0.0)
    names = fit(LEVELS, x, y, Stepwise()).estimator.model_.names
    assert {"cloth[q]", "cloth[r]"} <= set(names)


def test_fewer_runs_than_candidates():
    """20 runs for 28 terms: the full quadratic cannot be fitted, the selected one predicts."""
    x, y = runs(20)
    new_x, new_y = runs(300, seed=5)
    predicted = fit(SPACE, x, y, Stepwise()).predict(new_x)
    assert 1 - np.mean((new_y - predicted) ** 2) / new_y.var() > 0.9


@pytest.mark.parametrize("model", [Stepwise(), Lasso()], ids=str)
def test_cross_validation_selects_anew(model):
    """On pure noise a fit that kept its terms would look good; Q2 must not."""
    scores = []
    for seed in range(5):
        x = SPACE.sample(40, seed=seed)
        fitted = fit(SPACE, x, np.random.default_rng(seed).normal(size=40), model)
        scores.append(fitted.q2)
    assert np.median(scores) < 0.1


def test_the_table_says_that_terms_were_selected():
    x, y = runs()
    table = fit(SPACE, x, y, Stepwise()).estimator.regression_table()
    assert SELECTED in table.attrs["notes"] and "a:b" in table["term"]


def test_sensitivity_can_refit_a_selected_polynomial():
    """Its terms are chosen anew in each resample: pairs bootstrap, not Student draws."""
    x, y = runs()
    table = sobol(fit(SPACE, x, y, Stepwise()), SPACE, draws=10)
    assert "bootstrap" in table.attrs["surrogate_part"]
    assert (table["total_surrogate"] >= 0).all()


def test_indices_agree_with_the_full_quadratic():
    x, y = runs(noise=0.0)
    ours = fit(SPACE, x, y, Stepwise(heredity=False)).estimator.sobol_indices()
    full = fit(SPACE, x, y, Quadratic()).estimator.sobol_indices()
    np.testing.assert_allclose(ours.total, full.total, atol=1e-10)


@pytest.mark.parametrize("model", [Stepwise(), Lasso()], ids=str)
def test_constant_output(model):
    x, _ = runs()
    fitted = fit(SPACE, x, np.full(60, 3.0), model)
    assert fitted.estimator.model_.names == ("1",)
    np.testing.assert_allclose(fitted.predict(x), 3.0)


def test_unknown_order():
    with pytest.raises(ValueError, match="did you mean 'quadratic'"):
        Stepwise(order="quadrtic").fit(*runs())


@pytest.mark.parametrize("model", [Stepwise(), Lasso()], ids=str)
def test_scikit_learn_contract(model):
    """scikit-learn's own conformance suite."""
    check_estimator(model, on_skip=None)


def test_rounding_does_not_choose_among_aliased_terms():
    """Resolution III: a:b, c:e and others are one column. The order of the runs says nothing."""
    space = Space(tuple(Parameter(name, uniform(0.0, 1.0)) for name in "abcdefg"))
    coded = fractional_factorial(space, resolution=3, center_points=3)
    rng = np.random.default_rng(0)
    for _ in range(4):
        noise = 0.1 * rng.standard_normal(len(coded))
        values = coded @ [3.0, 1.0, 0.0, 0.0, 0.2, 0.0, 0.0] + coded[:, 0] * coded[:, 1] + noise
        orders = [rng.permutation(len(coded)) for _ in range(4)]
        found = {
            tuple(Stepwise(space=space).fit(coded[order], values[order]).terms_) for order in orders
        }
        assert len(found) == 1
