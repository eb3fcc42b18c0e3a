"""From the words of a study to its constants, in the units of its solver."""

from __future__ import annotations

import numpy as np

from surrogate.errors import StudyError, nearest
from surrogate.solver import Input, Solver
from surrogate.space import units
from surrogate.study.parts.inputs import ConstantPart
from surrogate.study.reading.mistakes import Reading


def constants_of(reading: Reading, solver: Solver) -> dict[str, float | str]:
    """Fixed values of inputs, in the solver's units; nominal values are not repeated here."""
    constants: dict[str, float | str] = {}
    if getattr(solver, "recorded", False) and reading.part.constants:
        reading.wrong(
            "a table has no constants: each of its columns varies; name columns that are no "
            "inputs under data: leave_out",
            "constants",
            on_key=True,
        )
        return constants
    for name, part in reading.part.constants.items():
        if name not in solver.inputs:
            reading.wrong(
                f"the solver has no input '{name}'; {nearest(name, solver.inputs)}",
                "constants",
                name,
                on_key=True,
            )
        elif name in reading.part.parameters:
            reading.wrong(
                f"'{name}' is also a parameter; it either varies or is fixed",
                "constants",
                name,
                on_key=True,
            )
        else:
            with reading.mistakes_at("constants", name):
                constants[name] = _constant(part, solver.inputs[name])
    given = {
        *reading.part.parameters,
        *reading.part.constants,
        *(path[1] for path in reading.broken if len(path) > 1),
    }
    for name, taken in solver.inputs.items():
        if taken.nominal is None and name not in given:
            reading.wrong(
                f"the solver needs '{name}' and has no nominal value for it; "
                "add it to parameters or constants",
                "constants",
                on_key=True,
            )
    return constants


def _constant(part: ConstantPart, taken: Input) -> float | str:
    if taken.levels:
        if part.value not in taken.levels:
            raise StudyError(
                f"level '{part.value}' is unknown; {nearest(str(part.value), taken.levels)}"
            )
        return part.value
    unit = taken.unit if part.unit is None else part.unit
    number = units.quantity(part.value, unit) if isinstance(part.value, str) else part.value
    value = units.conversion(unit, taken.unit).place(number)
    check_accepted((value, value), taken)
    return value


def check_accepted(support: tuple[float, float], taken: Input) -> None:
    """Refuse a support that reaches beyond what the solver accepts."""
    unit = f" {taken.unit}".rstrip()
    ends = (
        ("smallest", "below", support[0], taken.range[0], support[0] < taken.range[0]),
        ("largest", "above", support[1], taken.range[1], support[1] > taken.range[1]),
    )
    over = [end[:4] for end in ends if end[4]]
    if not all(np.isfinite(value) for _, _, value, _ in over):
        raise StudyError(
            "this distribution goes beyond what the solver accepts "
            f"({taken.range[0]:g} to {taken.range[1]:g}{unit}); "
            "add range: [.., ..] to cut it off"
        )
    if over:
        raise StudyError(
            *(
                f"{value:g}{unit} is {side} the {word} value that the solver accepts "
                f"({limit:g}{unit}); check the value and its unit"
                for word, side, value, limit in dict.fromkeys(over)
            )
        )
