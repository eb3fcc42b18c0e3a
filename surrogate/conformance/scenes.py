"""Does the geometry of a solver keep the contract of `surrogate.scene`?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from surrogate.conformance.verdict import attempt
from surrogate.errors import SolverError
from surrogate.scene import MOST_POINTS, Line, Mark, Scene
from surrogate.space.units import known


def scene_mistakes(solver: Any, points: Sequence[Mapping[str, Any]]) -> Iterable[str]:
    """A sentence for all that is wrong with `solver.scene`; nothing for a solver without one.

    points: inputs at which it is asked, the nominal ones first.
    """
    if not hasattr(solver, "scene"):
        return
    first: Scene | None = None
    for number, point in enumerate(points):
        where = "scene at the nominal point" if number == 0 else f"scene at point {number}"
        allowed = () if number == 0 else (SolverError,)
        found, sentences = attempt(where, partial(solver.scene, **point), *allowed)
        mistakes = list(sentences)
        if not mistakes and found is not None:
            mistakes = [f"{where}: {words}" for words in _scene(solver, found)]
        yield from mistakes
        if mistakes or found is None:
            return
        first = first or found
        if not found.moves_only(first):
            yield (
                f"{where} has other triangles, coordinates, labels or numbers of points than at "
                "the nominal point; only places may follow the inputs"
            )
            return


def _scene(solver: Any, scene: Any) -> Iterable[str]:
    if not isinstance(scene, Scene):
        yield f"it is a {type(scene).__name__}; return a surrogate.scene.Scene"
        return
    points, triangles = np.asarray(scene.points, float), np.asarray(scene.triangles)
    if points.ndim != 2 or points.shape[1] != 3:
        yield f"points have shape {points.shape}; give (n, 3)"
        return
    if len(points) > MOST_POINTS:
        yield f"{len(points)} points are more than a page turns in time; give {MOST_POINTS} at most"
    if triangles.ndim != 2 or triangles.shape[1:] != (3,) or triangles.dtype.kind not in "iu":
        yield f"triangles have shape {triangles.shape}; give (m, 3) numbers of points"
    elif triangles.size and not 0 <= triangles.min() <= triangles.max() < len(points):
        yield f"triangles name point {triangles.max()}; there are {len(points)}, from 0 on"
    if not known(scene.unit):
        yield f"pint does not know the unit {scene.unit!r}; write mm, m, ..."
    if not scene.views:
        yield "it has no view; give a name with azimuth and elevation in degrees"
    yield from _coordinates(solver, scene, len(points))
    yield from _drawn(solver, scene)


def _coordinates(solver: Any, scene: Scene, size: int) -> Iterable[str]:
    for dim, values in scene.coordinates.items():
        given = np.asarray(values, float)
        if given.shape != (size,) or not np.isfinite(given).all():
            yield f"coordinate {dim} has shape {given.shape}; give a number a point, ({size},)"
    for dim in set(scene.periods) - set(scene.coordinates):
        yield f"period of {dim}: there is no such coordinate"
    for name in scene.fields:
        if name not in solver.outputs:
            yield f"field {name}: the solver has no such output"
        elif not solver.outputs[name].dims:
            yield f"field {name} has no dimension; a number cannot colour a surface"
        else:
            for dim in sorted(set(solver.outputs[name].dims) - set(scene.coordinates)):
                yield f"field {name}: its dimension {dim} is no coordinate of the surface"


def _drawn(solver: Any, scene: Scene) -> Iterable[str]:
    for part in scene.parts:
        if not np.isfinite(part).all():
            yield "a place is not finite; leave it out, or raise SolverError"
            break
    for kind, one in [("line", one) for one in scene.lines] + [("mark", o) for o in scene.marks]:
        places = np.asarray(one.points if isinstance(one, Line) else one.place, float)
        if places.ndim != (2 if kind == "line" else 1) or places.shape[-1] not in (2, 3):
            yield f"{kind} {one.label!r} has shape {places.shape}; give 3 numbers a place, or 2"
        elif places.shape[-1] == 2 and len(scene.coordinates) < 2:
            yield f"{kind} {one.label!r} lies on the surface, which needs two `coordinates`"
        if isinstance(one, Mark) and one.output:
            declared = solver.outputs.get(one.output)
            if declared is None or declared.dims:
                yield f"mark {one.label!r}: {one.output!r} is no output that is one number"
