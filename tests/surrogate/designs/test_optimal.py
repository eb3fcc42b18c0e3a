import itertools

import numpy as np
import pytest

from surrogate.designs.criteria import Determinant, MeanVariance, log_determinant
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.model import Model
from surrogate.designs.optimal import a_optimal, d_optimal, d_optimal_more, i_optimal
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


@pytest.mark.parametrize("method", [a_optimal, i_optimal])
def test_weights_of_the_quadratic_in_one_parameter(cube, method):
    """A and I: a quarter of the runs at each end, half of them in the middle (Atkinson, Donev,
    Tobias 2007, section 11.4 and table 11.2); D takes thirds."""
    coded = method(cube(1), runs=8, model="quadratic", seed=0)
    assert np.unique(coded, return_counts=True)[1].tolist() == [2, 4, 2]
    thirds = d_optimal(cube(1), runs=9, model="quadratic", seed=0)
    assert np.unique(thirds, return_counts=True)[1].tolist() == [3, 3, 3]


@pytest.mark.parametrize("method, moments", [(a_optimal, False), (i_optimal, True)], ids=["a", "i"])
@pytest.mark.parametrize(
    "k, runs, model", [(1, 5, "quadratic"), (2, 5, "interactions"), (2, 4, ["A", "B", "A^2"])]
)
def test_no_design_on_the_same_values_is_better(cube, method, moments, k, runs, model):
    """Beside every design on the candidate values."""
    of = Model(cube(k), model)
    criterion = MeanVariance(of.moments() if moments else np.eye(of.size))
    points = list(itertools.product(*of.values))
    best = max(
        criterion.value(of.matrix(np.array(rows)))
        for rows in itertools.combinations_with_replacement(points, runs)
    )
    found = method(cube(k), runs=runs, model=model, seed=0)
    assert criterion.value(of.matrix(found)) == pytest.approx(best, abs=1e-9)


@pytest.mark.parametrize("criterion", ["d", "a", "i"])
def test_gains_are_those_of_the_exchange_done(mixed, criterion):
    """Formulas of rank two beside the criterion of the changed design."""
    model = Model(mixed, "interactions")
    made = {
        "d": Determinant(),
        "a": MeanVariance(np.eye(model.size)),
        "i": MeanVariance(model.moments()),
    }[criterion]
    rng = np.random.default_rng(3)
    coded = model.start(40, rng)
    matrix = model.matrix(coded)
    new = model.matrix(model.neighbours(coded[5]))
    gains = made.gains(new, matrix[5], np.linalg.inv(matrix.T @ matrix))
    for row, gain in zip(new, gains, strict=True):
        changed = np.vstack([matrix[:5], row, matrix[6:]])
        assert np.log(gain) == pytest.approx(made.value(changed) - made.value(matrix), abs=1e-9)


def test_moments_are_means_over_the_ranges(mixed):
    """Beside the mean over many points."""
    model = Model(mixed, "quadratic")
    points = np.column_stack(
        [
            np.random.default_rng(j).choice(p.coded_levels, 400_000)
            if p.categorical
            else np.random.default_rng(j).uniform(-1, 1, 400_000)
            for j, p in enumerate(mixed.parameters)
        ]
    )
    rows = model.matrix(points)
    np.testing.assert_allclose(model.moments(), rows.T @ rows / len(rows), atol=6e-3)


@pytest.mark.parametrize("k, runs", [(2, 12), (3, 16)])
def test_predictions_are_better_from_an_i_optimal_design(cube, k, runs):
    """Mean variance of a quadratic over the cube is a quarter lower than from D-optimal runs."""
    of = Model(cube(k), "quadratic")
    criterion = MeanVariance(of.moments())
    i, d = (m(cube(k), runs=runs, model="quadratic", seed=0) for m in (i_optimal, d_optimal))
    assert criterion.value(of.matrix(i)) > criterion.value(of.matrix(d)) + np.log(1.25)


def test_rows_that_are_added_count_those_that_are_there(cube):
    """Half of a 2^3 grown by four runs for the linear model: the other half, or its like."""
    there = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]])
    added = d_optimal_more(cube(3), there, runs=4, model="interactions", seed=0)
    both = Model(cube(3), "interactions").matrix(np.vstack([there, added]))
    np.testing.assert_allclose(both.T @ both, 8 * np.eye(7), atol=1e-12)
    with pytest.raises(DesignError, match="give at least 6"):
        d_optimal_more(cube(3), there, runs=2, model="quadratic")


@pytest.mark.parametrize(
    "model, said",
    [
        (["A", "Z"], "'Z' in term 'Z' is unknown"),
        (["A^x"], "power 'x'"),
        (["A^9"], "power '9'"),
    ],
)
def test_terms_that_mean_nothing(cube, model, said):
    """An unknown name, powers that are none."""
    with pytest.raises(DesignError, match=said):
        d_optimal(cube(3), runs=12, model=model)
