"""A solver's geometry as polynomials in its parameters, so that a page can evaluate it.

Each part of a scene (surface, line, mark) becomes

    x_i(t) = sum_k c_k(t) mode_ki,   c_k(t) = sum_j C_jk t^(powers_j),

t the values of those parameters that move anything, from -1 to 1 over their ranges. The
polynomial is fitted by least squares to scenes at Sobol' points of the whole box, of the smallest
total degree that is exact to rounding at points that it has not seen, else of the best one; modes
are the right singular vectors of its coefficients, as many as do not add to that error. Nothing is
specific to a solver: shapes that are linear in modes and scaled, as those of the leg, come out
exact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from surrogate.errors import FitError, SolverError
from surrogate.scene import Scene
from surrogate.space.space import Parameter, Space

Array = NDArray[np.float64]

#: Coded ends of the box: parameters without ends have no scene at -1 and 1.
REACH = 0.998
HIGHEST, MOST_TERMS = 8, 60
HELD_OUT = 24
#: Points tried until one has a scene.
TRIED = 8
#: Error over the size of a part below which a polynomial is exact.
EXACT = 1e-9


@dataclass(frozen=True)
class Moving:
    """Points (n, d) that follow the parameters.

    powers        (terms, active) of the scaled values
    coefficients  (terms, K)
    modes         (K, n, d)
    error         largest distance from the solver's scenes at held-out points
    """

    powers: NDArray[np.intp]
    coefficients: Array
    modes: Array
    error: float

    def __call__(self, scaled: Array) -> Array:
        """Points (m, n, d) at scaled values (m, active)."""
        factors = _terms(scaled, self.powers) @ self.coefficients
        return np.asarray(np.einsum("mk,knd->mnd", factors, self.modes))


@dataclass(frozen=True)
class Geometry:
    """A scene that follows the parameters of a study.

    scene   the solver's, at one point: what does not move is taken from it
    space   of the study
    active  numbers of the parameters that move anything
    parts   as `Scene.parts`
    """

    scene: Scene
    space: Space
    active: tuple[int, ...]
    parts: tuple[Moving, ...]

    @property
    def size(self) -> float:
        """Diagonal of the box around the surface, in the scene's unit."""
        return float(np.linalg.norm(np.ptp(self.scene.parts[0], axis=0)))

    def at(self, coded: Array) -> list[Array]:
        """The parts at one coded point (d,)."""
        moved = _scaled(self.space, self.active, np.asarray(coded, float)[None])
        return [part(moved)[0] for part in self.parts]

    @property
    def spans(self) -> list[tuple[float, float]]:
        """Values of the active parameters at -1 and 1; coded ones of those with levels."""
        return [_span(self.space.parameters[j]) for j in self.active]


def _span(parameter: Parameter) -> tuple[float, float]:
    if parameter.categorical:
        return -1.0, 1.0
    end = 1.0 if parameter.bounded else REACH
    return float(parameter.decode(-end)), float(parameter.decode(end))


def _scaled(space: Space, active: Sequence[int], coded: Array) -> Array:
    """Scaled values (m, active) at coded points (m, d), as levels and steps allow them."""
    columns = []
    for j in active:
        parameter = space.parameters[j]
        values = parameter.decode(coded[:, j])
        low, high = _span(parameter)
        known = parameter.encode(values) if parameter.categorical else np.asarray(values, float)
        columns.append(2.0 * (known - low) / (high - low) - 1.0)
    return np.column_stack(columns) if columns else np.zeros((len(coded), 0))


def geometry(scene: Callable[..., Scene], space: Space, fixed: Mapping[str, Any]) -> Geometry:
    """The geometry of a solver over the parameters of a study.

    scene: that of the solver; fixed: values of its inputs that are no parameters. Raises
    FitError when too few points have a scene, or when more than places change.
    """

    def seen(coded: Array) -> list[Scene | None]:
        return [_asked(scene, {**fixed, **values}) for values in _values(space, coded)]

    active, first = _active(seen, space)
    if not active:
        still = [
            Moving(np.zeros((1, 0), np.intp), np.ones((1, 1)), part[None], 0.0)
            for part in first.parts
        ]
        return Geometry(first, space, (), tuple(still))
    powers = _powers(len(active), HIGHEST)
    count = 2 * len(powers) + HELD_OUT
    coded = np.zeros((count, space.size))
    coded[:, active] = _sobol(count, len(active))
    scaled = _scaled(space, active, coded)
    pairs = [(t, one) for t, one in zip(scaled, seen(coded), strict=True) if one]
    if len(pairs) < len(powers) + HELD_OUT:
        raise FitError(f"only {len(pairs)} of {count} points have a geometry")
    points = np.array([t for t, _ in pairs])
    for _, other in pairs:
        if not other.moves_only(first):
            raise FitError("its triangles, coordinates or labels change with the inputs")
    parts = zip(*(one.parts for _, one in pairs), strict=True)
    return Geometry(first, space, active, tuple(_moving(points, np.array(part)) for part in parts))


def _asked(scene: Callable[..., Scene], inputs: Mapping[str, Any]) -> Scene | None:
    try:
        return scene(**inputs)
    except SolverError:
        return None


def _values(space: Space, coded: Array) -> list[dict[str, Any]]:
    columns = {name: np.asarray(column).tolist() for name, column in space.decode(coded).items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _sobol(count: int, size: int) -> Array:
    unit = qmc.Sobol(size, rng=0).random_base2(int(np.ceil(np.log2(count))))[:count]
    return np.asarray(REACH * (2.0 * unit - 1.0))


def _active(
    seen: Callable[[Array], list[Scene | None]], space: Space
) -> tuple[tuple[int, ...], Scene]:
    """Parameters that move anything when one of them goes from a point to elsewhere."""
    for base in _sobol(TRIED, space.size):
        moved = np.tile(base, (space.size + 1, 1))
        moved[1:] -= np.diag(np.where(base > 0, 1.0, -1.0))
        first, *others = seen(moved)
        if first is None:
            continue
        changed = [
            j
            for j, other in enumerate(others)
            if other is not None
            and any(not np.array_equal(a, b) for a, b in zip(first.parts, other.parts, strict=True))
        ]
        return tuple(changed), first
    raise FitError(f"none of {TRIED} points has a geometry")


def _powers(size: int, highest: int) -> NDArray[np.intp]:
    """Monomials of total degree up to `highest`, as many degrees as `MOST_TERMS` allow."""
    rows: list[list[int]] = [[0] * size]
    for degree in range(1, highest + 1):
        more = [
            [chosen.count(j) for j in range(size)]
            for chosen in combinations_with_replacement(range(size), degree)
        ]
        if len(rows) + len(more) > MOST_TERMS:
            break
        rows += more
    return np.array(rows, dtype=np.intp)


def _terms(scaled: Array, powers: NDArray[np.intp]) -> Array:
    """Values of the monomials, (m, terms)."""
    return np.asarray((scaled[:, None, :] ** powers).prod(axis=2))


def _moving(scaled: Array, values: Array) -> Moving:
    """The polynomial of smallest degree that is exact, or the best one; values (N, n, d)."""
    spans = np.ptp(values, axis=(0, 1))
    scale = np.where(spans > 0, spans, 1.0)
    flat = (values / scale).reshape(len(values), -1)
    fitted, held = slice(HELD_OUT, None), slice(HELD_OUT)
    powers, best = _powers(scaled.shape[1], HIGHEST), None
    for degree in range(int(powers.sum(axis=1).max()) + 1):
        kept = powers[powers.sum(axis=1) <= degree]
        solved = np.linalg.lstsq(_terms(scaled[fitted], kept), flat[fitted], rcond=None)[0]
        left, sizes, right = np.linalg.svd(solved, full_matrices=False)
        modes = right.reshape(-1, *values.shape[1:]) * scale
        one = _judged(Moving(kept, left * sizes, modes, 0.0), scaled[held], values[held])
        if best is None or one.error < best.error:
            best = one
        if one.error < EXACT * np.linalg.norm(spans):
            break
    assert best is not None
    enough = max(1.05 * best.error, 0.1 * EXACT * float(np.linalg.norm(spans)))
    shorter = (
        replace(best, coefficients=best.coefficients[:, :k], modes=best.modes[:k])
        for k in range(1, len(best.modes))
    )
    judged = (_judged(one, scaled[held], values[held]) for one in shorter)
    return next((one for one in judged if one.error <= enough), best)


def _judged(moving: Moving, scaled: Array, values: Array) -> Moving:
    """The same with its error at these points."""
    missed = np.linalg.norm(moving(scaled) - values, axis=-1)
    return replace(moving, error=float(missed.max()))
