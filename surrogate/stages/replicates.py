"""The scatter of each output at points that were run more than once."""

from __future__ import annotations

from collections.abc import Iterable

import xarray as xr

from surrogate.fitting import replicates as of_points
from surrogate.fitting.replicates import Replicates
from surrogate.runs import dataset as rundata


def replicates(
    outputs: Iterable[str], deterministic: bool, runs: xr.Dataset
) -> dict[str, Replicates]:
    """Output -> its scatter; outputs without replicates, and fields, are left out."""
    found = {}
    for output in outputs if not deterministic else ():
        if runs[output].ndim == 1:
            designs = dict.fromkeys(runs["design"].values.tolist())
            scatter = of_points.replicates(*rundata.training(runs, output, designs))
            if scatter is not None:
                found[output] = scatter
    return found
