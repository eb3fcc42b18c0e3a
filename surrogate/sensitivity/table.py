"""Results of a sensitivity analysis as xarray datasets, and the stamp that refuses them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from surrogate.estimator import Array
from surrogate.sensitivity.groups import Named
from surrogate.sensitivity.model import Model

#: Variables of a dataset by name: dimensions, and values over them.
Variables = dict[str, tuple[tuple[str, ...], ArrayLike]]

#: Below this Q2 a surrogate is commonly held to be too poor for sensitivity analysis
#: (Marrel, Iooss, Laurent and Roustant 2009, doi 10.1016/j.ress.2008.07.008).
Q2_NEEDED = 0.7


@dataclass(frozen=True)
class Estimate:
    """A value with the two parts of its uncertainty, all of one shape.

    sampling      half-width of the interval for the finite sample; 0 for a closed form
    below, above  distances to the ends of the interval for the surrogate's own error
                  (NaN when that error cannot be estimated)
    """

    value: Array
    sampling: Array
    below: Array
    above: Array

    def columns(self, name: str, dims: tuple[str, ...], ends: tuple[float, float]) -> Variables:
        """Variables `name`, `_low`, `_high`, `_sampling`, `_surrogate`, kept within `ends`.

        The two parts are independent, so they add as squares. An unknown surrogate part
        leaves the whole of `ends` possible.
        """
        low = np.nan_to_num(self.value - np.hypot(self.sampling, self.below), nan=ends[0])
        high = np.nan_to_num(self.value + np.hypot(self.sampling, self.above), nan=ends[1])
        undefined = np.isnan(self.value)
        parts = {
            "": self.value,
            "_low": np.where(undefined, np.nan, low),
            "_high": np.where(undefined, np.nan, high),
        }
        columns = {name + key: np.clip(part, *ends) for key, part in parts.items()}
        columns[f"{name}_sampling"] = self.sampling
        columns[f"{name}_surrogate"] = 0.5 * (self.below + self.above)
        return {key: (("output", *dims), column[None]) for key, column in columns.items()}


def dataset(
    model: Model,
    variables: Variables,
    *,
    method: str,
    confidence: float,
    q2_needed: float = Q2_NEEDED,
    groups: Named | None = None,
    **attributes: object,
) -> xr.Dataset:
    """The dataset of one output: dimensions output, parameter (and parameter_2, group).

    The coordinate `members` tells what belongs to each group. Attributes: surrogate, method,
    confidence, `refused` (empty, or the sentence that the report stamps over the figures), and
    what else is given.
    """
    names = list(model.space.names)
    coordinates: dict[str, Any] = {"output": [model.output], "parameter": names}
    if any("parameter_2" in dims for dims, _ in variables.values()):
        coordinates["parameter_2"] = names
    if groups:
        coordinates["group"] = list(groups)
        coordinates["members"] = ("group", [", ".join(members) for members in groups.values()])
    refusal = refuse(model, q2_needed)
    known: Variables = {
        "q2": (("output",), [np.nan if model.q2 is None else model.q2]),
        "refused": (("output",), [refusal]),
    }
    return xr.Dataset(
        {**variables, **known},
        coords=coordinates,
        attrs={
            "surrogate": model.surrogate,
            "method": method,
            "confidence": confidence,
            "q2_needed": q2_needed,
            "refused": refusal,
            **attributes,
        },
    )


def refuse(model: Model, q2_needed: float) -> str:
    """Why these figures must not be relied on; empty when they may be."""
    if model.estimator is None or (model.q2 is not None and model.q2 >= q2_needed):
        return ""
    if model.q2 is None or np.isnan(model.q2):
        return (
            f"Not to be trusted: the Q2 of surrogate {model.surrogate} for {model.output} is "
            "not known, so nothing says that its indices are those of the solver. Add runs or "
            "a test design."
        )
    return (
        f"Not to be trusted: surrogate {model.surrogate} predicts {model.output} with "
        f"Q2 = {model.q2:.2f}, below the {q2_needed:g} that its indices need. "
        "Add runs or choose another surrogate."
    )


def combine(datasets: Sequence[xr.Dataset]) -> xr.Dataset:
    """One dataset of several outputs; attributes that differ are joined by '; '."""
    attributes = {}
    for key in datasets[0].attrs:
        values = list(dict.fromkeys(d.attrs[key] for d in datasets if d.attrs[key] != ""))
        attributes[key] = values[0] if len(values) == 1 else "; ".join(map(str, values))
    joined = xr.concat(
        datasets,
        dim="output",
        combine_attrs="drop",
        join="exact",
        data_vars="all",
        coords="minimal",
        compat="equals",
    )
    return joined.assign_attrs(attributes)
