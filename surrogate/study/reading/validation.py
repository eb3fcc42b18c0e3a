"""From the words of a study to the cases and models of its validation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from surrogate.errors import StudyError, nearest
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output, Solver
from surrogate.space.space import Space
from surrogate.study.parts.methods import ValidationPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import is_scalar
from surrogate.study.reading.solver import solver_of
from surrogate.tables.sheet import READERS
from surrogate.validation.cases import Cases, header, lacking, read_runs, read_table
from surrogate.validation.validation import Validation, constants_for, fixed_inputs, outputs_in

ReadStudy = Callable[[Path], Any]


def cases_at(path: Path, name: str, study_at: ReadStudy) -> Cases | Any:
    """The cases in a table or runs dataset; for a study file, the study."""
    if path.suffix in (".yaml", ".yml"):
        return study_at(path)
    if path.suffix == ".nc":
        return read_runs(path, name)
    if path.suffix.lower() in READERS:
        return read_table(path, name)
    raise StudyError(
        f"cases '{name}': must be a table ({', '.join(READERS)}), a dataset of runs (.nc) or a "
        "study (.yaml)"
    )


def validation_of(
    reading: Reading,
    solver: Solver,
    space: Space | None,
    kept: Iterable[str],
    constants: Mapping[str, Any],
    study_at: ReadStudy,
) -> Validation | None:
    """Cases and models; whatever would keep them from being compared is a mistake.

    kept: the study's outputs. study_at: reads another study, whose runs are the cases.
    """
    part = reading.part.validation
    if part is None:
        return None
    models = _models(reading, part)
    offered = {name: solver.outputs[name] for name in kept if name in solver.outputs}
    outputs = _outputs(reading, part, offered)
    cases = reference = None
    with reading.mistakes_at("validation", "cases"):
        found = cases_at((reading.folder or Path()) / part.cases, part.cases, study_at)
        if isinstance(found, Cases):
            cases = found.in_units({**solver.inputs, **solver.outputs})
        else:
            reference = found
            if reference.name == reading.part.study:
                raise StudyError(
                    f"study '{reference.name}' has the name of this one, so both "
                    "would write to one folder; rename one"
                )
        columns = header_of(reference, part.cases) if cases is None else cases
        if space is not None:
            check_cases(columns, space, offered, outputs)
            chosen = outputs_in(columns, offered, outputs)
            _check_models(reading, models, columns, chosen, fixed_inputs(solver, space, constants))
        if part.subject is not None and part.subject not in columns.columns:
            reading.wrong(
                f"the cases have no column '{part.subject}'; "
                f"{nearest(part.subject, columns.columns)}",
                "validation",
                "subject",
            )
    return Validation(cases, reference, outputs, part.subject, models)


def header_of(reference: Any, name: str) -> Cases:
    """Which columns the runs of another study will have."""
    solver = reference.spec.solver
    return header(
        {
            **solver.inputs,
            **{o: solver.outputs[o] for o in reference.outputs if not solver.outputs[o].dims},
        },
        name,
    )


def check_cases(
    cases: Cases, space: Space, offered: Mapping[str, Output], wanted: Iterable[str]
) -> None:
    """Raise `StudyError` with all that keeps these cases from being compared.

    offered: the study's outputs. wanted: those to compare, none for all that the cases have.
    """
    wanted = tuple(wanted)
    mistakes = lacking(cases, space.names, "parameter") + lacking(cases, wanted, "output")
    chosen = [name for name in outputs_in(cases, offered, wanted) if name in cases.columns]
    if not chosen and not wanted:
        scalar = [name for name, output in offered.items() if not output.dims]
        mistakes.append(
            f"cases '{cases.name}' have no column for any scalar output of the study: "
            f"{', '.join(scalar) or 'it has none'}"
        )
    columns = [
        (p.name, p.unit, False)
        for p in space.parameters
        if p.name in cases.columns and not p.categorical
    ]
    for name, unit, gaps in [*columns, *((name, offered[name].unit, True) for name in chosen)]:
        try:
            cases.numbers(name, unit, gaps)
        except StudyError as error:
            mistakes += error.mistakes
    if mistakes:
        raise StudyError(*mistakes)


def _outputs(
    reading: Reading, wanted: ValidationPart, offered: Mapping[str, Output]
) -> tuple[str, ...]:
    needed = "validation compares single numbers"
    return tuple(
        name
        for index, name in enumerate(wanted.output)
        if is_scalar(reading, name, offered, needed, "validation", "output", index)
    )


def _models(reading: Reading, wanted: ValidationPart) -> dict[str, SolverSpec]:
    models = {}
    for name, part in wanted.models.items():
        path = ("validation", "models", name)
        if name in reading.part.surrogates:
            reading.wrong(
                f"'{name}' is also a surrogate; give the model another name", *path, on_key=True
            )
        before = len(reading.mistakes)
        spec, built = solver_of(reading, part, path)
        if built is not None and len(reading.mistakes) == before:
            models[name] = spec
    return models


def _check_models(
    reading: Reading,
    models: Mapping[str, SolverSpec],
    cases: Cases,
    outputs: tuple[str, ...],
    fixed: Mapping[str, Any],
) -> None:
    for name, spec in models.items():
        path, solver = ("validation", "models", name), spec.solver
        if not set(outputs) & set(solver.outputs):
            reading.wrong(
                f"{spec.name} has no output {' or '.join(outputs)}; it has "
                f"{', '.join(solver.outputs)}",
                *path,
            )
        with reading.mistakes_at(*path):
            cases.inputs(solver.inputs)
            given = {*cases.columns, *constants_for(spec, fixed, cases.columns)}
            missing = [
                f"{spec.name} needs '{one}', which the cases do not have"
                for one, taken in solver.inputs.items()
                if taken.nominal is None and one not in given
            ]
            if missing:
                raise StudyError(*missing)
