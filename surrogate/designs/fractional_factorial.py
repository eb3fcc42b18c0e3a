"""Fractional factorial: 2^(k - p) of the 2^k corners, by resolution, run count or generators.

Resolution III: main effects are free of each other; IV: also of two-factor interactions;
V: two-factor interactions are free of each other too (Box and Hunter 1961).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from surrogate.designs import generators as products
from surrogate.designs import regular_fraction
from surrogate.designs.blocks import block_numbers, block_parameter
from surrogate.designs.center_points import centers
from surrogate.designs.minimum_aberration import fewest_runs, fraction
from surrogate.designs.requirements import affordable, two_level, uncut, whole
from surrogate.errors import DesignError
from surrogate.space.space import Space

ROMAN = {"III": 3, "IV": 4, "V": 5, "VI": 6, "VII": 7, "VIII": 8}
LARGEST_BASE = 14


def fractional_factorial(
    space: Space,
    *,
    resolution: int | str | None = None,
    runs: int | None = None,
    generators: list[str] | None = None,
    blocks: str | None = None,
    center_points: int = 0,
    seed: int | None = None,
) -> np.ndarray:
    """Regular two-level fraction; coded (run, parameter) with centre points at its end.

    Give one of
    resolution   smallest fraction with at least this resolution, 3 or more, or III, IV, V
    runs         fraction of the least aberration with this power of two of runs
    generators   ["D = AB", "E = AC"] by position, or "length = tension * mu_skin" by name
    Besides
    blocks       a parameter with 2, 4, 8, .. levels (days, batches, machines): runs are divided
                 among them so that no main effect and as few two-factor interactions as can be
                 are confounded with differences between blocks, and stand block by block
    `surrogate.designs.aliasing.aliasing` tells what is confounded with what.
    """
    if blocks is not None:
        return _in_blocks(space, blocks, center_points, resolution, runs, generators)
    coded = _corners(space, resolution, runs, generators)
    coded = np.vstack([coded, centers(space, center_points)])
    return uncut(space, coded, "fractional_factorial")


def _in_blocks(space: Space, blocks: str, center_points: int, *given: Any) -> np.ndarray:
    """The fraction of the other parameters, and the block of each run as the level of this one."""
    own = block_parameter(space, blocks)
    others = Space(tuple(p for p in space.parameters if p.name != blocks))
    corners = _corners(others, *given)
    levels = space[blocks].coded_levels
    block = block_numbers(corners, len(levels))
    coded = np.insert(corners, own, levels[block], axis=1)[np.argsort(block, kind="stable")]
    coded = np.vstack([coded, centers(space, center_points)])
    return uncut(space, coded, "fractional_factorial")


def _corners(space: Space, resolution: Any, runs: Any, generators: Any) -> np.ndarray:
    two_level(space, "fractional_factorial")
    given = [option for option in (resolution, runs, generators) if option is not None]
    if len(given) != 1:
        raise DesignError(
            "fractional_factorial: give one of resolution, runs and generators "
            f"({len(given)} given); resolution: 4 is a good start"
        )
    if generators is not None:
        return _by_generators(space, generators)
    masks = _by_resolution(space, resolution) if runs is None else _by_runs(space, runs)
    return regular_fraction.matrix(masks, max(masks).bit_length())


def _by_resolution(space: Space, resolution: Any) -> tuple[int, ...]:
    wanted = whole("resolution", ROMAN.get(str(resolution).upper(), resolution), 3)
    if space.size < 3:
        return fraction(space.size, space.size)
    masks = fewest_runs(space.size, min(wanted, space.size + 1), LARGEST_BASE)
    if masks is None:
        raise DesignError(
            f"resolution: {wanted} for {space.size} parameters needs more than "
            f"{2**LARGEST_BASE:,} runs; lower the resolution, or use d_optimal "
            "or latin_hypercube"
        )
    return masks


def _by_runs(space: Space, runs: Any) -> tuple[int, ...]:
    base = whole("runs", runs, 1).bit_length() - 1
    least = space.size.bit_length()
    most = min(space.size, LARGEST_BASE)
    if runs != 2**base or not min(least, most) <= base <= most:
        sizes = ", ".join(str(2**b) for b in range(min(least, most), most + 1))
        raise DesignError(
            f"runs: {runs} is not the size of a two-level fraction of "
            f"{space.size} parameters; use one of {sizes}"
        )
    return fraction(space.size, base)


def _by_generators(space: Space, generators: Any) -> np.ndarray:
    made = products.read(generators, space.names)
    affordable(2 ** (space.size - len(made)), "fractional_factorial", "give more generators")
    return products.matrix(made, space.names)
