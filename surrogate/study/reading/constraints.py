"""From the `constraints:` of a study to constraints between its parameters."""

from __future__ import annotations

from collections.abc import Mapping

from surrogate.solver import Solver
from surrogate.space.constraint_text import parse
from surrogate.space.constraints import Relation
from surrogate.study.reading.mistakes import Reading


def constraints_of(
    reading: Reading, solver: Solver, constants: Mapping[str, float | str]
) -> tuple[tuple[Relation, ...], tuple[tuple[str, float], ...]]:
    """The constraints, and (name, value) of what they name that does not vary.

    They may name numeric parameters, constants, and inputs that keep their nominal value. One
    that names no parameter is checked here and left out.
    """
    nominal = {name: one.nominal for name, one in solver.inputs.items()}
    fixed = {
        name: float(value)
        for name, value in {**nominal, **constants}.items()
        if name not in reading.part.parameters
        and isinstance(value, int | float)
        and not solver.inputs[name].levels
    }
    numeric = {
        name: one.unit
        for name, one in solver.inputs.items()
        if not one.levels and (name in fixed or name in reading.part.parameters)
    }
    found: list[Relation] = []
    for index, text in enumerate(reading.part.constraints):
        with reading.mistakes_at("constraints", index):
            one = parse(text, numeric)
            if any(name in reading.part.parameters for name in one.names):
                found.append(one)
            elif not one.holds({name: fixed[name] for name in one.names}).all():
                reading.wrong(
                    f"constraint '{text}' names no parameter, and the constants break it",
                    "constraints",
                    index,
                )
    named = {name for one in found for name in one.names}
    return tuple(found), tuple((name, fixed[name]) for name in fixed if name in named)
