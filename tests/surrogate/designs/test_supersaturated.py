"""Supersaturated designs: bounds of E(s^2), published values, what they find."""

import itertools

import numpy as np
import pytest
import spaces

from surrogate.designs.supersaturated import mean_square, supersaturated
from surrogate.errors import DesignError
from surrogate.regressors.selection import Stepwise


def bound(n, m):
    """Nguyen 1996."""
    return n**2 * (m - n + 1) / ((m - 1) * (n - 1))


@pytest.mark.parametrize(("n", "m"), [(6, 10), (10, 18), (12, 22), (14, 26), (18, 34)])
def test_designs_of_lins_size_reach_the_bound(n, m):
    """Half a Hadamard matrix: 2 n - 2 columns of n runs, E(s^2) = n^2 / (2 n - 3)."""
    columns = supersaturated(spaces.cube(m), runs=n, starts=1, seed=1)
    assert bound(n, m) == pytest.approx(n**2 / (2 * n - 3))
    assert mean_square(columns) == pytest.approx(bound(n, m), rel=1e-12)
    assert np.abs(columns.sum(axis=0)).max() == 0.0 and (np.abs(columns) == 1.0).all()


@pytest.mark.parametrize("m", [6, 7, 8, 9])
def test_six_runs_have_the_best_of_all_columns(m):
    """All ways to take m of the ten different balanced columns of six runs."""
    halves = itertools.combinations(range(6), 3)
    columns = np.array(
        [[1.0 if k in half else -1.0 for k in range(6)] for half in halves if 0 in half]
    )
    best = min(mean_square(columns[list(own)].T) for own in itertools.combinations(range(10), m))
    found = mean_square(supersaturated(spaces.cube(m), runs=6, seed=1))
    assert found == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize(("n", "m"), [(12, 18), (12, 24), (14, 40), (20, 40)])
def test_other_sizes_are_near_the_bound(n, m):
    """No design lies below it; these lie above it by 15 % at most."""
    found = mean_square(supersaturated(spaces.cube(m), runs=n, starts=20, seed=1))
    assert bound(n, m) - 1e-9 <= found <= 1.15 * bound(n, m)


def test_no_two_columns_are_alike():
    columns = supersaturated(spaces.cube(20), runs=8, starts=20, seed=2)
    assert (np.abs(columns.T @ columns) - 8 * np.eye(20)).max() < 8


def test_few_effects_among_many_are_found():
    """3 of 22 parameters matter; 12 runs without noise."""
    columns = supersaturated(spaces.cube(22), runs=12, seed=3)
    y = 4.0 * columns[:, 2] - 3.0 * columns[:, 9] + 2.0 * columns[:, 17]
    model = Stepwise(order="linear").fit(columns, y)
    assert sorted(j for term in model.terms_ for j, _ in term)[:3] == [2, 9, 17]


def test_the_same_seed_gives_the_same_design():
    one, two = (supersaturated(spaces.cube(16), runs=10, starts=2, seed=5) for _ in range(2))
    assert (one == two).all()


@pytest.mark.parametrize(
    ("size", "runs", "told"),
    [
        (12, 7, "7 must be even"),
        (10, 12, "enough to estimate all 10 main effects; use plackett_burman"),
        (12, 6, "6 have only 10 different columns for 12 parameters"),
    ],
)
def test_mistakes_are_told(size, runs, told):
    with pytest.raises(DesignError, match=told):
        supersaturated(spaces.cube(size), runs=runs)
