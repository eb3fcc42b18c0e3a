"""The part `data:`: a table of runs that are done."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from surrogate.study.parts.part import Part
from surrogate.study.parts.values import Name, Texts


class DataOutputPart(Part):
    """A column that holds what was measured or computed."""

    unit: str | None = Field(
        None,
        description="Unit of the column. Default: that of the table's header.",
        examples=["MPa"],
    )


class DataTestPart(Part):
    """Which rows are held out to test the surrogates."""

    fraction: float | None = Field(
        None, gt=0, lt=1, description="Share of the rows, chosen at random.", examples=[0.2]
    )
    seed: int = Field(0, ge=0, description="Seed of the random choice of rows.", examples=[1])
    column: str | None = Field(
        None, description="A column that says train or test.", examples=["split"]
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> DataTestPart:
        if (self.fraction is None) == (self.column is None):
            raise ValueError("give either fraction (and seed) or column")
        return self


def _outputs_by_name(value: Any) -> Any:
    names = (value,) if isinstance(value, str) else value
    return {name: {} for name in names} if isinstance(names, list | tuple) else value


DataOutputs = Annotated[
    dict[str, DataOutputPart],
    BeforeValidator(
        _outputs_by_name, json_schema_input_type=str | list[str] | dict[str, DataOutputPart]
    ),
]


class DataPart(Part):
    """A table of runs that are done: in place of a solver, or beside it."""

    file: str = Field(
        description="The table: csv, tsv, xlsx, parquet or nc, relative to the study file.",
        examples=["tests.csv"],
    )
    sheet: str | None = Field(
        None, description="Sheet of an Excel file. Default: its first.", examples=["Tests 2024"]
    )
    outputs: DataOutputs = Field(
        {},
        description="Columns that are outputs. Default: guessed, and told.",
        examples=[{"strength": {"unit": "MPa"}}, ["strength", "weight"]],
    )
    rename: dict[str, Name] = Field(
        {},
        description="Names in the study for headers of the table.",
        examples=[{"Temp (degC)": "temperature"}],
    )
    leave_out: Texts = Field(
        (),
        description="Columns that are neither inputs nor outputs.",
        examples=[["operator", "date"]],
    )
    test: DataTestPart | None = Field(
        None,
        description="Rows that are held out to test the surrogates.",
        examples=[{"fraction": 0.2, "seed": 1}],
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"file": value} if isinstance(value, str) else value
