"""The old screening rule, to be set beside Sobol' indices: one parameter moved at a time.

    effect_j = f(x_j largest, others at base) - f(x_j smallest, others at base)
    share_j  = |effect_j| / sum_k |effect_k|        share_squared_j = effect_j^2 / sum_k effect_k^2

The rule keeps the parameters with the largest effects until they explain more than a
threshold, 93 % in Chassagne et al. 2018, section III (doi 10.1109/TBME.2017.2774598); which
of the two shares was meant is not printed. The squared share is the Sobol' index when the
response is linear and the parameters are uniform; a parameter that acts through interactions
or a symmetric curve has effect 0 at the base point and is dropped.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import StudyError
from surrogate.estimator import Array
from surrogate.sensitivity.model import Analysed, Predict, Seed, model, rests
from surrogate.sensitivity.table import Q2_NEEDED, Variables, dataset
from surrogate.space.space import Parameter, Space

THRESHOLD = 0.93
#: Coded ends of an unbounded parameter: its 2.5 and 97.5 percentiles.
UNBOUNDED_END = 0.95


def one_at_a_time(
    fit: Analysed,
    space: Space,
    *,
    seed: Seed = 0,
    confidence: float = 0.95,
    base: Mapping[str, Any] | None = None,
    threshold: float = THRESHOLD,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """Effects of a fit (or function of coded points) when one parameter moves at a time.

    base       name -> physical value at which the others rest; default: coded 0, or the
               first level
    threshold  share that the parameters kept by the rule must exceed

    `seed` and `confidence` are taken for the sake of one signature: nothing is random here.
    An array's effect is its root mean square. A categorical parameter's effect is the
    largest difference between two of its levels.
    """
    one = model(fit, space, q2=q2)
    rest = base_point(space, base)
    effects = [
        _effect(one.predict, parameter, j, rest) for j, parameter in enumerate(space.parameters)
    ]
    return dataset(
        one,
        _columns(np.array(effects), threshold),
        method="one_at_a_time",
        confidence=confidence,
        q2_needed=q2_needed,
        threshold=threshold,
        moved=f"ends of the ranges, others at {describe(space, rest)}",
    )


def main_effects(
    space: Space,
    coded: ArrayLike,
    values: ArrayLike,
    *,
    output: str = "y",
    threshold: float = THRESHOLD,
) -> xr.Dataset:
    """The same table from the runs alone: main effects 2 b_j of a least squares plane.

    coded (n, d), values (n,). For a two-level design this is the difference of the means at
    the two levels. Raises `StudyError` when the runs do not determine the plane.
    """
    coded, values = np.asarray(coded, dtype=float), np.asarray(values, dtype=float)
    plane = np.column_stack([np.ones(len(coded)), coded])
    if np.linalg.matrix_rank(plane) < plane.shape[1]:
        raise StudyError(
            f"{len(coded)} runs do not determine the effects of {space.size} "
            "parameters; add runs or take the effects of a surrogate"
        )
    effects = 2.0 * np.linalg.lstsq(plane, values, rcond=None)[0][1:]
    return xr.Dataset(
        _columns(effects, threshold),
        coords={"output": [output], "parameter": list(space.names)},
        attrs={
            "method": "main_effects",
            "surrogate": "runs",
            "threshold": threshold,
            "moved": "least squares plane of the runs",
        },
    )


def base_point(space: Space, base: Mapping[str, Any] | None = None) -> Array:
    """Coded point (d,) of physical values; a parameter not named rests in the middle."""
    rest = np.array(
        [p.coded_levels[0] if p.categorical else float(p.snap(0.0)) for p in space.parameters]
    )
    for name, value in (base or {}).items():
        rest[space.names.index(space[name].name)] = float(space[name].encode(value))
    return rest


def describe(space: Space, coded: Array) -> str:
    """`tension 0.098 N/mm, mu_skin 0.2` for one coded point (d,)."""
    return ", ".join(f"{p.name} {quantity(p, coded[j])}" for j, p in enumerate(space.parameters))


def quantity(parameter: Parameter, coded: float) -> str:
    """One coded value in words: level, or number with unit."""
    value = parameter.decode(coded).item()
    return value if parameter.categorical else f"{value:g} {parameter.unit}".rstrip()


def _effect(predict: Predict, parameter: Parameter, j: int, rest: Array) -> float:
    end = 1.0 if parameter.bounded else UNBOUNDED_END
    places = parameter.coded_levels if parameter.categorical else np.array([-end, end])
    points = np.tile(rest, (len(places), 1))
    points[:, j] = places
    values = np.asarray(predict(points)).reshape(len(places), -1)
    if rests(values):
        return 0.0
    if values.shape[1] == 1 and not parameter.categorical:
        return float(values[1, 0] - values[0, 0])
    gaps = values[:, None] - values[None, :]
    return float(np.sqrt((gaps**2).mean(axis=-1)).max())


def _columns(effects: Array, threshold: float) -> Variables:
    """Variables of the table: effect, both shares, and what the rule keeps by either."""
    shares = {"share": _shares(np.abs(effects)), "share_squared": _shares(effects**2)}
    kept = {f"kept_by_{name}": kept_by_rule(share, threshold) for name, share in shares.items()}
    return {
        name: (("output", "parameter"), column[None])
        for name, column in {"effect": effects, **shares, **kept}.items()
    }


def _shares(sizes: Array) -> Array:
    """Shares of the sum; zeros when nothing has an effect."""
    return sizes / sizes.sum() if sizes.sum() > 0.0 else sizes


def kept_by_rule(share: Array, threshold: float = THRESHOLD) -> NDArray[np.bool_]:
    """(d,) True for the largest shares until their sum exceeds `threshold`."""
    order = np.argsort(-share, kind="stable")
    before = np.cumsum(share[order]) - share[order]
    kept = np.zeros(len(share), dtype=bool)
    kept[order] = (before <= threshold) & (share[order] > 0.0)
    return kept
