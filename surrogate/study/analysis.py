"""A study and its runs on their walk through the stages."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr

from surrogate.errors import StudyError
from surrogate.stages.digest import digest, of_object, of_runs
from surrogate.stages.stage import Given, Part, Result, Step
from surrogate.stages.walk import Walk
from surrogate.study.study import Study
from surrogate.validation.validation import fixed_inputs


def walk(
    study: Study,
    folder: Path,
    runs: xr.Dataset | None = None,
    *,
    workers: int | None = None,
    progress: Callable[[Step], None] = lambda step: None,
) -> Walk:
    """The walk of a study through its stages; nothing is done yet.

    runs: default, what the journal and stored files hold.
    """
    runs = study.stored(folder) if runs is None else runs
    return Walk(
        parts_of(study),
        {"runs": _runs(study, folder, runs), "cases": _cases(study, folder)},
        folder,
        workers or study.workers,
        progress,
    )


def _runs(study: Study, folder: Path, runs: xr.Dataset) -> Given:
    """The runs, and which designs have none because their points are not found yet."""
    lost = tuple(study.to_find(folder))
    return Given(Result(runs, lost), digest(of_runs(runs), lost) if lost else of_runs(runs))


def _cases(study: Study, folder: Path) -> Given:
    """The cases of validation, or why there are none."""
    try:
        cases = study.cases(results=folder)
    except StudyError as error:
        lost = tuple(f"validation: {sentence}" for sentence in error.mistakes)
        return Given(Result(None, lost), digest(lost))
    if cases is None:
        return Given(Result(None), "")
    columns = [(name, column.tolist()) for name, column in cases.columns.items()]
    return Given(Result(cases), digest(cases.name, columns, cases.labels, cases.units))


def _measured(study: Study) -> Part:
    """The problem of calibration, and the measurements that it follows from."""
    problem = study.calibration
    if problem is None:
        return Part(None, [])
    numbers = [(one.output, one.values, one.errors) for one in problem.measured]
    words = study.words.get("calibration")
    return Part(
        problem,
        [words, problem.coded, problem.labels, numbers, repr(problem.priors), problem.notes],
    )


def parts_of(study: Study) -> dict[str, Part]:
    """The parts of a study that stages read, each with the words that it follows from."""
    words, solver = study.words, study.spec.solver
    method, rule = study.sensitivity_method, study.validation
    described = [study.spec.context, repr(dict(solver.inputs)), repr(study.offered)]

    def part(value: Any, *sections: str, more: Any = ()) -> Part:
        return Part(value, [[words.get(section) for section in sections], more])

    fixed = fixed_inputs(solver, study.space, study.constants)
    models = {name: spec.context for name, spec in rule.models.items()} if rule else {}
    return {
        "name": part(study.name, "study"),
        "about": part(study.about, "about"),
        "text": part(study.text, more=study.text),
        "words": part(words, more=study.text),
        "space": part(study.space, "parameters", "correlation", more=described),
        "outputs": part(study.outputs, more=study.outputs),
        "offered": part(study.offered, more=described),
        "surrogates": part(study.surrogates, "surrogates"),
        "deterministic": part(study.spec.deterministic, more=study.spec.deterministic),
        "recorded": part(study.spec.recorded, more=study.spec.recorded),
        "sensitivity_method": part(
            method, "sensitivity", more=of_object(method.function) if method else ""
        ),
        "screening_rule": part(study.screening_rule, "screening"),
        "learning_rule": part(study.learning_rule, "learning", more=repr(study.learning_rule)),
        "rules": part(study.rules, more=repr(study.rules)),
        "nominal": part(study.nominal, more=study.nominal),
        "problems": part(study.problems, more=repr(study.problems)),
        "limits": part(study.limits, more=repr(study.limits)),
        "measured": _measured(study),
        "validation_rule": part(rule, "validation", more=models),
        "fixed": part(fixed, more=repr(fixed)),
        "scene_of": part(getattr(solver, "scene", None), more=study.spec.context),
    }
