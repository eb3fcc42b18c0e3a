"""What every format tells of a surrogate: where it comes from, its inputs, its output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from surrogate.errors import StudyError, nearest
from surrogate.export.formula import Formula, formula
from surrogate.fitting.fit import Fit
from surrogate.solver import Output
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.space import Parameter


@dataclass(frozen=True)
class Input:
    """One input, physical; a level is given by its number from 0.

    coding   as in the portable document
    allowed  the values that the study let it take, in words
    ends     smallest and largest value; None where it has none
    start    the solver's nominal value or the middle
    whole    True for numbers of levels and whole numbers
    """

    name: str
    unit: str
    description: str
    coding: Mapping[str, Any]
    allowed: str
    ends: tuple[float, float] | None
    start: float
    whole: bool

    @property
    def levels(self) -> tuple[str, ...]:
        """Names of the levels; () for a number."""
        return tuple(self.coding.get("levels", ()))

    @property
    def told(self) -> str:
        """`load in N, from 10 to 90`."""
        return f"{self.name}{f' in {self.unit}' if self.unit else ''}, {self.allowed}"


@dataclass(frozen=True)
class Coordinate:
    """Where the places of a field lie along one dimension: numbers, or names."""

    name: str
    values: tuple[float, ...] | tuple[str, ...]

    @property
    def numeric(self) -> bool:
        """True for numbers."""
        return not isinstance(self.values[0], str)


@dataclass(frozen=True)
class Description:
    """A surrogate of one output of a study, to be called `name` in another language.

    document     the portable one
    q2           of left-out runs
    constants    values of the study's constants
    coordinates  of a field, one for each dimension; places are in C order
    """

    name: str
    study: str
    output: str
    surrogate: str
    unit: str
    about: str
    q2: float
    inputs: tuple[Input, ...]
    constants: Mapping[str, float | str]
    coordinates: tuple[Coordinate, ...]
    document: Mapping[str, Any]

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of a field; () for a scalar."""
        return tuple(len(one.values) for one in self.coordinates)

    @cached_property
    def formula(self) -> Formula:
        """The surrogate as factors, terms and arrays."""
        return formula(self.document)

    @property
    def deviation(self) -> str:
        """What the standard deviation is, in words."""
        if self.document["error"]["kind"] == "own":
            return "of a new run, the surrogate's own"
        return "the same everywhere: root mean square of the left-out errors"

    def lines(self) -> list[str]:
        """The lines that stand at the head of a file."""
        about = f"{self.output}{f' in {self.unit}' if self.unit else ''}"
        lines = [
            f"{about}: surrogate '{self.surrogate}' of the study '{self.study}'.",
            *([self.about] if self.about not in ("", self.output) else []),
            f"Q2 {self.q2:.4g}, by runs that were left out. Outside of the ranges it extrapolates.",
            f"Standard deviation: {self.deviation}.",
            "",
            "Inputs, in this order:",
            *(f"  x[{i}]  {one.told}" for i, one in enumerate(self.inputs)),
        ]
        if self.constants:
            held = (f"{name} = {value}" for name, value in self.constants.items())
            lines.append(f"Held by the study: {', '.join(held)}.")
        if self.shape:
            dims = " x ".join(f"{one.name} ({len(one.values)})" for one in self.coordinates)
            lines.append(f"A field over {dims}, the last dimension fastest.")
        return [" ".join(line.split()) if line[:1] != " " else line for line in lines]


def describe(
    fit: Fit,
    output: Output,
    *,
    name: str,
    study: str,
    nominal: Mapping[str, float | str],
    constants: Mapping[str, float | str],
) -> Description:
    """The description of a fit; raises `FitError` when it has no portable form."""
    document = fit.portable()
    inputs = tuple(
        _input(parameter, given["coding"], nominal.get(parameter.name))
        for parameter, given in zip(fit.space.parameters, document["inputs"], strict=True)
    )
    return Description(
        name,
        study,
        fit.output,
        fit.surrogate,
        output.unit,
        output.description,
        fit.q2,
        inputs,
        dict(constants),
        _coordinates(output, fit.values.shape[1:]),
        document,
    )


def chosen_output(asked: str | None, outputs: Sequence[str]) -> str:
    """The output that is asked for, or the only one; raises `StudyError`."""
    if asked is None and len(outputs) == 1:
        return outputs[0]
    if asked is None:
        raise StudyError(f"a file holds one output; name it by --output. {nearest('', outputs)}")
    if asked not in outputs:
        raise StudyError(f"output '{asked}' is unknown; {nearest(asked, outputs)}")
    return asked


def _input(parameter: Parameter, coding: Mapping[str, Any], nominal: Any) -> Input:
    if parameter.categorical:
        levels = parameter.levels
        numbered = ", ".join(f"{number} {level}" for number, level in enumerate(levels))
        start = float(levels.index(nominal)) if nominal in levels else 0.0
        allowed, last = f"the number of its level: {numbered}", len(levels) - 1.0
        words = (parameter.name, "", parameter.description)
        return Input(*words, coding, allowed, (0.0, last), start, True)
    law = parameter.law
    whole = isinstance(law, DiscreteLaw) and bool((law.values == np.rint(law.values)).all())
    ends = law.support if parameter.bounded else None
    start = float(parameter.decode(0.0)) if nominal is None else float(nominal)
    uniform = ends is not None and not isinstance(law, DiscreteLaw)
    allowed = f"from {law.support[0]:.12g} to {law.support[1]:.12g}" if uniform else str(law)
    words = (parameter.name, parameter.unit, parameter.description)
    return Input(*words, coding, allowed, ends, start, whole)


def _coordinates(output: Output, shape: tuple[int, ...]) -> tuple[Coordinate, ...]:
    """Coordinates along each dimension of a field; numbers from 0 where there are none."""
    dims = (
        output.dims if len(output.dims) == len(shape) else [f"dim_{k}" for k in range(len(shape))]
    )
    return tuple(
        Coordinate(dim, _values(np.asarray(output.coordinates.get(dim, np.arange(size)))))
        for dim, size in zip(dims, shape, strict=True)
    )


def _values(values: np.ndarray) -> tuple[float, ...] | tuple[str, ...]:
    if np.issubdtype(values.dtype, np.number):
        return tuple(map(float, values.tolist()))
    return tuple(map(str, values.tolist()))
