"""The outputs that are mostly noise, and what that means."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import xarray as xr

from surrogate.fitting import noise as of_runs
from surrogate.fitting.noise import Noise
from surrogate.fitting.replicates import Replicates
from surrogate.stages.fits import Fits


def noise(
    outputs: Iterable[str], runs: xr.Dataset, fits: Fits, replicates: Mapping[str, Replicates]
) -> dict[str, Noise]:
    """Output -> its noise, of those where it is a large share of the variance."""
    found = {}
    for output in outputs:
        own = [by_output[output] for by_output in fits.values() if output in by_output]
        unit = str(runs[output].attrs.get("units", ""))
        loud = of_runs.noise(output, unit, own, replicates.get(output))
        if loud is not None:
            found[output] = loud
    return found
