"""Which parameters to keep, and the study that is left without the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr

from surrogate.sensitivity.screening import Screening, decide
from surrogate.solver import Solver
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.space import Parameter, Space
from surrogate.stages.fits import Fits
from surrogate.stages.sensitivity import SensitivityMethod, analysed


@dataclass(frozen=True)
class ScreeningRule:
    """The entry `screening:`: the limit of a total index, and the outputs that vote."""

    freeze_below: float
    outputs: tuple[str, ...] = ()


def nominal_values(space: Space, solver: Solver) -> dict[str, float | str]:
    """The solver's nominal values of those parameters whose range holds theirs."""
    found: dict[str, float | str] = {}
    for parameter in space.parameters:
        value = solver.inputs[parameter.name].nominal
        if value is not None and _holds(parameter, value):
            found[parameter.name] = value
    return found


def _holds(parameter: Parameter, value: float | str) -> bool:
    if parameter.distribution is None:
        return value in parameter.levels
    if isinstance(parameter.distribution, DiscreteLaw):
        return bool(parameter.distribution.allows(value))
    low, high = parameter.distribution.support
    return low <= float(value) <= high


def screening(
    screening_rule: ScreeningRule | None,
    sensitivity_method: SensitivityMethod | None,
    space: Space,
    outputs: Sequence[str],
    nominal: Mapping[str, Any],
    fits: Fits,
    comparison: xr.Dataset | None,
    sensitivity: xr.Dataset | None,
) -> Screening | None:
    """The decision; None when the study does not ask or nothing could be read.

    Outputs that vote and could not be fitted are left aside.
    """
    if screening_rule is None or sensitivity_method is None:
        return None
    if sensitivity is None or comparison is None:
        return None
    wanted = screening_rule.outputs or outputs
    voting = [name for name in wanted if name in sensitivity["output"].values]
    if not voting:
        return None
    return decide(
        sensitivity,
        screening_rule.freeze_below,
        space=space,
        fits=analysed(sensitivity_method, fits, comparison),
        outputs=voting,
        nominal=nominal,
        seed=0,
    )
