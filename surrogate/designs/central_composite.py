"""Central composite: corners, star and centre, for quadratic models (Box and Wilson 1951).

The star lies at `alpha` times the distance of a corner's coordinate. Coded values end at
-1 and 1, so for alpha > 1 the design is inscribed: the star touches the ends of the
ranges and the corners lie at 1 / alpha. `face` (alpha = 1) has both at the ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surrogate.designs import regular_fraction
from surrogate.designs.axial_points import star
from surrogate.designs.center_points import centers
from surrogate.designs.minimum_aberration import fewest_runs
from surrogate.designs.requirements import affordable, choice, continuous, number, uncut
from surrogate.space.space import Space

ALPHAS = ("rotatable", "spherical", "face")
CUBES = ("full", "fraction")


def central_composite(
    space: Space,
    *,
    alpha: str | float = "rotatable",
    cube: str = "full",
    center_points: int = 1,
    seed: int | None = None,
) -> np.ndarray:
    """Coded (run, parameter): the cube, then the star, then centre points.

    alpha  rotatable: fourth root of the number of corners, so that the prediction variance
           depends on the distance from the centre only (Box and Hunter 1957);
           spherical: square root of the number of parameters; face: 1; or a number from 1 on
    cube   full: all 2^k corners; fraction: the smallest fraction of resolution V
    """
    continuous(space, "central_composite")
    corners = _corners(space, choice("cube", cube, CUBES))
    ratio = _ratio(alpha, *corners.shape)
    coded = np.vstack(
        [space.snap(corners / ratio), star(space, 1.0), centers(space, center_points)]
    )
    return uncut(space, coded, "central_composite")


def _corners(space: Space, cube: str) -> np.ndarray:
    k = space.size
    masks: Sequence[int] = [1 << i for i in range(k)]
    if cube == "fraction" and k >= 3:
        masks = fewest_runs(k, 5, k) or masks
    base = max(masks).bit_length()
    affordable(2**base, "central_composite", "use cube: fraction, d_optimal or latin_hypercube")
    return regular_fraction.matrix(masks, base)


def _ratio(alpha: str | float, runs: int, parameters: int) -> float:
    if not isinstance(alpha, str):
        return number("alpha", alpha, 1.0, 100.0)
    ratios: dict[str, float] = {
        "rotatable": float(runs) ** 0.25,
        "spherical": math.sqrt(parameters),
        "face": 1.0,
    }
    return ratios[choice("alpha", alpha, ALPHAS)]
