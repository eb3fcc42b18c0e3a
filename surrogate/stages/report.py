"""The report of a study from what its stages gave."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

if TYPE_CHECKING:
    from surrogate.report import Page


def report(dataset: xr.Dataset, **given: Any) -> Page:
    """The whole report: each further word is a field of `Content` and a stage of that name."""
    return _page("", runs=dataset, **given)


def validation_page(dataset: xr.Dataset, **given: Any) -> Page:
    """The report of a validation alone."""
    return _page("validation", runs=dataset, **given)


def _page(only: str, **given: Any) -> Page:
    from surrogate.report import Content, build  # jinja2, figures: an analysis may need none

    return build(Content(**given), only)
