"""From a study's source to the fields of `Study`, or all its mistakes at once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from surrogate.errors import StudyError
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Solver
from surrogate.stages.screening import ScreeningRule
from surrogate.study import file as studyfile
from surrogate.study.reading.adaptive import rules_of
from surrogate.study.reading.calibration import calibration_of
from surrogate.study.reading.constants import constants_of
from surrogate.study.reading.data import Data, columns_of, data_of, described, recorded_of
from surrogate.study.reading.designs import designs_of, replicated
from surrogate.study.reading.execution import check_execution
from surrogate.study.reading.learning import learning_of
from surrogate.study.reading.levels import check_nested, levels_of
from surrogate.study.reading.methods import check_screening, sensitivity_of, surrogates_of
from surrogate.study.reading.mistakes import Reading, sentences
from surrogate.study.reading.parameters import space_of
from surrogate.study.reading.reliability import limits_of
from surrogate.study.reading.rows import rows_of, with_dependence
from surrogate.study.reading.runs import stored_of
from surrogate.study.reading.solver import outputs_of, solver_of
from surrogate.study.reading.solving import problems_of
from surrogate.study.reading.validation import validation_of
from surrogate.study.source import Source
from surrogate.tables.recorded import Recorded


def fields_of(
    source: Source, folder: Path | None, study_at: Callable[[Path], Any]
) -> dict[str, Any]:
    """Read every part, note every mistake, raise them together or return the fields.

    folder    where modules and files that the study names are looked for
    study_at  reads another study, whose runs are the cases of validation
    """
    part, mistakes, broken = studyfile.read(source.data)
    if part is None:
        raise StudyError(*sentences(source, mistakes))
    notes = Reading(part, folder, broken, mistakes)
    spec, solver, data = _sources(notes)
    space = space_of(notes, solver, columns_of(data, solver)) if solver else None
    constants = constants_of(notes, solver) if solver else {}
    rows = rows_of(notes, data, space, spec, constants) if data and space else None
    designs = designs_of(notes, space)
    check_nested(notes, designs)
    if solver:
        designs = replicated(notes, designs, solver)
    designs |= rows.designs if rows else {}
    if rows and space and spec.recorded:
        space = with_dependence(notes, space, rows)
    fields: dict[str, Any] = {
        "name": part.study,
        "about": part.about.strip(),
        "spec": spec,
        "space": space,
        "constants": constants,
        "outputs": outputs_of(notes, solver, space) if solver else (),
        "designs": designs,
        "surrogates": surrogates_of(notes, designs, space),
        "sensitivity_method": sensitivity_of(notes, space),
        "execution": part.execution,
    }
    fields["rules"] = (
        rules_of(notes, designs, spec, solver, space, fields["outputs"], constants)
        if solver
        else {}
    )
    check_execution(notes)
    if solver:
        check_screening(notes, fields["outputs"])
    rule = part.screening
    fields["screening_rule"] = ScreeningRule(rule.freeze_below, rule.outputs) if rule else None
    fields["learning_rule"] = learning_of(
        notes, solver, fields["outputs"], fields["sensitivity_method"]
    )
    fields["stored_runs"] = (*stored_of(notes), *([rows.runs] if rows else []))
    fields["notes"] = (*notes.notes, *(rows.notes if rows else ()))
    fields["problems"] = (
        problems_of(notes, solver, space, fields["outputs"], constants) if solver else {}
    )
    fields["limits"] = limits_of(notes, solver, space, fields["outputs"]) if solver else {}
    fields["validation"] = (
        validation_of(notes, solver, space, fields["outputs"], fields["constants"], study_at)
        if solver
        else None
    )
    fields["calibration"] = (
        calibration_of(notes, solver, space, fields["outputs"], constants) if solver else None
    )
    if notes.mistakes:
        raise StudyError(*sentences(source, notes.mistakes))
    return fields


def _sources(notes: Reading) -> tuple[SolverSpec, Solver | None, Data | None]:
    """Where the answers come from: a solver, a table in its place, or both."""
    if notes.part.solver is not None or notes.part.data is None:
        spec, solver = levels_of(notes, *solver_of(notes))
        return spec, solver, data_of(notes, solver) if solver else None
    data = data_of(notes, None)
    if data is None:
        return SolverSpec(notes.part.data.file, Recorded), None, None
    spec = recorded_of(notes, data)
    notes.part = described(notes.part, data)
    return spec, spec.solver, data
