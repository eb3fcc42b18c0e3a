"""The part `calibration:` of a study file: measurements, and the inputs to learn from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from surrogate.fitting.best import BEST
from surrogate.study.parts.part import OpenPart, Part
from surrogate.study.parts.values import Name, Number, Texts


class PriorPart(OpenPart):
    """What is known of a free input before the measurements."""

    distribution: str | None = Field(
        None,
        description="A law as of parameters, its words beside it. Default: the study's own law.",
        examples=["normal"],
    )
    range: tuple[Number, Number] | None = Field(
        None,
        description="Smallest and largest value. Default: the range of the parameter.",
        examples=[[0.08, 0.12]],
    )
    unit: str | None = Field(
        None, description="Unit of the numbers here. Default: the solver's unit.", examples=["N/mm"]
    )


def _free(value: Any) -> Any:
    names = (value,) if isinstance(value, str) else value
    if isinstance(names, list | tuple):
        return {name: {} for name in names}
    if isinstance(names, Mapping):
        return {name: {} if one is None else one for name, one in names.items()}
    return names


#: Inputs with their priors, or a list of names.
Free = Annotated[
    dict[Name, PriorPart],
    BeforeValidator(_free, json_schema_input_type=str | list[str] | dict[str, PriorPart | None]),
]

#: A number or a text with a unit, or `estimate`.
Error = Number | str


class CalibrationPart(Part):
    """Inputs that are learnt from measurements."""

    cases: str = Field(
        description="Measurements, relative to the study file: columns for the inputs known in "
        "the experiment, the outputs and, if wanted, <output>_error.",
        examples=["measured.csv"],
    )
    free: Free = Field(
        min_length=1,
        description="Inputs to learn, each with its prior; a name alone keeps the study's law.",
        examples=[{"tension": {"distribution": "normal", "mean": 0.098, "std": 0.02}}, ["tension"]],
    )
    discrepancy: bool = Field(
        False,
        description="Whether reality may differ from the solver: a Gaussian process over the known "
        "inputs is estimated too.",
        examples=[True],
    )
    output: Texts = Field(
        (),
        description="Outputs to learn from. Default: every scalar output that the cases have.",
        examples=["pressure_b1"],
    )
    error: Error | dict[Name, Error] | None = Field(
        None,
        description="Standard deviation of measurement where the cases give none, for all outputs "
        "or by name; or estimate. Default: estimate.",
        examples=["2 mmHg", "estimate"],
    )
    surrogate: str = Field(
        BEST, description="A surrogate's name, or best of each output.", examples=["gp"]
    )
    draws: int = Field(
        4000, ge=100, le=200_000, description="Posterior draws to keep.", examples=[4000]
    )
    seed: int = Field(0, ge=0, description="Seed of the draws.", examples=[1])
