"""Kinds of values in a study file: numbers, names, durations, sizes, lists of text."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from surrogate.errors import StudyError

Number = Annotated[float, Field(strict=False, allow_inf_nan=False)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]


def _seconds(value: Any) -> float | None:
    from surrogate.space import units  # pint: not for those who only want the schema

    try:
        return None if value is None else units.seconds(value)
    except StudyError as error:
        raise ValueError(str(error)) from None


def _bytes(value: Any) -> float | None:
    from surrogate.space import units

    try:
        return None if value is None else units.size(value)
    except StudyError as error:
        raise ValueError(str(error)) from None


#: Bytes.
Size = Annotated[
    float | None, BeforeValidator(_bytes, json_schema_input_type=str | float), Field(gt=0)
]

Duration = Annotated[
    float | None, BeforeValidator(_seconds, json_schema_input_type=str | float), Field(gt=0)
]


def _listed(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


#: One text, or a list of them.
Texts = Annotated[
    tuple[str, ...], BeforeValidator(_listed, json_schema_input_type=str | tuple[str, ...])
]


def names_only(value: Any) -> Any:
    """The value; raises `ValueError` for a list of numbers where names are meant."""
    if isinstance(value, list | tuple) and value and all(_is_number(one) for one in value):
        shown = ", ".join(f"{one:g}" for one in value)
        raise ValueError(f"levels are names; for numbers write values: [{shown}]")
    return value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
