"""Candidate points of a region: of the grid, inside, and at its edges and corners."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from surrogate.space.region import Region
from surrogate.space.space import Space

Coded = NDArray[np.float64]

#: Points of the grid that are tried at most, points inside, and halvings towards an edge.
GRID, INSIDE, HALVINGS = 4096, 400, 40
#: How often points are pushed along each parameter: the second time from edges to corners.
PASSES = 2


def feasible_candidates(space: Space, values: Sequence[Coded]) -> Coded:
    """Different points (candidate, parameter) that keep the constraints of the space.

    Points of the grid of `values`; random ones; and these pushed along one parameter after the
    other as far as the region goes, which ends at the corners of linear constraints.
    """
    region = space.region
    assert region is not None
    rng = np.random.default_rng(0)
    grid, kept = region.moved(_grid(values, rng))
    inside = space.sample(INSIDE, seed=0)
    parts = [grid[kept], inside, _pushed(space, region, inside, rng)]
    found = np.concatenate(parts)
    return found[np.unique(np.round(found, 9), axis=0, return_index=True)[1]]


def _grid(values: Sequence[Coded], rng: np.random.Generator) -> Coded:
    """All combinations of the values, or `GRID` of them at random."""
    if np.prod([len(v) for v in values], dtype=float) <= GRID:
        return np.stack(np.meshgrid(*values), axis=-1).reshape(-1, len(values))
    return np.column_stack([rng.choice(v, size=GRID) for v in values])


def _pushed(space: Space, region: Region, points: Coded, rng: np.random.Generator) -> Coded:
    """Points at the edge of the region, found by bisection along each parameter."""
    order = [rng.permutation(space.size) for _ in range(PASSES)]
    for j in np.concatenate(order):
        if space.parameters[j].categorical or j in region.dependent:
            continue
        start = points[:, j]
        end = rng.choice([-1.0, 1.0], size=len(points))
        low, high = np.zeros(len(points)), np.ones(len(points))
        whole = _at(space, region, points, j, end)[1]
        low[whole] = 1.0
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            kept = _at(space, region, points, j, start + share * (end - start))[1]
            low, high = np.where(kept, share, low), np.where(kept, high, share)
        moved, kept = _at(space, region, points, j, start + low * (end - start))
        points = np.where(kept[:, None], moved, points)
    return points


def _at(
    space: Space, region: Region, points: Coded, j: int, values: Coded
) -> tuple[Coded, NDArray[np.bool_]]:
    """Points with parameter number j at `values`, and which of them are inside."""
    moved = points.copy()
    moved[:, j] = space.parameters[j].snap(values)
    return region.moved(moved)
