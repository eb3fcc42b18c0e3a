"""From the words of `calibration:` to measurements, priors and a problem."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.calibration.problem import Law, Measured, Problem
from surrogate.calibration.sampling import check_installed
from surrogate.errors import StudyError, nearest
from surrogate.solver import Output, Solver
from surrogate.space import laws, units
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.distributions import distribution
from surrogate.space.space import Parameter, Space
from surrogate.study.parts.calibration import CalibrationPart, PriorPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import check_surrogate, is_scalar
from surrogate.study.reading.validation import cases_at
from surrogate.validation.cases import Cases, lacking
from surrogate.validation.validation import fixed_inputs, outputs_in, outside, varied

PATH, ESTIMATE, SUFFIX = "calibration", "estimate", "_error"


def calibration_of(
    reading: Reading,
    solver: Solver,
    space: Space | None,
    kept: Iterable[str],
    constants: Mapping[str, Any],
) -> Problem | None:
    """The problem; whatever would keep it from being solved is a mistake.

    kept: the study's outputs.
    """
    part = reading.part.calibration
    if part is None or space is None:
        return None
    before = len(reading.mistakes)
    with reading.mistakes_at(PATH):
        check_installed()
    check_surrogate(reading, part.surrogate, "calibration reads a surrogate", PATH)
    offered = {name: solver.outputs[name] for name in kept if name in solver.outputs}
    wanted = _outputs(reading, part, offered)
    priors = _priors(reading, part, space)
    found = None
    with reading.mistakes_at(PATH, "cases"):
        found = cases_at((reading.folder or Path()) / part.cases, part.cases, _no_study)
        found = found.in_units({**solver.inputs, **solver.outputs})
    if found is None or len(reading.mistakes) > before:
        return None
    with reading.mistakes_at(PATH, "cases"):
        known = _known(found, space, priors, offered, wanted)
        chosen = {name: offered[name].unit for name in outputs_in(found, offered, wanted)}
        why = outside([space[name] for name in known], known)
        inside = np.array([not words for words in why])
        if not inside.any():
            raise StudyError(
                f"no case of '{part.cases}' lies inside the ranges of the study; the first: "
                f"{why[0]}"
            )
        measured = _measured(reading, part, found, chosen, inside)
        notes = varied(
            found, space, fixed_inputs(solver, space, constants), "effect of the free inputs"
        )
        if not inside.all():
            aside = "; ".join(
                f"{found.labels[k]}: {why[k]}" for k in np.flatnonzero(~inside)[:5].tolist()
            )
            notes.append(
                f"set aside, outside of the study's ranges: {int((~inside).sum())} of "
                f"{len(inside)} cases ({aside})"
            )
        return Problem(
            space,
            priors,
            _coded(space, {name: values[inside] for name, values in known.items()}, inside.sum()),
            tuple(np.asarray(found.labels)[inside].tolist()),
            measured,
            part.discrepancy,
            part.surrogate,
            part.draws,
            part.seed,
            cases=part.cases,
            notes=tuple(notes),
        )
    return None


def _no_study(path: Path) -> Any:
    raise StudyError(f"cases '{path.name}': a calibration needs measurements in a table")


def _outputs(
    reading: Reading, part: CalibrationPart, offered: Mapping[str, Output]
) -> tuple[str, ...]:
    needed = "calibration needs single numbers"
    return tuple(
        name
        for index, name in enumerate(part.output)
        if is_scalar(reading, name, offered, needed, PATH, "output", index)
    )


# priors ---------------------------------------------------------------------------------------


def _priors(reading: Reading, part: CalibrationPart, space: Space) -> dict[str, Law]:
    found: dict[str, Law] = {}
    for name, prior in part.free.items():
        if name not in space.names:
            if not reading.is_broken("parameters", name):
                reading.wrong(
                    f"'{name}' is not a parameter of this study; {nearest(name, space.names)}",
                    PATH,
                    "free",
                    name,
                    on_key=True,
                )
            continue
        with reading.mistakes_at(PATH, "free", name):
            found[name] = _prior(space[name], prior)
    for one in space.constraints:
        if one.is_equality and any(name in one.names for name in found):
            reading.wrong(
                f"'{one.text}' is an equality, which ties a free input to the known ones; free "
                "inputs that stand in none",
                PATH,
                "free",
            )
    return found


def _prior(parameter: Parameter, part: PriorPart) -> Law:
    """The law of a free input in its unit; where it is bounded, within the parameter's range."""
    if parameter.categorical:
        raise StudyError(
            f"{parameter.name} has levels; only numbers can be learnt: make a study for each level "
            "and compare them"
        )
    own = parameter.law
    if part.distribution is None and part.range is None:
        if part.options:
            raise StudyError(
                f"{', '.join(part.options)}: say which distribution has this; write "
                "{distribution: normal, mean: .., std: ..}"
            )
        return own
    if isinstance(own, DiscreteLaw):
        raise StudyError(
            f"{parameter.name} has certain values only; its prior is the study's law: write "
            f"{parameter.name}: {{}}"
        )
    kind = part.distribution or "uniform"
    accepted = laws.option_names(kind)[0]
    mistakes = [
        f"{word} {value!r}: must be a number"
        for word, value in part.options.items()
        if word in accepted and (isinstance(value, bool) or not isinstance(value, int | float))
    ]
    if mistakes:
        raise StudyError(*mistakes)
    convert = units.conversion(parameter.unit if part.unit is None else part.unit, parameter.unit)
    words = {
        word: convert.place(value)
        if word in laws.LOCATION_WORDS
        else convert.distance(value)
        if word in laws.SCALE_WORDS
        else value
        for word, value in part.options.items()
    }
    low, high = own.support
    if part.range is not None:
        start, end = (convert.place(one) for one in part.range)
        if start < low - 1e-9 * abs(low) or end > high + 1e-9 * abs(high):
            raise StudyError(
                f"range [{start:g}, {end:g}] {parameter.unit} reaches beyond that of the parameter "
                f"[{low:g}, {high:g}], where no surrogate was fitted; widen the parameter's range"
            )
        low, high = max(start, low), min(end, high)
    return distribution(kind, range=(low, high), **words)


# measurements ---------------------------------------------------------------------------------


def _known(
    cases: Cases,
    space: Space,
    priors: Mapping[str, Law],
    offered: Mapping[str, Output],
    wanted: tuple[str, ...],
) -> dict[str, NDArray[Any]]:
    """Columns of the known inputs; raises `StudyError` for what the cases lack or have too much."""
    known = [name for name in space.names if name not in priors]
    mistakes = [
        f"cases '{cases.name}' have no column for parameter '{name}'; give it, or let it be free"
        for name in known
        if name not in cases.columns
    ]
    mistakes += [
        f"cases '{cases.name}' give '{name}', which is to be learnt; drop the column, or leave "
        f"{name} out of free"
        for name in priors
        if name in cases.columns
    ]
    mistakes += lacking(cases, wanted, "output")
    if not wanted and not outputs_in(cases, offered, wanted):
        scalar = [name for name, output in offered.items() if not output.dims]
        mistakes.append(
            f"cases '{cases.name}' have no column for any scalar output of the study: "
            f"{', '.join(scalar) or 'it has none'}"
        )
    if mistakes:
        raise StudyError(*mistakes)
    return cases.inputs({name: space[name] for name in known})


def _measured(
    reading: Reading,
    part: CalibrationPart,
    cases: Cases,
    outputs: Mapping[str, str],
    inside: NDArray[np.bool_],
) -> tuple[Measured, ...]:
    given = _errors(reading, part, outputs)
    found = []
    for name, unit in outputs.items():
        values = cases.numbers(name, unit, gaps=True)[inside]
        errors = np.full(len(values), given.get(name, np.nan))
        column = name + SUFFIX
        if column in cases.columns:
            own = _distances(cases, column, unit)[inside]
            errors = np.where(np.isfinite(own), own, errors)
        if np.isfinite(values).any():
            found.append(Measured(name, unit, values, errors))
    if not found:
        raise StudyError(f"cases '{cases.name}' have no measurement in any row")
    return tuple(found)


def _distances(cases: Cases, column: str, unit: str) -> NDArray[np.float64]:
    """A column of standard deviations in `unit`, NaN where a cell is empty."""
    stated = cases.units.get(column, unit)
    values = cases.numbers(column, stated, gaps=True)
    wrong = [
        f"{cases.places[k]}: {column}: {values[k]:g} must be above 0"
        for k in np.flatnonzero(values <= 0.0)
    ]
    if wrong:
        raise StudyError(*wrong)
    return values * units.conversion(stated, unit).distance(1.0)


def _errors(
    reading: Reading, part: CalibrationPart, outputs: Mapping[str, str]
) -> dict[str, float]:
    """Standard deviation of measurement of each output that `error:` gives one for."""
    by_name = part.error if isinstance(part.error, Mapping) else dict.fromkeys(outputs, part.error)
    found = {}
    for name, given in by_name.items():
        path = (PATH, "error", name) if isinstance(part.error, Mapping) else (PATH, "error")
        if name not in outputs:
            reading.wrong(
                f"the calibration has no output '{name}'; {nearest(name, outputs)}",
                *path,
                on_key=True,
            )
        elif given is not None and given != ESTIMATE:
            with reading.mistakes_at(*path):
                unit = outputs[name]
                cure = f"write 2, '2 {unit}' or {ESTIMATE}"
                found[name] = units.distance(str(given), unit, "error", cure)
    return found


def _coded(space: Space, known: Mapping[str, NDArray[Any]], cases: int) -> NDArray[np.float64]:
    """Coded points (case, parameter), 0 for free inputs."""
    return np.column_stack(
        [
            np.asarray(p.encode(known[p.name]), dtype=float) if p.name in known else np.zeros(cases)
            for p in space.parameters
        ]
    )
