"""Definitive screening: main effects clear of all interactions and squares, in 2 k + 1 runs.

Jones and Nachtsheim 2011 (doi 10.1080/00224065.2011.11917841): a conference matrix, its mirror
and a centre run (Xiao, Lin and Bai 2012, doi 10.1080/00224065.2012.11917906). Each parameter
has three levels, so that curvature is seen and its parameter told. Parameters of two levels:
Jones and Nachtsheim 2013 (doi 10.1080/00224065.2013.11917921).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.conference import conference
from surrogate.designs.criteria import log_determinant
from surrogate.designs.requirements import affordable, two_level, uncut, whole
from surrogate.space.space import Parameter, Space

Array = NDArray[np.float64]

#: Fewer columns leave squares confounded with interactions.
FEWEST = 4
#: Random signs from which the search for those of two-level parameters starts.
STARTS = 20


def definitive_screening(space: Space, *, fake_factors: int = 0, seed: int | None = None) -> Array:
    """Coded (run, parameter): rows in mirrored pairs, the last the centre; two of it with levels.

    fake_factors: columns of the conference matrix that no parameter takes; each adds two runs
    and a degree of freedom for the error (Jones and Nachtsheim 2017,
    doi 10.1080/00401706.2016.1234979). Orders without a conference matrix take the next one.
    """
    two_level(space, "definitive_screening")
    columns = max(FEWEST, space.size + whole("fake_factors", fake_factors, 0))
    affordable(2 * columns * space.size, "definitive_screening", "use plackett_burman")
    half = conference(columns)[:, : space.size]
    two = np.array([_two(parameter) for parameter in space.parameters])
    half = np.vstack([half, np.zeros((1, space.size))])
    if two.any():
        half = _signed(half, two)
    pairs = np.stack([half, -half], axis=1).reshape(-1, space.size) + 0.0
    coded = pairs if two.any() else pairs[:-1]
    return uncut(space, space.snap(coded), "definitive_screening")


def _two(parameter: Parameter) -> bool:
    """Whether a parameter has two values only, and so no middle."""
    return parameter.categorical or (parameter.allowed is not None and len(parameter.allowed) == 2)


def _signed(half: Array, two: NDArray[np.bool_]) -> Array:
    """The half with -1 or 1 for the zeros of two-level columns, best for the main effects.

    Signs that raise det(F'F) are changed one at a time, from several starts. Mirrored pairs
    stay pairs, so that main effects stay clear of interactions and squares.
    """
    rng = np.random.default_rng(0)
    free = np.argwhere((half == 0.0) & two)
    found = []
    for _ in range(STARTS):
        one = half.copy()
        one[tuple(free.T)] = rng.choice([-1.0, 1.0], size=len(free))
        while any([_raised(one, tuple(place)) for place in free]):
            pass
        found.append(one)
    return max(found, key=log_determinant)


def _raised(half: Array, place: tuple[int, ...]) -> bool:
    """Change the sign at a place, if that raises the determinant; True when it did."""
    before = log_determinant(half)
    half[place] *= -1.0
    if log_determinant(half) > before + 1e-9:
        return True
    half[place] *= -1.0
    return False
