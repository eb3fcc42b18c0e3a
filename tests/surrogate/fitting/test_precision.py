"""Standard errors, variance inflation, power and confounding, before anything is run."""

import numpy as np
import pytest
import spaces
from scipy import stats

from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.model import Model
from surrogate.fitting.precision import precision


@pytest.fixture
def cube():
    """cube(k): k uniform parameters."""
    return spaces.cube


@pytest.fixture
def mixed():
    """Two ranges, a two-level and a three-level categorical parameter."""
    return spaces.mixed()


def test_an_orthogonal_design_of_two_levels(cube):
    """Errors sigma / sqrt(n), no inflation."""
    found = precision(Model(cube(4), "interactions"), full_factorial(cube(4)))
    np.testing.assert_allclose(found.error, 0.25)
    np.testing.assert_allclose(found.inflation[1:], 1.0)
    assert (found.runs, found.freedom, found.confounded) == (16, 5, ())


def test_power_is_the_share_of_experiments_that_find_the_effect(cube):
    """20 000 simulated experiments, t-tests of the coefficient: within 4 standard errors."""
    coded = latin_hypercube(cube(3), runs=14, seed=1)
    model = Model(cube(3), "linear")
    found = precision(model, coded, effect=2.0)
    matrix = model.matrix(coded)
    rng, count = np.random.default_rng(0), 20_000
    y = matrix[:, [1]] * 1.0 + rng.standard_normal((14, count))
    beta, rest, *_ = np.linalg.lstsq(matrix, y, rcond=None)
    t = beta[1] / (np.sqrt(rest / found.freedom) * found.error[1])
    share = (np.abs(t) > stats.t.isf(0.025, found.freedom)).mean()
    error = np.sqrt(share * (1 - share) / count)
    assert found.power[1] == pytest.approx(share, abs=4 * error)
    assert 0.3 < share < 0.999


def test_inflation_is_that_of_the_other_columns(cube):
    """1 / (1 - R2) of each column on the others (Montgomery 2012, section 10.5)."""
    coded = np.random.default_rng(3).uniform(-1, 1, (20, 3))
    found = precision(Model(cube(3), "quadratic"), coded)
    matrix = Model(cube(3), "quadratic").matrix(coded)
    for j in range(1, 10):
        others = np.delete(matrix, j, axis=1)
        left = matrix[:, j] - others @ np.linalg.lstsq(others, matrix[:, j], rcond=None)[0]
        total = ((matrix[:, j] - matrix[:, j].mean()) ** 2).sum()
        assert found.inflation[j] == pytest.approx(total / (left @ left))


def test_what_cannot_be_told_apart(cube):
    """The half fraction of four: pairs of interactions; squares are the constant."""
    coded = fractional_factorial(cube(4), resolution=4)
    found = precision(Model(cube(4), "quadratic"), coded)
    assert set(found.confounded) == {
        "B:C = A:D",
        "B:D = A:C",
        "C:D = A:B",
        "A^2 = 1",
        "B^2 = 1",
        "C^2 = 1",
        "D^2 = 1",
    }
    assert found.freedom == 0 and np.isnan(found.power).all()


def test_levels_have_names(mixed):
    """A column a level but the last."""
    names = [name for name, _ in Model(mixed, "linear").named]
    assert names == [
        "1",
        "tension",
        "bandage[biflex_16]",
        "posture[lying]",
        "posture[sitting]",
        "mu",
    ]
