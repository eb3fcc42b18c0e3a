"""Sobol' indices of integers and listed values integrate the discrete law."""

import numpy as np
import pytest

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.fitting.fit import fit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Quadratic
from surrogate.sensitivity.morris import morris
from surrogate.sensitivity.pawn import pawn
from surrogate.sensitivity.shapley import shapley
from surrogate.sensitivity.sobol import sobol
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(
    (
        Parameter("n", integers((1, 4))),
        Parameter("pipe", listed([1, 2, 6])),
        Parameter("x", uniform(0.0, 3.0)),
    )
)
VALUES = (np.arange(1.0, 5.0), np.array([1.0, 2.0, 6.0]))


def model(coded):
    """n^2 + 2 pipe + x."""
    physical = SPACE.decode(coded)
    return physical["n"] ** 2 + 2.0 * physical["pipe"] + physical["x"]


#: Var of each term: over 1, 4, 9, 16; over 2, 4, 12; of U(0, 3).
PARTS = np.array([np.var(VALUES[0] ** 2), np.var(2.0 * VALUES[1]), 9.0 / 12.0])
EXACT = PARTS / PARTS.sum()


def fitted(estimator):
    coded = latin_hypercube(SPACE, runs=48, seed=2)
    return fit(SPACE, coded, model(coded), estimator, surrogate="tested")


@pytest.mark.parametrize(
    "estimator, within",
    [(Quadratic(), 1e-9), (PolynomialChaos(), 1e-9), (GaussianProcess(), 1e-3)],
)
def test_closed_forms_are_those_of_the_discrete_law(estimator, within):
    found = sobol(fitted(estimator), SPACE, draws=10)
    assert found.attrs["computed"] == "closed form"
    for name in ("first_order", "total"):
        assert found[name].values[0] == pytest.approx(EXACT, abs=within)


def test_sampled_indices_are_too():
    found = sobol(model, SPACE, samples=2**12)
    assert found["total"].values[0] == pytest.approx(EXACT, abs=2e-3)
    effects = shapley(model, SPACE, samples=2**11)
    assert effects["shapley"].values[0] == pytest.approx(EXACT, abs=5e-3)


@pytest.mark.parametrize("method", [morris, pawn])
def test_other_methods_take_discrete_inputs(method):
    found = method(fitted(Quadratic()), SPACE, draws=4)
    assert all(np.isfinite(found[name]).all() for name in found.data_vars if name != "refused")


def test_surrogates_with_two_values_are_not_singular():
    """A square of two values is the constant: no term of the quadratic, nor of the chaos."""
    space = Space((Parameter("n", integers((1, 2))), Parameter("x", uniform(0.0, 1.0))))
    coded = latin_hypercube(space, runs=12, seed=0)
    for estimator in (Quadratic(), PolynomialChaos(), GaussianProcess()):
        found = fit(space, coded, coded[:, 0] + coded[:, 1] ** 2, estimator, surrogate="tested")
        assert found.predict(coded) == pytest.approx(coded[:, 0] + coded[:, 1] ** 2, abs=1e-2)
    assert Quadratic().minimum_runs(space) == 5
