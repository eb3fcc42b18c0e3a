"""A study's surrogates, and its solver, as models to be served.

One vector goes in: the parameters in the study's order, in the solver's units; a
categorical one as the number of its level, from 0. One vector comes out for each output,
in the study's order; fields are flattened in C order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError
from surrogate.fitting.fit import Fit
from surrogate.solver import Output
from surrogate.space.space import Parameter, Space

Array = NDArray[np.float64]
#: How far a number may be from that of a level: steps of derivatives leave levels as they are.
NEAR = 0.1


@dataclass(frozen=True)
class SurrogateModel:
    """Fitted surrogates of all outputs; points outside of the ranges are extrapolated.

    fits  output -> Fit, in the order of the output vectors
    """

    name: str
    space: Space
    fits: Mapping[str, Fit]
    differentiable: bool = True

    @property
    def input_sizes(self) -> Sequence[int]:
        """One vector of all parameters."""
        return (self.space.size,)

    @property
    def output_sizes(self) -> Sequence[int]:
        """Places of each output."""
        return [int(np.prod(fit.values.shape[1:])) for fit in self.fits.values()]

    @property
    def scales(self) -> Sequence[Array]:
        """Half the range of each parameter, in its unit; its spread where it has no ends."""
        return [np.array([_scale(parameter) for parameter in self.space.parameters])]

    def __call__(self, vectors: Sequence[Array]) -> list[Array]:
        """The surrogates' values at one point."""
        coded = self.space.encode(physical(self.space, vectors[0]))
        return [np.ravel(fit.predict(coded)[0]) for fit in self.fits.values()]


@dataclass(frozen=True)
class SolverModel:
    """The solver itself, with the study's constants.

    evaluate  physical values by name -> outputs by name; raises `SolverError` for a point
              without an answer
    """

    name: str
    space: Space
    outputs: Mapping[str, Output]
    evaluate: Callable[[Mapping[str, Any]], Mapping[str, Any]]
    differentiable: bool = False
    scales: Sequence[Array] = field(default=())

    @property
    def input_sizes(self) -> Sequence[int]:
        """One vector of all parameters."""
        return (self.space.size,)

    @property
    def output_sizes(self) -> Sequence[int]:
        """Places of each output."""
        return [int(np.prod(output.shape)) for output in self.outputs.values()]

    def __call__(self, vectors: Sequence[Array]) -> list[Array]:
        """The solver's answer at one point."""
        point = {name: column[0] for name, column in physical(self.space, vectors[0]).items()}
        found = self.evaluate(point)
        return [np.ravel(np.asarray(found[name], dtype=float)) for name in self.outputs]


def physical(space: Space, vector: Array) -> dict[str, NDArray[Any]]:
    """Columns of one physical point, name -> (1,), of a vector; raises `StudyError`."""
    return {
        p.name: np.array([_level(p, float(value)) if p.categorical else float(value)])
        for p, value in zip(space.parameters, vector, strict=True)
    }


def _level(parameter: Parameter, number: float) -> str:
    nearest = round(number)
    if abs(number - nearest) > NEAR or not 0 <= nearest < len(parameter.levels):
        raise StudyError(
            f"{parameter.name}: {number:g} is not the number of a level; "
            f"0 is {parameter.levels[0]}, {len(parameter.levels) - 1} is {parameter.levels[-1]}"
        )
    return parameter.levels[nearest]


def _scale(parameter: Parameter) -> float:
    if parameter.categorical:
        return 1.0
    ends = parameter.decode(np.array([-0.9, 0.9]))
    return float(ends[1] - ends[0]) / 1.8
