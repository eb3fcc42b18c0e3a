"""Designs of runs that put promises to the test: those of goals, and that of the calibration."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

#: Designs of verifying runs are named so.
PREFIX = "verified_"
#: What the calibration promises, beside the names of goals.
CALIBRATION = "calibration"


def design_of(promise: str) -> str:
    """Name of the design that holds the verifying runs of a goal or of the calibration."""
    return PREFIX + promise


def verifying(runs: xr.Dataset, promise: str) -> NDArray[np.bool_]:
    """(run,) which runs put a promise to the test and are done."""
    own = runs["design"].values.astype(str) == design_of(promise)
    return np.asarray(own & (runs["status"].values.astype(str) != "missing"))
