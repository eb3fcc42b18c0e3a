"""From the words of a study to its solver, parameters, constants and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError, nearest
from surrogate.runs.identity import SolverSpec
from surrogate.runs.names import name_mistakes
from surrogate.solver import Input, Output, Solver
from surrogate.space import laws, units
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import UNBOUNDED, distribution
from surrogate.space.fitted import FROM_DATA, law_of
from surrogate.space.space import Parameter, Space
from surrogate.stages.plugin import call
from surrogate.study import plugins
from surrogate.study.kinds import check_kind
from surrogate.study.options import option_mistakes
from surrogate.study.parts import ConstantPart, ParameterPart, SolverPart
from surrogate.study.reading.building import limited
from surrogate.study.reading.constraints import constraints_of
from surrogate.study.reading.mistakes import Reading
from surrogate.study.solver_factory import SolverFactory

#: Parameters of a solver's constructor that the framework fills in; they are not options.
GIVEN_TO_SOLVERS = ("self", "folder")


def solver_of(
    reading: Reading, part: SolverPart | None = None, path: tuple[str, ...] = ("solver",)
) -> tuple[SolverSpec, Solver | None]:
    """The study's solver, or that of `part`, built once here to learn its inputs and outputs."""
    part = part or reading.part.solver or SolverPart(name="unnamed", options={})
    spec = SolverSpec(part.name, SolverFactory(part.name, reading.folder), part.options)
    if reading.is_broken(*path):
        return spec, None
    with reading.mistakes_at(*path, "name"):
        found = plugins.load(plugins.SOLVERS, part.name, reading.folder)
        check_kind(plugins.SOLVERS, part.name, found)
        path_of_found = plugins.path_of(plugins.SOLVERS, part.name)
        spec = replace(spec, build=SolverFactory(path_of_found, reading.folder))
        mistakes = option_mistakes(found, part.options, GIVEN_TO_SOLVERS)
        reading.add(mistakes, *path, "options")
        solver = None if mistakes else _built(spec, reading, path)
        if solver is not None:
            return spec, solver
        # Options that are right, or none, may build a solver to check the rest of the study with.
        wrong = {mistake.path[0] for mistake in mistakes if mistake.path}
        sound = {name: value for name, value in part.options.items() if name not in wrong}
        aside = replace(reading, mistakes=[])
        for options in (sound, {}) if mistakes else ({},) if part.options else ():
            solver = _built(replace(spec, options=options), aside, path)
            if solver is not None:
                return spec, solver
    return spec, None


def _built(spec: SolverSpec, reading: Reading, path: tuple[str, ...]) -> Solver | None:
    with reading.mistakes_at(*path, "options"):
        failure = f"solver '{spec.name}' cannot be built"
        with limited(failure, reading.part.execution.timeout):
            solver = call(failure, lambda: spec.solver)
        if isinstance(solver, Solver):
            described = (("inputs", solver.inputs, Input), ("outputs", solver.outputs, Output))
            mistakes = [
                f"'{spec.name}' is not a solver: its {what} must map names to "
                f"surrogate.solver.{kind.__name__}"
                for what, given, kind in described
                if not isinstance(given, Mapping)
                or not all(isinstance(one, kind) for one in given.values())
            ]
            for sentence in mistakes:
                reading.wrong(sentence, *path, "name")
            return None if mistakes else solver
        lacking = [name for name in ("inputs", "outputs", "version") if not hasattr(solver, name)]
        reading.wrong(
            f"'{spec.name}' is not a solver: it has no {', '.join(lacking) or '__call__'}",
            *path,
            "name",
        )
    return None


def _owner(solver: Solver) -> str:
    """Who has the inputs and outputs that messages speak of."""
    return "the table" if getattr(solver, "recorded", False) else "the solver"


def space_of(
    reading: Reading, solver: Solver, columns: Mapping[str, NDArray[np.float64]] | None = None
) -> Space | None:
    """Parameters with their ranges in the solver's units, and their correlation.

    columns: values of inputs in the study's data, for laws that come from them.
    """
    parameters = []
    for name, part in reading.part.parameters.items():
        if name not in solver.inputs:
            reading.wrong(
                f"{_owner(solver)} has no input '{name}'; {nearest(name, solver.inputs)}",
                "parameters",
                name,
                on_key=True,
            )
            continue
        with reading.mistakes_at("parameters", name):
            if part.distribution in FROM_DATA:
                values = (columns or {}).get(name)
                parameters.append(_from_data(reading, name, part, solver.inputs[name], values))
            else:
                parameters.append(_parameter(name, part, solver.inputs[name]))
    declared = len(reading.part.parameters)
    if (
        not declared
        and not reading.is_broken("parameters")
        and not any(path[0] == "parameters" for path in reading.broken)
    ):
        reading.wrong("name at least one parameter that varies", "parameters")
    if len(parameters) < declared or not parameters:
        return None
    correlation = None
    with reading.mistakes_at("correlation"):
        correlation = _correlation(reading, [p.name for p in parameters])
        space = Space(tuple(parameters), correlation)
        if not reading.part.constraints:
            return space
    constants = constants_of(replace(reading, mistakes=[]), solver)
    before = len(reading.mistakes)
    constraints, fixed = constraints_of(reading, solver, constants)
    if len(reading.mistakes) > before:
        return None
    with reading.mistakes_at("constraints"):
        return Space(tuple(parameters), correlation, constraints, fixed)
    return None


def _parameter(name: str, part: ParameterPart, taken: Input) -> Parameter:
    if part.levels or taken.levels:
        return _categorical(name, part, taken)
    unit = taken.unit if part.unit is None else part.unit
    convert = units.conversion(unit, taken.unit)
    kind = part.distribution or "uniform"
    accepted = [*laws.option_names(kind)[0], *ParameterPart.model_fields]
    mistakes = [
        f"key '{word}' is unknown here; {nearest(word, accepted)}"
        for word in part.options
        if word not in accepted
    ]
    mistakes += [
        f"{word} {value!r}: must be a number"
        for word, value in part.options.items()
        if word in accepted and (isinstance(value, bool) or not isinstance(value, int | float))
    ]
    mistakes += _contradictions(part)
    if part.range is None and part.distribution is None and part.values is None and not mistakes:
        mistakes.append("give a range [smallest, largest], values or a distribution")
    if mistakes:
        raise StudyError(*mistakes)
    words = {
        word: (
            convert.place
            if word in laws.LOCATION_WORDS
            else convert.distance
            if word in laws.SCALE_WORDS
            else float
        )(value)
        for word, value in part.options.items()
    }
    if part.values is not None or part.integer:
        if part.values is not None:
            few = listed(map(convert.place, part.values), kind, **words)
        else:
            few = integers(part.range or UNBOUNDED, kind, convert=convert, **words)
        _check_accepted(few.support, taken)
        return Parameter(name, few, unit=taken.unit, description=taken.description)
    if part.range is None:
        limits = UNBOUNDED
    else:
        limits = (convert.place(part.range[0]), convert.place(part.range[1]))
    if (
        "scale" in accepted
        and convert != units.IDENTITY
        and (part.range is None or not laws.ends_from_range(kind, words))
    ):  # a law of scipy stands at 0 and has scale 1, in the unit that the study writes
        words = {"loc": convert.place(0.0), "scale": convert.distance(1.0), **words}
    law = distribution(kind, range=limits, **words)
    _check_accepted(law.support, taken)
    return Parameter(name, law, unit=taken.unit, description=taken.description)


def _contradictions(part: ParameterPart) -> list[str]:
    """Sentences about keys of a discrete parameter that do not go together."""
    found = []
    if part.values is not None and part.range is not None:
        found.append("give values or a range, not both; values say which numbers are allowed")
    if part.values is not None and part.integer:
        found.append("integer: true belongs to a range; values say which numbers are allowed")
    elif part.integer and part.range is None:
        found.append("integer: true needs a range: [smallest, largest]")
    return found


def _from_data(
    reading: Reading,
    name: str,
    part: ParameterPart,
    taken: Input,
    values: NDArray[np.float64] | None,
) -> Parameter:
    """A parameter whose law is that of a column."""
    if values is None:
        raise StudyError(
            f"distribution: {part.distribution} needs a column of numbers '{name}' in data:; "
            "write another distribution, or a range"
        )
    if part.options:
        raise StudyError(
            *(f"distribution: {part.distribution} does not take '{word}'" for word in part.options)
        )
    convert = units.conversion(taken.unit if part.unit is None else part.unit, taken.unit)
    limits = (convert.place(part.range[0]), convert.place(part.range[1])) if part.range else None
    law, sentence = law_of(part.distribution or "fit", values, limits or UNBOUNDED)
    _check_accepted(law.support, taken)
    reading.notes.append(f"{name}: {sentence}")
    return Parameter(name, law, unit=taken.unit, description=taken.description)


def _check_accepted(support: tuple[float, float], taken: Input) -> None:
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


def _categorical(name: str, part: ParameterPart, taken: Input) -> Parameter:
    if not taken.levels:
        raise StudyError(
            f"levels are for named choices, but the solver takes a number "
            f"({taken.unit or 'no unit'}) here; give a range or values"
        )
    if not part.levels:
        raise StudyError(f"the solver takes names here; give levels: [{', '.join(taken.levels)}]")
    unknown = [level for level in part.levels if level not in taken.levels]
    if unknown:
        raise StudyError(
            *(f"level '{level}' is unknown; {nearest(level, taken.levels)}" for level in unknown)
        )
    return Parameter(name, levels=part.levels, description=taken.description)


def _correlation(reading: Reading, names: list[str]) -> tuple[tuple[float, ...], ...] | None:
    if not reading.part.correlation:
        return None
    matrix = np.eye(len(names))
    for index, (first, second, value) in enumerate(reading.part.correlation):
        unknown = [name for name in (first, second) if name not in names]
        for name in unknown:
            reading.wrong(
                f"'{name}' is not a parameter of this study; {nearest(name, names)}",
                "correlation",
                index,
            )
        if not unknown:
            i, j = names.index(first), names.index(second)
            matrix[i, j] = matrix[j, i] = value
    return tuple(map(tuple, matrix.tolist()))


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
    _check_accepted((value, value), taken)
    return value


def outputs_of(reading: Reading, solver: Solver, space: Space | None) -> tuple[str, ...]:
    """Names of the outputs that are kept."""
    names = reading.part.outputs or tuple(solver.outputs)
    for index, name in enumerate(names):
        if name not in solver.outputs:
            reading.wrong(
                f"{_owner(solver)} has no output '{name}'; {nearest(name, solver.outputs)}",
                "outputs",
                index,
            )
    kept = {name: solver.outputs[name] for name in names if name in solver.outputs}
    if space is not None:
        for sentence in name_mistakes(space, kept):
            reading.wrong(sentence, "outputs", on_key=True)
    return tuple(kept)
