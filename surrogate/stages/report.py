"""The report of a study from what its stages gave."""

from __future__ import annotations

from typing import Any

import xarray as xr

from surrogate.report import Content, Page, build


def report(dataset: xr.Dataset, **given: Any) -> Page:
    """The whole report: each further word is a field of `Content` and a stage of that name."""
    return build(Content(runs=dataset, **given))
