"""What a study runs and with what: solver, parameters, constants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from surrogate.study.parts.part import OpenPart, Part
from surrogate.study.parts.values import Number, names_only


class SolverPart(Part):
    """Which simulation to run."""

    name: str = Field(
        description="One that `surrogate list` shows, or module:object beside the study.",
        examples=["borehole", "my_beam:Beam"],
    )
    options: dict[str, Any] = Field(
        {}, description="Options of that solver.", examples=[{"mesh": "coarse"}]
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"name": value} if isinstance(value, str) else value


class ParameterPart(OpenPart):
    """What varies: a range, a distribution with its words, values, or levels."""

    range: tuple[Number, Number] | None = Field(
        None, description="Smallest and largest value.", examples=[[0.1, 0.3]]
    )
    distribution: str | None = Field(
        None,
        description="uniform, normal, lognormal, triangular "
        "or a continuous scipy.stats name; its words (mean, std, ...) stand beside it, and a "
        "range truncates it. "
        "From the column of data: fit (the likeliest law), data (the values, smoothed).",
        examples=["normal", "lognormal", "fit"],
    )
    integer: bool = Field(False, description="Whole numbers of the range only.", examples=[True])
    values: tuple[Number, ...] | None = Field(
        None,
        description="The only values of an ordered quantity, such as sizes in a catalogue.",
        examples=[[10, 12, 16, 20]],
    )
    levels: Annotated[
        tuple[str, ...] | None,
        BeforeValidator(names_only, json_schema_input_type=tuple[str, ...] | None),
    ] = Field(None, description="Names, for a categorical input.", examples=[["soft", "stiff"]])
    unit: str | None = Field(
        None,
        description="Unit of the numbers here; they are converted to the solver's unit. "
        "Default: the solver's unit.",
        examples=["N/mm", "degC"],
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"range": value} if isinstance(value, list | tuple) else value


class ConstantPart(Part):
    """A fixed value of an input."""

    value: Number | str = Field(
        description="The value: a number, or the name of a level.", examples=[0.6, "soft"]
    )
    unit: str | None = Field(
        None, description="Unit of the value. Default: the solver's unit.", examples=["mm"]
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return value if isinstance(value, Mapping) else {"value": value}
