"""Goals: where targets end, and what desirabilities are worth."""

import numpy as np
import pytest

from surrogate.solving.goals import Desire, Target, overall


def test_a_target_without_ends_counts_as_hit_within_a_twentieth_of_the_output():
    assert Target("y", 40.0).ends(20.0) == (39.0, 41.0)
    assert Target("y", 40.0, 38.0, 45.0).ends(20.0) == (38.0, 45.0)


def test_desirability_is_that_of_derringer_and_suich():
    """Their one-sided and two-sided functions, by hand."""
    large = Desire("y", "maximise", 60.0, 95.0, exponent=2.0)
    assert large.of(np.array([50.0, 60.0, 77.5, 95.0, 99.0])) == pytest.approx(
        [0.0, 0.0, 0.25, 1.0, 1.0]
    )
    small = Desire("c", "minimise", 10.0, 30.0)
    assert small.of(np.array([5.0, 10.0, 25.0, 30.0])) == pytest.approx([1.0, 1.0, 0.25, 0.0])
    near = Desire("t", "target", 35.0, 47.0, 41.0, exponent=0.5)
    assert near.of(np.array([35.0, 38.0, 41.0, 44.0, 48.0])) == pytest.approx(
        [0.0, 0.5**0.5, 1.0, 0.5**0.5, 0.0]
    )


def test_overall_desirability_is_the_weighted_geometric_mean():
    desires = (
        Desire("y", "maximise", 0.0, 1.0, importance=3.0),
        Desire("c", "minimise", 0.0, 1.0),
    )
    values = {"y": np.array([0.5, 0.0]), "c": np.array([0.2, 0.5])}
    assert overall(desires, values) == pytest.approx([(0.5**3 * 0.8) ** 0.25, 0.0])
