"""Ranks that intervals leave open."""

import numpy as np
import pytest

from surrogate.sensitivity.ranks import sentence, ties


def given(*rows):
    return map(np.array, zip(*rows, strict=True))


@pytest.mark.parametrize(
    "rows, expected",
    [
        ([(0.5, 0.4, 0.6), (0.2, 0.1, 0.3)], []),
        ([(0.2, 0.1, 0.3), (0.5, 0.25, 0.6)], [[1, 0]]),
        ([(0.5, 0.4, 0.6), (0.3, 0.2, 0.45), (0.1, 0.05, 0.21), (0.02, 0.01, 0.04)], [[0, 1, 2]]),
        ([(0.5, 0.4, 0.6), (0.001, 0.0, 0.002), (0.0, 0.0, 0.003)], []),
        ([(np.nan, np.nan, np.nan), (0.5, 0.4, 0.6)], []),
    ],
)
def test_ties(rows, expected):
    """Apart, meeting, in a chain, too small to matter, unknown."""
    assert ties(*given(*rows)) == expected


def test_sentence():
    """Each run of ties is listed; none, no sentence."""
    rows = [(0.4, 0.3, 0.5), (0.35, 0.3, 0.4), (0.1, 0.08, 0.12), (0.09, 0.08, 0.1)]
    said = sentence(["a", "b", "c", "d"], "total index", *given(*rows))
    assert said == "The order of a and b; of c and d by total index is open: their intervals meet."
    assert sentence(["a", "b"], "total index", *given(rows[0], rows[2])) == ""
