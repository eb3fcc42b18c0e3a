"""The region of the space where runs fail, if there is one that beats chance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from surrogate.runs import dataset as rundata
from surrogate.space.space import Space

if TYPE_CHECKING:
    from surrogate.fitting.failures import FailingRegion


def failures(space: Space, runs: xr.Dataset) -> FailingRegion | None:
    """Where the runs fail; None when few did, or nothing tells where."""
    runs = rundata.at_level(runs)
    status = runs["status"].values.astype(str)
    made = status != "missing"
    failed = np.asarray(status[made] != "ok")
    if not failed.any():
        return None
    from surrogate.fitting.failures import failing_region  # trees: most studies need none

    return failing_region(space, runs["coded"].values[made], failed)
