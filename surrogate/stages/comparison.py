"""All surrogates side by side, on common folds and on the test design if there is one."""

from __future__ import annotations

from collections.abc import Iterable

import xarray as xr

from surrogate.fitting.comparison import compare
from surrogate.runs import dataset as rundata
from surrogate.stages.fits import Fits

TEST = "test"


def comparison(outputs: Iterable[str], runs: xr.Dataset, fits: Fits) -> xr.Dataset | None:
    """The comparison; None when nothing could be fitted."""
    if not any(fits.values()):
        return None
    test = (
        {output: rundata.training(runs, output, (TEST,)) for output in outputs}
        if TEST in runs["design"]
        else None
    )
    return compare(fits, test)
