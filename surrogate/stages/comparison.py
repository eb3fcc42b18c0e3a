"""All surrogates side by side, on common folds and on the test design if there is one."""

from __future__ import annotations

from collections.abc import Container, Iterable

import xarray as xr

from surrogate.fitting.comparison import compare
from surrogate.runs import dataset as rundata
from surrogate.stages.fits import Fits

TEST = "test"


def comparison(
    designs: Container[str], outputs: Iterable[str], runs: xr.Dataset, fits: Fits
) -> xr.Dataset | None:
    """The comparison; None when nothing could be fitted. designs: their names."""
    if not any(fits.values()):
        return None
    test = (
        {output: rundata.training(runs, output, (TEST,)) for output in outputs}
        if TEST in designs
        else None
    )
    return compare(fits, test)
