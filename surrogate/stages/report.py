"""The report of a study from what its stages gave."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

from surrogate.runs import dataset as rundata
from surrogate.runs.levels import cost_sentences

if TYPE_CHECKING:
    from surrogate.report import Page


def report(dataset: xr.Dataset, **given: Any) -> Page:
    """The whole report: each further word is a field of `Content` and a stage of that name.

    Of levels of fidelity it shows the truth, and tells what each level cost.
    """
    told = [*dataset.attrs.get("notes", "").splitlines(), *cost_sentences(dataset)]
    shown = rundata.at_level(dataset).assign_attrs({"notes": "\n".join(told)} if told else {})
    return _page("", runs=shown, **given)


def validation_page(dataset: xr.Dataset, **given: Any) -> Page:
    """The report of a validation alone."""
    return _page("validation", runs=dataset, **given)


def _page(only: str, **given: Any) -> Page:
    from surrogate.report import Content, build  # jinja2, figures: an analysis may need none

    return build(Content(**given), only)
