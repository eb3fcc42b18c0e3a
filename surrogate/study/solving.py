"""Goals that people state at the command, and their answers from the runs there are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from surrogate.errors import StudyError, nearest
from surrogate.execution.progress import Progress
from surrogate.solving.problem import Problem
from surrogate.solving.solution import Solution
from surrogate.stages import candidates as searching
from surrogate.stages.solve import verified
from surrogate.stages.stage import Step
from surrogate.study import file as studyfile
from surrogate.study.analysis import walk
from surrogate.study.parts.solve import SolvePart
from surrogate.study.prediction import told, usable
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.solving import problem_of
from surrogate.study.study import Study
from surrogate.study.verified_points import points
from surrogate.study.verifying import verify

#: Name of a goal that the command states.
ASKED = "asked"


@dataclass(frozen=True)
class Goals:
    """A goal in the words of the command.

    target   `output=value` words
    fix      `name=value` words
    The others are those of `solve:` in a study file.
    """

    target: Sequence[str] = ()
    minimise: Sequence[str] = ()
    maximise: Sequence[str] = ()
    subject_to: Sequence[str] = ()
    fix: Sequence[str] = ()
    free: Sequence[str] = ()
    uncertain: Sequence[str] = ()
    probability: float | None = None
    candidates: int | None = None
    surrogate: str | None = None

    @property
    def says_nothing(self) -> bool:
        """True when no word was given."""
        return self == Goals()


def stated(study: Study, name: str | None, goals: Goals) -> Problem:
    """The study's problem of that name, or what the command states; words change the named one.

    Raises `StudyError` with all mistakes.
    """
    if name is None and goals.says_nothing and len(study.problems) == 1:
        name = next(iter(study.problems))
    if name is not None and name not in study.problems:
        raise StudyError(f"the study has no goal '{name}'; {nearest(name, study.problems)}")
    if name is not None and goals.says_nothing:
        return study.problems[name]
    if name is None and goals.says_nothing:
        known = f"name one of {', '.join(study.problems)}, or " if study.problems else ""
        raise StudyError(f"say what is wanted: {known}give --target OUTPUT=VALUE or --minimise")
    words = _words(goals)
    if name is not None:
        words = {**study.words["solve"][name], **words}
    return _read(study, name or ASKED, words)


def _words(goals: Goals) -> dict[str, Any]:
    """The goal as the data of a part of `solve:`."""
    found: dict[str, Any] = {}
    for key in ("minimise", "maximise", "subject_to", "free", "uncertain"):
        if getattr(goals, key):
            found[key] = list(getattr(goals, key))
    for key in ("probability", "candidates", "surrogate"):
        if getattr(goals, key) is not None:
            found[key] = getattr(goals, key)
    for key in ("target", "fix"):
        if getattr(goals, key):
            found[key] = dict(_pairs(getattr(goals, key), key))
    return found


def _pairs(words: Iterable[str], key: str) -> Iterable[tuple[str, str]]:
    for word in words:
        name, equals, value = word.partition("=")
        if not equals or not value.strip():
            raise StudyError(f"--{key} '{word}' is not NAME=VALUE")
        yield name.strip(), value.strip()


def _read(study: Study, name: str, words: dict[str, Any]) -> Problem:
    """The problem that a part of `solve:` states, read as if it stood in the study."""
    part, _, broken = studyfile.read(study.source.data)
    assert part is not None  # the study was read
    reading = Reading(part, None, broken)
    try:
        asked = SolvePart.model_validate(words)
    except ValidationError as error:
        raise StudyError(
            *(str(one.get("ctx", {}).get("error", one["msg"])) for one in error.errors())
        ) from None
    problem = problem_of(
        reading,
        name,
        asked,
        study.spec.solver,
        study.space,
        study.outputs,
        study.constants,
    )
    if reading.mistakes:
        raise StudyError(*(mistake.sentence for mistake in reading.mistakes))
    return problem


@dataclass(frozen=True)
class Answer:
    """A solution, and what a reader should know before relying on it."""

    solution: Solution
    note: str = ""


def solve(
    study: Study,
    results: Path,
    problem: Problem,
    *,
    steps: Callable[[Step], None] = lambda step: None,
) -> Answer:
    """Candidates from the runs there are. Runs no solver.

    steps: told of each step of the analysis. Raises `StudyError` when the goal cannot be searched
    for and `ResultsError` when no runs are stored.
    """
    stored, unfound = usable(study, results, None)
    stages = walk(study, results, stored, progress=steps)
    if study.problems.get(problem.name) == problem:
        found = stages.value("candidates").get(problem.name)
        if found is None:
            raise StudyError(*stages.result("candidates").not_done)
    else:
        fits = searching.fits_for(problem, stages.value("fits"), stages.value("comparison"))
        steps(Step("candidates", f"solve {problem.name}"))
        found = searching.candidates(problem, study.space, study.spec.recorded, fits)
    return Answer(verified(found, stored), "\n".join(told(stored, unfound)))


def check(
    study: Study,
    results: Path,
    answer: Answer,
    *,
    runs: int | None = None,
    workers: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Answer:
    """The answer with what the solver says at its candidates, where it is run now.

    runs: at the best candidate when inputs are uncertain.
    """
    solution = answer.solution
    columns = points(solution, study.space, runs)
    name = solution.problem.name
    again = verify(study, results, name, columns, workers=workers, progress=progress)
    return replace(answer, solution=verified(solution, again.stored(results)))
