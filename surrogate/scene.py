"""The geometry that a solver may show: a surface, lines and marks, plain data.

A solver with a geometry has one more method, `scene(**inputs) -> Scene`, called with every
input, in the units that `inputs` states. The report turns the surface, colours it by a field
and lets it follow the sliders. ::

    class Beam:
        ...
        outputs = {"bend": Output("mm", dims=("x",), coordinates={"x": np.linspace(0, 1, 11)})}

        def scene(self, load, length):
            x, y = (grid.ravel() for grid in np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.1]))
            points = np.column_stack([length * x, y, np.zeros(6)])
            triangles = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]]
            return Scene(points, triangles, "m", coordinates={"x": x}, fields=("bend",))

Only places follow the inputs: how many points there are, what joins them, coordinates and
labels are the same for all inputs. Lines and marks may lie on the surface: they are then given
by two of its coordinates, and stay on it when the surface moves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A surface of more points does not turn in time in a browser, and makes a report heavy.
MOST_POINTS = 5000


@dataclass(frozen=True)
class Line:
    """A line through points: (n, 3) in space, or (n, 2) on the surface; its ends may be joined."""

    label: str
    points: ArrayLike
    closed: bool = False


@dataclass(frozen=True)
class Mark:
    """A place with a label, (3,) in space or (2,) on the surface.

    output: the scalar output whose value is written beside the label
    """

    label: str
    place: ArrayLike
    output: str = ""


@dataclass(frozen=True)
class Scene:
    """A surface of triangles with what is drawn on it; z points up.

    points       (n, 3) in `unit`, n up to `MOST_POINTS`
    triangles    (m, 3) numbers of points; counter-clockwise where seen from outside
    coordinates  dimension of an output -> its value at each point, (n,)
    periods      dimension -> how far it goes until it comes round to the same place
    fields       outputs that may colour the surface: their dims are all in `coordinates`
    lines        such as edges, or what is wound around the surface
    marks        such as sensors
    views        name -> (azimuth from x towards y, elevation), degrees, of who looks at it;
                 the first is how it opens, the first two are printed
    Lines and marks on the surface are given by the first two of `coordinates`.
    """

    points: ArrayLike
    triangles: ArrayLike
    unit: str = "mm"
    coordinates: Mapping[str, ArrayLike] = field(default_factory=dict)
    periods: Mapping[str, float] = field(default_factory=dict)
    fields: tuple[str, ...] = ()
    lines: tuple[Line, ...] = ()
    marks: tuple[Mark, ...] = ()
    views: Mapping[str, tuple[float, float]] = field(
        default_factory=lambda: {"front": (-60.0, 20.0), "back": (120.0, 20.0)}
    )

    @property
    def parts(self) -> list[NDArray[np.float64]]:
        """All that moves: points of the surface, of each line, of each mark, (n, 2 or 3)."""
        apart = [self.points, *(line.points for line in self.lines)]
        apart += [np.atleast_2d(np.asarray(mark.place, float)) for mark in self.marks]
        return [np.asarray(part, float) for part in apart]

    def moves_only(self, other: Scene) -> bool:
        """True when nothing but places differs from another scene."""
        mine, its = (
            (
                one.unit,
                one.fields,
                dict(one.periods),
                {name: tuple(view) for name, view in one.views.items()},
                [(line.label, line.closed) for line in one.lines],
                [(mark.label, mark.output) for mark in one.marks],
                [part.shape for part in one.parts],
                list(one.coordinates),
            )
            for one in (self, other)
        )
        return (
            mine == its
            and np.array_equal(self.triangles, other.triangles)
            and all(np.array_equal(v, other.coordinates[k]) for k, v in self.coordinates.items())
        )
