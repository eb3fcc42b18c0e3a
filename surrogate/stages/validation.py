"""Surrogates, and other models, beside cases that they have not seen."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr

from surrogate.solver import Output
from surrogate.space.space import Space
from surrogate.stages.fits import Fits
from surrogate.validation import validation as validating
from surrogate.validation.cases import Cases
from surrogate.validation.validation import Fixed, Validation


def validation(
    validation_rule: Validation | None,
    space: Space,
    offered: Mapping[str, Output],
    fixed: Mapping[str, Fixed],
    fits: Fits,
    cases: Cases | None,
) -> xr.Dataset | None:
    """The agreement of each surrogate and model with the cases; None without cases.

    offered: the study's outputs. fixed: its inputs that do not vary.
    """
    if cases is None:
        return None
    wanted: Any = validation_rule.outputs if validation_rule else ()
    units = {name: offered[name].unit for name in validating.outputs_in(cases, offered, wanted)}
    models = validation_rule.models if validation_rule else {}
    return validating.validate(space, fits, cases, units, models, fixed)
