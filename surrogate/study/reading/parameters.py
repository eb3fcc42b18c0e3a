"""From the words of a study to its parameters: ranges, laws, levels and their correlation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError, nearest
from surrogate.solver import Input, Solver
from surrogate.space import laws, units
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import UNBOUNDED, distribution
from surrogate.space.fitted import FROM_DATA, law_of
from surrogate.space.space import Parameter, Space
from surrogate.study.parts.inputs import ParameterPart
from surrogate.study.reading.constants import check_accepted, constants_of
from surrogate.study.reading.constraints import constraints_of
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.solver import owner


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
                f"{owner(solver)} has no input '{name}'; {nearest(name, solver.inputs)}",
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
        check_accepted(few.support, taken)
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
    check_accepted(law.support, taken)
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
    check_accepted(law.support, taken)
    reading.notes.append(f"{name}: {sentence}")
    return Parameter(name, law, unit=taken.unit, description=taken.description)


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
