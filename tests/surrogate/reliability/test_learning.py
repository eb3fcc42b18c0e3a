"""Active learning at the limit state."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from surrogate.reliability.learning import Known, candidates, enough, known, next_points

Array = np.ndarray


def process(u: Array) -> tuple[Array, Array]:
    """g = 4.5 - u1, known the better the nearer to the origin."""
    return 4.5 - u[:, 0], 0.02 * np.linalg.norm(u, axis=1)


def test_a_rare_failure_is_among_the_candidates() -> None:
    points = candidates(process, 2, samples=4000, seed=1)
    now = known(process, points)
    truth = stats.norm.sf(4.5)
    assert now.probability == pytest.approx(truth, rel=0.4)
    assert now.low < now.probability < now.high


def test_next_points_lie_at_the_limit_and_apart() -> None:
    chosen = next_points(process, candidates(process, 2, seed=1), runs=4)
    assert chosen.shape == (4, 2)
    assert np.abs(chosen[:, 0] - 4.5).max() < 0.1
    apart = np.linalg.norm(chosen[:, None] - chosen[None], axis=2)
    assert apart[np.triu_indices(4, 1)].min() >= 0.3


def test_enough_asks_for_narrow_bounds_and_a_still_index() -> None:
    sure = Known(1e-4, 0.95e-4, 1.05e-4)
    wide = Known(1e-4, 1e-5, 1e-3)
    moved = Known(2e-4, 1.9e-4, 2.1e-4)
    assert enough([sure] * 4)
    assert not enough([sure] * 3)
    assert not enough([sure, sure, sure, wide])
    assert not enough([moved, sure, sure, sure])
    assert not enough([Known(0.0, 0.0, 0.0)] * 4)
