"""Regression tables: surrogate -> output -> dataset, for polynomials of scalars."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from surrogate.estimator import has_table
from surrogate.stages.fits import Fits

Tables = Mapping[str, Mapping[str, xr.Dataset]]


def regression(deterministic: bool, fits: Fits) -> dict[str, dict[str, xr.Dataset]]:
    """A table of each fit that offers one."""
    tables = {
        name: {
            output: fit.estimator.regression_table(deterministic=deterministic)
            for output, fit in by_output.items()
            if has_table(fit.estimator)
        }
        for name, by_output in fits.items()
    }
    return {name: by_output for name, by_output in tables.items() if by_output}


def tree(tables: Tables) -> xr.DataTree | None:
    """A group per surrogate; with several outputs, a group per output inside it."""
    groups = {
        f"/{name}" if len(by) == 1 else f"/{name}/{output}": table
        for name, by in tables.items()
        for output, table in by.items()
    }
    return xr.DataTree.from_dict(groups) if groups else None
