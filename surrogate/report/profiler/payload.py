"""What the profiler needs to know of a study, as JSON data with packed numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.fitting.extrapolation import cloud
from surrogate.portable.packing import Packer
from surrogate.regressors.columns import columns_of
from surrogate.regressors.portable import described_columns, described_input
from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.figures.slices import centre
from surrogate.report.profiler.chosen import Chosen
from surrogate.report.profiler.laws import drawn_by, told
from surrogate.report.profiler.scene_data import scene_data, shown_geometry
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.space import Parameter, Space

Array = NDArray[np.float64]

#: Coded ends of the slider of a parameter without ends.
REACH = 0.998
#: Places along each dimension of a field that may be chosen.
PLACES = 16


def payload(content: Content, shown: list[Chosen], leading: Sequence[str] = ()) -> dict[str, Any]:
    """The whole of it; `javascript/engine.js` unpacks and uses it.

    leading: parameters by what they matter for the first output, the most first
    """
    packer = Packer()
    packed = packer.packed({**_study(content, shown), "leading": _numbers(content.space, leading)})
    return {**packed, "shared": packer.shared}


def _study(content: Content, shown: list[Chosen]) -> dict[str, Any]:
    space = content.space
    start = space.decode(starting_point(content))
    finished = np.flatnonzero(content.ok)
    geometry = shown_geometry(content)
    return {
        "study": content.name,
        "parameters": [
            _parameter(parameter, start[parameter.name][0]) for parameter in space.parameters
        ],
        "correlation": _correlation(space),
        "constraints": [one.portable(space.names, dict(space.fixed)) for one in space.constraints],
        "equalities": _equalities(space),
        "clouds": _clouds(content, shown),
        "outputs": [_output(content, one) for one in shown],
        "scene": None if geometry is None else scene_data(content, shown, geometry),
        "runs": {
            "coded": content.coded[finished].tolist(),
            "numbers": [str(number) for number in content.numbers[finished]],
        },
    }


def _numbers(space: Space, leading: Sequence[str]) -> list[int]:
    """All parameters by their numbers, the leading ones first."""
    first = [space.names.index(name) for name in leading if name in space.names]
    return [*first, *(j for j in range(space.size) if j not in first)]


def starting_point(content: Content) -> Array:
    """Coded point (1, d): the middle, or the run nearest to it where constraints cut it off."""
    space = content.space
    middle = centre(space)[None]
    if space.contains(middle).all():
        return middle
    runs = content.coded[content.ok]
    runs = runs[space.contains(runs)]
    if not len(runs):
        return middle
    return np.asarray(runs[[np.argmin(((runs - middle) ** 2).sum(axis=1))]])


def _parameter(parameter: Parameter, start: Any) -> dict[str, Any]:
    law = parameter.distribution
    ends = (
        [] if parameter.categorical else [float(parameter.decode(end)) for end in _ends(parameter)]
    )
    return {
        **described_input(parameter),
        "shown_unit": digits.unit(parameter.unit),
        "about": parameter.description,
        "law": drawn_by(parameter),
        "told": told(parameter),
        "allowed": law.values.tolist() if isinstance(law, DiscreteLaw) else None,
        "bounded": parameter.bounded,
        "ends": ends,
        "start": start.item() if parameter.categorical else float(f"{start:.12g}"),
    }


def _ends(parameter: Parameter) -> tuple[float, float]:
    """Coded ends of the slider; the law of data has tails beyond all that was seen."""
    words = {} if parameter.categorical else dict(parameter.law.words)
    if words.get("distribution") == "data" and "range" not in words:
        low, high = parameter.quantile([0.5 - 0.5 * REACH, 0.5 + 0.5 * REACH])
        return float(low), float(high)
    return (-1.0, 1.0) if parameter.bounded else (-REACH, REACH)


def _correlation(space: Space) -> list[list[float]] | None:
    """Lower factor of the copula's correlation; None for uncorrelated parameters."""
    if space.correlation is None or np.allclose(space.correlation, np.eye(space.size)):
        return None
    factor: list[list[float]] = np.linalg.cholesky(np.asarray(space.correlation)).tolist()
    return factor


def _equalities(space: Space) -> list[dict[str, Any]]:
    if space.region is None or space.region.equalities is None:
        return []
    return [
        {"dependent": int(j), "constant": constant, "coefficients": row.tolist()}
        for j, constant, row in space.region.equalities.reduced
    ]


def _clouds(content: Content, shown: list[Chosen]) -> list[dict[str, Any]]:
    """The cloud of a table's rows, of each training set; a solver answers in the whole box."""
    if not content.recorded:
        return []
    columns = described_columns(columns_of(content.space, content.space.size))
    sets = {one.fit.coded.tobytes(): one.fit.coded for one in shown}
    found = [cloud(content.space, coded) for coded in sets.values()]
    return [
        {
            "columns": columns,
            "directions": one.directions.tolist(),
            "sizes": one.sizes.tolist(),
            "largest": one.largest,
        }
        for one in found
    ]


def _output(content: Content, one: Chosen) -> dict[str, Any]:
    document, places = one.document, None
    if content.is_field(one.output):
        document, places = _thinned(content, one)
    values = one.fit.values
    q2 = content.q2(one.surrogate, one.output)
    return {
        "name": one.output,
        "unit": content.unit(one.output),
        "shown_unit": digits.unit(content.unit(one.output)),
        "surrogate": one.surrogate,
        "best": one.best,
        "q2": q2 if math.isfinite(q2) else None,
        "low": float(values.min()),
        "high": float(values.max()),
        "places": places,
        "document": {key: document[key] for key in ("model", "error")},
    }


def _thinned(content: Content, one: Chosen) -> tuple[dict[str, Any], dict[str, Any]]:
    """The document of a field at `PLACES` of its places a dimension, and those places."""
    shape = one.fit.values.shape[1:]
    stations = field_stations(shape)
    kept = np.ravel_multi_index(np.meshgrid(*stations, indexing="ij"), shape).ravel()
    model, error = one.document["model"], one.document["error"]
    thin = {
        "mean": np.asarray(model["mean"])[kept].tolist(),
        "left_out": np.asarray(model["left_out"])[kept].tolist(),
        "modes": np.asarray(model["modes"]).reshape(-1, math.prod(shape))[:, kept].tolist(),
    }
    narrowed = {
        key: [value[k] for k in kept] if isinstance(value, list) else value
        for key, value in error.items()
    }
    dims = [str(dim) for dim in content.runs[one.output].dims if dim != "run"]
    axes = [_axis(content, dim, at) for dim, at in zip(dims, stations, strict=True)]
    kept_shape = [len(at) for at in stations]
    document = {"model": {**model, **thin, "shape": kept_shape}, "error": narrowed}
    return document, {"axes": axes, "shape": kept_shape}


def field_stations(shape: tuple[int, ...]) -> list[NDArray[np.intp]]:
    """Places along each dimension of a field, evenly from its first to its last."""
    return [
        np.unique(np.linspace(0, size - 1, min(size, PLACES)).round().astype(np.intp))
        for size in shape
    ]


def _axis(content: Content, dim: str, stations: NDArray[np.intp]) -> dict[str, Any]:
    if dim not in content.runs.coords:
        return {"name": dim, "unit": "", "values": [str(k) for k in stations]}
    coordinate = content.runs[dim]
    return {
        "name": dim,
        "unit": digits.unit(str(coordinate.attrs.get("units", ""))),
        "values": [str(value) for value in coordinate.values[stations]],
    }
