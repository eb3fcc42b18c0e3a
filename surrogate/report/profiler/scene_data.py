"""What the page needs to know of a scene: how places and colours follow the parameters.

Geometry is kept to 16 bits a component of a mode. Colours are the field's own modes at the
points of the surface: the largest of them, within `MOST_CHARACTERS`; what the others would add is
said.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator

from surrogate.fitting.geometry import Geometry, Moving
from surrogate.portable import quantised
from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.profiler.chosen import Chosen
from surrogate.scene import MOST_POINTS, Scene

Array = NDArray[np.float64]

#: Characters of a page for all fields together.
MOST_CHARACTERS = 270_000
#: Points of the parameters at which it is looked how far the surface reaches.
SEEN = 64
#: Share of the field's range that rounding a mode to 8 bits may cost.
ROUNDING = 5e-4


@dataclass(frozen=True, eq=False)
class Colours:
    """A field on the surface, as mean and modes at its points.

    mean (n,), modes (k, n), amplitudes (runs, k) of the training runs; low, high of the field
    """

    number: int
    one: Chosen
    mean: Array
    modes: Array
    amplitudes: Array
    low: float
    high: float

    @cached_property
    def rows(self) -> dict[str, Any]:
        """Mean and modes, packed, (k + 1)."""
        return quantised.quantised(np.vstack([self.mean, self.modes]), self._tolerance)

    @property
    def _tolerance(self) -> Array:
        largest = np.abs(self.amplitudes).max(axis=0, initial=0.0)
        allowed = ROUNDING * (self.high - self.low)
        return np.concatenate([[0.0], allowed / np.where(largest > 0, largest, 1.0)])

    def kept(self, size: int) -> int:
        """Modes that fit into so many characters."""
        return int((np.cumsum(quantised.cost(self.rows))[1:] <= size).sum())

    def left_out(self, kept: int) -> float:
        """RMS over training runs and points of what modes beyond `kept` would add."""
        rest = self.amplitudes[:, kept:] @ self.modes[kept:]
        return float(np.sqrt((rest**2).mean())) if rest.size else 0.0

    def payload(self, kept: int) -> dict[str, Any]:
        """Mean and modes for the page."""
        return {
            "output": self.number,
            "rows": {"steps": self.rows["steps"][: kept + 1]},
            "low": self.low,
            "high": self.high,
            "left_out": self.left_out(kept),
        }


def shown_geometry(content: Content) -> Geometry | None:
    """The geometry of a study, where there is one that a page can turn."""
    found = content.scene
    if not isinstance(found, Geometry) or len(found.scene.parts[0]) > MOST_POINTS:
        return None
    return found


def scene_note(content: Content) -> str:
    """Why a geometry is not shown; "" when it is, or when there is none."""
    if isinstance(content.scene, Geometry) and shown_geometry(content) is None:
        count = len(content.scene.scene.parts[0])
        return f"The geometry is not shown: {count} points are more than {MOST_POINTS}."
    return content.scene if isinstance(content.scene, str) else ""


def scene_data(content: Content, shown: list[Chosen], geometry: Geometry) -> dict[str, Any]:
    """The whole of it; `javascript/geometry.js` uses it."""
    scene, coloured = geometry.scene, list(colours(content, shown, geometry.scene))
    share = MOST_CHARACTERS // max(len(coloured), 1)
    surface, *others = (_moving(part) for part in geometry.parts)
    lines, marks = others[: len(scene.lines)], others[len(scene.lines) :]
    names = [one.output for one in shown]
    return {
        "unit": scene.unit,
        "size": geometry.size,
        "extent": _extent(geometry),
        "error": geometry.parts[0].error + _rounding(geometry.parts[0], surface),
        "active": list(geometry.active),
        "spans": [list(span) for span in geometry.spans],
        "triangles": quantised.whole(np.asarray(scene.triangles).T),
        "coordinates": [_coordinate(content, scene, dim) for dim in scene.coordinates],
        "surface": surface,
        "lines": [
            {"label": line.label, "closed": line.closed, "moving": part}
            for line, part in zip(scene.lines, lines, strict=True)
        ],
        "marks": [
            {
                "label": mark.label,
                "output": names.index(mark.output) if mark.output in names else None,
                "moving": part,
            }
            for mark, part in zip(scene.marks, marks, strict=True)
        ],
        "views": [[name, *map(float, view)] for name, view in scene.views.items()],
        "fields": [one.payload(one.kept(share)) for one in coloured],
    }


def _rounding(part: Moving, packed: dict[str, Any]) -> float:
    """Largest distance that rounding the modes may move a point."""
    missed = quantised.read(packed["rows"]) - np.swapaxes(part.modes, 1, 2).reshape(
        -1, part.modes.shape[1]
    )
    largest = np.abs(part.coefficients).sum(axis=0)  # monomials are 1 at most in the box
    off = np.einsum("k,kdn->dn", largest, np.abs(missed.reshape(len(largest), -1, missed.shape[1])))
    return float(np.linalg.norm(off, axis=0).max())


def _extent(geometry: Geometry) -> dict[str, Any]:
    """Middle of the surface, and how far it reaches from there wherever the parameters go."""
    size = len(geometry.active)
    corners = (
        np.random.default_rng(0).uniform(-1.0, 1.0, (SEEN, size)) if size else np.zeros((1, 0))
    )
    centre = geometry.parts[0](np.zeros((1, size)))[0]
    points = geometry.parts[0](corners).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (centre.min(axis=0) + centre.max(axis=0)) / 2
    middle[2] = (low[2] + high[2]) / 2
    across = np.linalg.norm((points - middle)[:, :2], axis=1).max()
    return {"middle": middle.tolist(), "across": float(across), "up": float(high[2] - low[2]) / 2}


def _moving(part: Moving) -> dict[str, Any]:
    """Modes as rows, a component of a mode each."""
    modes = np.swapaxes(part.modes, 1, 2)
    return {
        "powers": part.powers.tolist(),
        "coefficients": part.coefficients.T.tolist(),
        "rows": quantised.quantised(modes.reshape(-1, modes.shape[-1])),
        "dimension": modes.shape[1],
    }


def _coordinate(content: Content, scene: Scene, dim: str) -> dict[str, Any]:
    known = content.runs[dim].attrs if dim in content.runs.coords else {}
    return {
        "name": dim,
        "unit": digits.unit(str(known.get("units", ""))),
        "period": scene.periods.get(dim),
        "rows": quantised.quantised([np.asarray(scene.coordinates[dim], float)]),
    }


def colours(content: Content, shown: list[Chosen], scene: Scene) -> Iterator[Colours]:
    """The fields that may colour the surface, as their surrogates know them."""
    for number, one in enumerate(shown):
        if one.output not in scene.fields or not content.is_field(one.output):
            continue
        model, values = one.document["model"], one.fit.values
        mean, flat = np.asarray(model["mean"], float), values.reshape(len(values), -1)
        modes = np.asarray(model["modes"], float).reshape(-1, flat.shape[1])
        low, high = _span(flat)
        on_points = _interpolated(content, one.output, scene, np.vstack([mean, modes]))
        amplitudes = (flat - mean) @ modes.T
        yield Colours(number, one, on_points[0], on_points[1:], amplitudes, low, high)


def _span(values: Array) -> tuple[float, float]:
    """Ends of the colour scale: the field over all runs, but for a thousandth at either end."""
    low, high = np.quantile(values, [0.001, 0.999])
    return float(low), float(high if high > low else low + 1.0)


def _interpolated(content: Content, output: str, scene: Scene, rows: Array) -> Array:
    """Rows (k, size) of a field, at the points of the surface (k, n): linear between places."""
    dims = [str(dim) for dim in content.runs[output].dims if dim != "run"]
    axes, grid = [], rows.reshape(len(rows), *(content.runs.sizes[dim] for dim in dims))
    wanted = []
    for axis, dim in enumerate(dims, start=1):
        places = np.asarray(content.runs[dim].values, float)
        at, order = np.asarray(scene.coordinates[dim], float), np.argsort(places)
        places, grid = places[order], np.take(grid, order, axis=axis)
        period = scene.periods.get(dim)
        if period is not None:
            at = places[0] + (at - places[0]) % period
            if places[-1] < places[0] + period:
                places = np.append(places, places[0] + period)
                grid = np.concatenate([grid, np.take(grid, [0], axis=axis)], axis=axis)
        axes.append(places)
        wanted.append(np.clip(at, places[0], places[-1]))
    between = RegularGridInterpolator(axes, np.moveaxis(grid, 0, -1))
    return np.asarray(between(np.column_stack(wanted)).T)
