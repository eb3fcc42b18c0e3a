"""Inputs and outputs that a study declares, for solvers that cannot tell their own."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from surrogate.errors import nearest
from surrogate.solver import Input, Output
from surrogate.space import units

from .validated import Strict


class DeclaredInput(Strict):
    """An input as the study declares it; the words are those of `surrogate.solver.Input`."""

    unit: str = ""
    nominal: float | str | None = None
    range: tuple[float, float] = (-math.inf, math.inf)
    levels: tuple[str, ...] = ()
    description: str = ""
    source: str = ""


class Spread(Strict):
    """Evenly spaced coordinates: {from: 0, to: 1, count: 101}."""

    start: float = Field(alias="from")
    stop: float = Field(alias="to")
    count: int = Field(ge=1)


class DeclaredOutput(Strict):
    """An output as the study declares it.

    dims: for an array, dimension -> coordinate values, their number, or {from, to, count}.
    """

    unit: str = ""
    description: str = ""
    dims: dict[str, list[float] | int | Spread] = Field(default_factory=dict)


def inputs(declared: Mapping[str, DeclaredInput]) -> dict[str, Input]:
    """The declared inputs as the solver contract has them."""
    return {name: Input(**given.model_dump()) for name, given in declared.items()}


def outputs(declared: Mapping[str, DeclaredOutput]) -> dict[str, Output]:
    """The declared outputs as the solver contract has them."""
    return {
        name: Output(
            unit=given.unit,
            dims=tuple(given.dims),
            description=given.description,
            coordinates={dim: _coordinates(c) for dim, c in given.dims.items()},
        )
        for name, given in declared.items()
    }


def _coordinates(given: list[float] | int | Spread) -> NDArray[np.float64]:
    if isinstance(given, int):
        return np.arange(float(given))
    if isinstance(given, Spread):
        return np.linspace(given.start, given.stop, given.count)
    return np.array(given, dtype=float)


def input_mistakes(declared: Mapping[str, DeclaredInput]) -> Iterable[str]:
    """What is wrong with the inputs beyond types: a sentence each, its place first."""
    for name, given in declared.items():
        if not name.isidentifier():
            yield f"inputs.{name}: a name has letters, digits and _ only"
        yield from _unit_mistakes(f"inputs.{name}", given.unit)
        yield from _range_mistakes(name, given)


def _range_mistakes(name: str, given: DeclaredInput) -> Iterable[str]:
    low, high = given.range
    if given.levels:
        if math.isfinite(low) or math.isfinite(high):
            yield f"inputs.{name}: give either range or levels, not both"
        if given.nominal is not None and given.nominal not in given.levels:
            yield (
                f"inputs.{name}.nominal: {given.nominal!r} is not a level; "
                f"{nearest(str(given.nominal), given.levels)}"
            )
    elif not low < high:
        yield f"inputs.{name}.range: [{low:g}, {high:g}] is upside down; write [smallest, largest]"
    elif isinstance(given.nominal, str):
        yield f"inputs.{name}.nominal: {given.nominal!r} is not a number; or give levels"
    elif given.nominal is not None and not low <= given.nominal <= high:
        yield f"inputs.{name}.nominal: {given.nominal:g} lies outside range [{low:g}, {high:g}]"


def output_mistakes(declared: Mapping[str, DeclaredOutput]) -> Iterable[str]:
    """What is wrong with the outputs' units and dimensions."""
    for name, given in declared.items():
        where = f"outputs.{name}"
        yield from _unit_mistakes(where, given.unit)
        for dim, coordinates in given.dims.items():
            if not dim.isidentifier() or dim == name:
                yield f"{where}.dims: '{dim}' must be a name of its own, of letters, digits and _"
            if coordinates == [] or (isinstance(coordinates, int) and coordinates < 1):
                yield f"{where}.dims.{dim}: needs at least one coordinate"


def _unit_mistakes(where: str, unit: str) -> Iterable[str]:
    if not units.known(unit):
        yield f"{where}.unit: '{unit}' is not a unit; write for instance mm, N/mm, kPa or mmHg"
