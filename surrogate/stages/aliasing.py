"""What is confounded with what, for each design that is a regular two-level fraction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from surrogate.designs.aliasing import Aliasing
from surrogate.designs.aliasing import aliasing as of_design
from surrogate.space.space import Space


def aliasing(space: Space, runs: xr.Dataset) -> dict[str, Aliasing]:
    """Design -> its aliasing, read from the coded points of the runs."""
    names, coded = runs["design"].values.astype(str), runs["coded"].values
    return aliases(space, {name: coded[names == name] for name in dict.fromkeys(names.tolist())})


def aliases(space: Space, points: Mapping[str, np.ndarray]) -> dict[str, Aliasing]:
    """Design -> its aliasing; points: design -> coded points (run, parameter)."""
    found = {name: of_design(space, coded) for name, coded in points.items()}
    return {name: alias for name, alias in found.items() if alias is not None}
