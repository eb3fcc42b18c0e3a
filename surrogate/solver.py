"""The solver contract: what a simulation tells about itself, on one screen.

A solver is any object with `inputs`, `outputs`, `version` and `__call__`. No
inheritance: ::

    class Beam:
        \"\"\"Tip deflection of a cantilever.\"\"\"
        version = "1"
        inputs = {
            "load": Input(unit="N", nominal=10.0, range=(0.0, 100.0)),
            "length": Input(unit="m", nominal=1.0, range=(0.1, 3.0)),
        }
        outputs = {"tip": Output(unit="mm")}

        def __call__(self, load, length):
            return {"tip": load * length**3 / 3 / 210.0}

A study calls the class with the study's solver options and then the instance
once a run, by keyword, in the units that `inputs` states.

Five more attributes are optional: `deterministic = False` says that the same inputs
may give another answer, so that replicates are run; `identity_options` is the
mapping of those options that change answers, when some do not (a time limit);
`constraints` is a tuple of `Constraint`, where the ranges of the inputs hang on each other;
`told = True` says that it is never called, because its answers are told (`surrogate.Campaign`);
`scene(**inputs)` gives its geometry, which the report turns and colours (`surrogate.scene`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np


@dataclass(frozen=True)
class Input:
    """A quantity that the solver takes.

    unit         a pint unit, "" when dimensionless
    nominal      the value used when a study does not vary it (None: a study must give it)
    range        smallest and largest value that the solver accepts, in `unit`
    levels       the names it accepts, when it is categorical (then no range)
    description  what it is
    source       where nominal value and range come from
    """

    unit: str = ""
    nominal: float | str | None = None
    range: tuple[float, float] = (-np.inf, np.inf)
    levels: tuple[str, ...] = ()
    description: str = ""
    source: str = ""


@dataclass(frozen=True)
class Constraint:
    """A condition that joins several inputs: a point that breaks it has no answer.

    The ranges of `Input` are those of each input alone. (What a study asks of its parameters
    is a `surrogate.space.constraints.Relation`, read from text.) ::

        constraints = (Constraint(("inner", "outer"), smaller, "inner must be below outer"),)

    inputs    the names of the inputs that it joins
    holds     holds(*values), their values in this order, says whether a point keeps it
    sentence  what must hold, and what to change where it does not
    """

    inputs: tuple[str, ...]
    holds: Callable[..., Any]
    sentence: str


def broken(solver: Solver, points: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """How many of the points, each with every input, break each constraint: by its sentence.

    Constraints that all points keep are left out.
    """
    counts = {
        one.sentence: sum(not one.holds(*(point[name] for name in one.inputs)) for point in points)
        for one in constraints_of(solver)
    }
    return {sentence: count for sentence, count in counts.items() if count}


def constraints_of(solver: Any) -> tuple[Constraint, ...]:
    """The constraints that a solver declares; () for one that declares none."""
    return tuple(getattr(solver, "constraints", ()))


@dataclass(frozen=True)
class Output:
    """A quantity that the solver returns: a float, or an array over `dims`.

    coordinates maps each name in `dims` to its coordinate values, shape (size,). Answers
    are finite, unless `gaps` says that NaN is an answer: the quantity does not exist at
    that point. Surrogates of it learn from the runs where it exists.
    """

    unit: str = ""
    dims: tuple[str, ...] = ()
    coordinates: Mapping[str, np.ndarray] = field(default_factory=dict)
    description: str = ""
    gaps: bool = False

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes along `dims`; `()` for a scalar."""
        return tuple(len(self.coordinates[dim]) for dim in self.dims)


@runtime_checkable
class Solver(Protocol):
    """What a study needs of a solver; see the module's first lines.

    `__call__` returns a float or array for each name in `outputs`. It raises
    `surrogate.errors.SolverError` for a point that has no answer, with a
    sentence that says why; the study keeps that point as a failed run.
    """

    inputs: Mapping[str, Input]
    outputs: Mapping[str, Output]
    version: str

    def __call__(self, **inputs: Any) -> Mapping[str, Any]: ...
