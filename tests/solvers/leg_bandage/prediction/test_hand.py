"""The bandager's hand: scatter of stretch and overlap, against what was measured."""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.prediction.hand import DRAWS, MEASURED, Hand


def test_scatter_is_that_of_the_measurement_it_is_taken_from():
    """34.65 +- 4.84 mmHg (Wounds 2020;32:353), 14 %: within 0.7 points, 1 / (1 - overlap) bends."""
    factors = Hand().factors(1.3)
    assert len(factors) == DRAWS
    assert MEASURED == pytest.approx(0.1397, abs=1e-4)
    assert factors.std() / factors.mean() == pytest.approx(MEASURED, abs=0.007)


def test_it_lies_among_other_measurements_of_two_layers():
    """Ehmann et al. 2023, B1 and C supine, one clinician: 5.3 / 50.1 to 13.4 / 73.7.

    Lee et al. 2006, one bandager and one leg: no standard deviation above 7 mmHg; here at
    40 mmHg, their bandages' ankle pressure.
    """
    scatter = Hand().factors(1.3).std()
    assert 5.3 / 50.1 < scatter < 13.4 / 73.7
    assert 40 * scatter < 7


def test_one_source_alone_is_its_own_law():
    """Overlap exact: (s - 1) / (1.3 - 1) is normal, 1.96 SD either way; and stretch exact."""
    low, high = Hand(0.03, 0.0).interval(1.3, 0.95)
    assert (low, high) == pytest.approx((-0.196, 0.196), abs=0.004)
    low, high = Hand(0.0, 0.05).interval(1.3, 0.95)
    ends = [0.5 / (0.5 + 1.96 * 0.05) - 1, 0.5 / (0.5 - 1.96 * 0.05) - 1]
    assert (low, high) == pytest.approx(ends, abs=0.004)
    assert Hand(0.0, 0.0).interval(1.3, 0.95) == (0.0, 0.0)


def test_less_stretch_scatters_more():
    """The same millimetres of stretch are a larger part of a slack bandage."""
    assert Hand().factors(1.15).std() > 1.3 * Hand().factors(1.3).std()
    np.testing.assert_array_equal(Hand().factors(1.3), Hand().factors(1.3))
