import numpy as np
import pytest

from surrogate.designs.d_optimal import Model, d_optimal, log_determinant
from surrogate.designs.full_factorial import full_factorial
from surrogate.errors import DesignError


def efficiency(space, coded, model):
    """D-efficiency |F'F|^(1/p) / N; 1 is an orthogonal two-level design."""
    F = Model(space, model).matrix(coded)
    return np.exp(log_determinant(F) / F.shape[1]) / len(coded)


@pytest.mark.parametrize(
    "k, runs, model",
    [
        (7, 8, "linear"),
        (11, 12, "linear"),
        (3, 4, "linear"),
        (5, 16, "interactions"),
        (4, 16, "interactions"),
    ],
)
def test_finds_orthogonal_designs_where_they_exist(cube, k, runs, model):
    """Hadamard's bound: |F'F| <= N^p, reached by orthogonal arrays.

    One start in fifteen finds that of order 12.
    """
    coded = d_optimal(cube(k), runs=runs, model=model, starts=60, seed=1)
    assert efficiency(cube(k), coded, model) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("runs, determinant", [(3, 4), (5, 48), (6, 160), (7, 576)])
def test_maximal_determinants_of_saturated_designs(cube, runs, determinant):
    """Largest determinant of an N x N matrix of -1 and 1: 4, 48, 160, 576 for N = 3, 5, 6, 7
    (Williamson 1946); F is square for N - 1 parameters."""
    coded = d_optimal(cube(runs - 1), runs=runs, model="linear", starts=60, seed=0)
    matrix = Model(cube(runs - 1), "linear").matrix(coded)
    assert abs(np.linalg.det(matrix)) == pytest.approx(determinant, rel=1e-9)


def test_quadratic_in_two_parameters_and_nine_runs_is_the_3_by_3_grid(cube):
    """Box and Draper 1971: the exact D-optimal 9-run design is the 3^2 factorial."""
    coded = d_optimal(cube(2), runs=9, model="quadratic", seed=1)
    grid = full_factorial(cube(2), levels=3)
    assert set(map(tuple, coded)) == set(map(tuple, grid))


def test_better_than_random_points(cube):
    """Quadratic in 4 parameters, 20 runs: above every one of 300 random designs."""
    rng = np.random.default_rng(0)
    coded = d_optimal(cube(4), runs=20, model="quadratic", seed=0)
    random = max(efficiency(cube(4), rng.uniform(-1, 1, (20, 4)), "quadratic") for _ in range(300))
    assert efficiency(cube(4), coded, "quadratic") > 2 * random


def test_levels(mixed):
    """All levels appear, and the model with their effects is estimable."""
    coded = d_optimal(mixed, runs=12, model="linear", seed=0)
    assert set(mixed.decode(coded)["posture"]) == {"lying", "sitting", "standing"}
    assert Model(mixed, "linear").size == 1 + 1 + 1 + 2 + 1
    assert np.isfinite(log_determinant(Model(mixed, "linear").matrix(coded)))
    posture = np.unique(coded[:, 2], return_counts=True)[1]
    assert posture.tolist() == [4, 4, 4]


def test_seed(cube):
    """Same seed, same points."""
    first, second = (d_optimal(cube(3), runs=11, model="quadratic", seed=4) for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(
    "options, said",
    [
        ({"runs": 9, "model": "quadratic"}, "runs: 9 cannot estimate the 10 terms"),
        ({"runs": 9, "model": "cubic"}, "model: 'cubic'"),
        ({"runs": 9, "starts": 0}, "starts: 0"),
    ],
)
def test_mistakes(cube, options, said):
    """Too few runs for the model, unknown model, no starts."""
    with pytest.raises(DesignError, match=said):
        d_optimal(cube(3), **options)


def test_unbounded_is_refused(unbounded):
    """Ends of the range are needed."""
    with pytest.raises(DesignError, match="c10"):
        d_optimal(unbounded, runs=9)


@pytest.mark.parametrize("k, runs, model", [(3, 12, "quadratic"), (5, 20, "interactions")])
def test_rounding_does_not_choose_among_equal_designs(cube, k, runs, model, monkeypatch):
    """Processors round differently in the last digit; the same seed must give the same runs."""
    exact, rng = np.linalg.inv, np.random.default_rng(0)
    expected = d_optimal(cube(k), runs=runs, model=model, starts=10, seed=1)
    monkeypatch.setattr(
        np.linalg, "inv", lambda a: exact(a) * (1.0 + 2e-16 * rng.standard_normal(a.shape))
    )
    for _ in range(3):
        again = d_optimal(cube(k), runs=runs, model=model, starts=10, seed=1)
        np.testing.assert_array_equal(again, expected)
