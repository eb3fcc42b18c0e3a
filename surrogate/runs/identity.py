"""What makes two runs the same run.

A run is the call of one version of one solver, with its options, at one set of
inputs. Constants and the solver's nominal values are inputs like the others, so
a parameter that is frozen at a value keeps the runs that already had that value.
A solver with the attribute `deterministic = False` may answer the same call
differently: then the number of the repetition belongs to the run too.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError, nearest
from surrogate.solver import Input, Output, Solver

RunInputs = dict[str, float | str]


@dataclass(frozen=True)
class SolverSpec:
    """A solver and how to build it again in another process.

    name     the name that the study uses; part of every run's identity
    build    class or function; `build(**options)` is the solver. It has to be importable by
             module and name, the solver that it returns need not be picklable
    options  plain values (text, numbers, lists, mappings)
    """

    name: str
    build: Callable[..., Solver]
    options: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def solver(self) -> Solver:
        """The solver, built once in this process."""
        return self.build(**self.options)

    @property
    def deterministic(self) -> bool:
        """False when the solver says that it answers the same call differently."""
        return bool(getattr(self.solver, "deterministic", True))

    @property
    def told(self) -> bool:
        """True when the solver is never called: its answers are told (`surrogate.Campaign`)."""
        return bool(getattr(self.solver, "told", False))

    @property
    def described(self) -> dict[str, Any]:
        """Name, version and options as a record of the journal keeps them."""
        return {
            "solver": self.name,
            "version": str(self.solver.version),
            "options": self.plain_options,
        }

    @property
    def recorded(self) -> bool:
        """True when the solver is a table of runs that are done: it is never called."""
        return bool(getattr(self.solver, "recorded", False))

    @property
    def context(self) -> str:
        """Name, version and options as canonical JSON: all of a run's identity but its inputs.

        A solver some of whose options change no answer, such as a time limit, tells the
        others as the mapping `identity_options`.
        """
        options = getattr(self.solver, "identity_options", self.options)
        return canonical(
            {"solver": self.name, "version": str(self.solver.version), "options": options}
        )

    @property
    def plain_options(self) -> dict[str, Any]:
        """The options as JSON would give them back."""
        return dict(json.loads(canonical(self.options)))

    def parts(
        self, calls: Sequence[RunInputs]
    ) -> Iterator[tuple[SolverSpec, NDArray[np.intp], list[RunInputs]]]:
        """The solvers that answer these calls: spec, numbers of its calls, and the calls.

        One, but for levels of fidelity (`surrogate.runs.levels`).
        """
        yield self, np.arange(len(calls)), list(calls)

    def wanted(self, names: Iterable[str] | None = None) -> dict[str, Output]:
        """The outputs called `names`, or all that the solver offers when None."""
        offered = self.solver.outputs
        chosen = list(offered) if names is None else list(names)
        mistakes = [
            f"output '{name}' is unknown; {nearest(name, offered)}"
            for name in chosen
            if name not in offered
        ]
        if mistakes:
            raise StudyError(*mistakes)
        return {name: offered[name] for name in chosen}


def run_inputs(
    spec: SolverSpec, columns: Mapping[str, Any], constants: Mapping[str, Any] | None = None
) -> list[RunInputs]:
    """The solver's keyword arguments for each run: nominal values, constants, columns.

    columns: physical values, name -> (run,). Raises `StudyError` for an input that the
    solver does not have, lacks, or that is not a finite number or a known level.
    """
    inputs, constants = spec.solver.inputs, dict(constants or {})
    given = {**constants, **columns}
    mistakes = [
        f"{spec.name} has no input '{name}'; {nearest(name, inputs)}"
        for name in given
        if name not in inputs
    ]
    mistakes += [
        f"{spec.name} needs a value for '{name}'; make it a parameter or a constant"
        for name, one in inputs.items()
        if name not in given and one.nominal is None
    ]
    if mistakes:
        raise StudyError(*mistakes)
    nominal = {name: one.nominal for name, one in inputs.items() if name not in given}
    fixed = {
        name: _value(name, inputs[name], value)
        for name, value in {**nominal, **constants}.items()
        if name not in columns
    }
    varied = [_values(name, inputs[name], column) for name, column in columns.items()]
    return [{**fixed, **dict(zip(columns, row, strict=True))} for row in zip(*varied, strict=True)]


def _values(name: str, one: Input, column: Any) -> list[float | str]:
    """A column as the solver takes it; numbers all at once, because a column may be long."""
    values = np.atleast_1d(column)
    if not one.levels and values.dtype.kind in "iuf" and np.isfinite(values).all():
        return list((values.astype(float) + 0.0).tolist())
    return [_value(name, one, value) for value in values.tolist()]


def _value(name: str, one: Input, value: Any) -> float | str:
    if one.levels:
        if str(value) not in one.levels:
            raise StudyError(f"{name}: '{value}' is not a level; {nearest(value, one.levels)}")
        return str(value)
    try:
        number = float(value) + 0.0  # -0.0 and 0.0 are one value
    except (TypeError, ValueError):
        raise StudyError(f"{name}: '{value}' is not a number") from None
    if not np.isfinite(number):
        raise StudyError(f"{name}: {number} is not finite; check the design of this parameter")
    return number


def keys(spec: SolverSpec, calls: Iterable[RunInputs]) -> list[str]:
    """Identity of each run, 32 hexadecimal digits; equal for equal runs."""
    calls = list(calls)
    found = [""] * len(calls)
    for own, numbers, asked in spec.parts(calls):
        for number, key in zip(
            numbers, keys_in(own.context, asked, own.deterministic), strict=True
        ):
            found[number] = key
    return found


def keys_in(context: str, calls: Iterable[RunInputs], deterministic: bool) -> list[str]:
    """Identity of each run of the solver that `context` describes (`SolverSpec.context`)."""
    start = hashlib.sha256(context.encode())
    repeated: Counter[str] = Counter()
    result = []
    for text in _texts(calls):
        digest = start.copy()
        digest.update(text.encode())
        if not deterministic:
            digest.update(b"#%d" % repeated[text])
            repeated[text] += 1
        result.append(digest.hexdigest()[:32])
    return result


def _texts(calls: Iterable[RunInputs]) -> Iterator[str]:
    """`json.dumps(call, sort_keys=True)` of each call, from one pattern for equal names."""
    names: list[str] = []
    pattern = ""
    for call in calls:
        if not pattern or len(call) != len(names) or not all(name in call for name in names):
            names = sorted(call)
            parts = [json.dumps(name).replace("%", "%%") + ": %s" for name in names]
            pattern = "{" + ", ".join(parts) + "}"
        yield pattern % tuple([_text(call[name]) for name in names])


def _text(value: float | str) -> str:
    """The value as JSON writes it."""
    return repr(value) if type(value) is float and value - value == 0.0 else json.dumps(value)


def canonical(value: Any) -> str:
    """JSON in which equal values are equal text: sorted keys, floats to the last digit."""
    return json.dumps(value, sort_keys=True, default=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise StudyError(
        f"{value!r} cannot be written down as an option; use text, numbers, lists or mappings"
    )
