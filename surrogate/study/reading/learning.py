"""From the words of `learning:` to goals by output."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from surrogate.errors import StudyError
from surrogate.fitting.best import BEST
from surrogate.fitting.forecast import Q2, RMSE, WIDTH, Goal
from surrogate.solver import Output, Solver
from surrogate.space import units
from surrogate.stages.learning import ALL, LearningRule
from surrogate.stages.sensitivity import SensitivityMethod
from surrogate.study.parts.learning import LearningPart, UntilPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import check_surrogate, is_scalar


def learning_of(
    reading: Reading,
    solver: Solver | None,
    outputs: Iterable[str],
    method: SensitivityMethod | None,
) -> LearningRule | None:
    """The rule; mistakes are noted. outputs: those that the study keeps."""
    part = reading.part.learning
    if part is None or solver is None:
        return None
    offered = {name: solver.outputs[name] for name in outputs if name in solver.outputs}
    needed = "a learning curve is that of a surrogate"
    check_surrogate(reading, part.surrogate, needed, "learning", words=(BEST, ALL), on_key=True)
    scalars = _scalars(reading, part, offered)
    goals = _goals(reading, part.until, scalars, method) if part.until else {}
    return LearningRule(goals, part.surrogate, part.subsets)


def _scalars(
    reading: Reading, part: LearningPart, offered: Mapping[str, Output]
) -> dict[str, Output]:
    """The outputs that the goal is for."""
    for index, name in enumerate(part.outputs):
        needed = "a learning curve needs a single number"
        is_scalar(reading, name, offered, needed, "learning", "outputs", index)
    return {
        name: one
        for name, one in offered.items()
        if not one.dims and (not part.outputs or name in part.outputs)
    }


def _goals(
    reading: Reading,
    until: UntilPart,
    scalars: Mapping[str, Output],
    method: SensitivityMethod | None,
) -> dict[str, Goal]:
    if until.q2 is not None:
        return dict.fromkeys(scalars, Goal(Q2, until.q2))
    if until.index_width is not None:
        if (method is None or method.name != "sobol") and not reading.is_broken("sensitivity"):
            reading.wrong(
                "index_width is that of total indices; add sensitivity: sobol, or give q2 or rmse",
                "learning",
                "until",
                "index_width",
            )
        return dict.fromkeys(scalars, Goal(WIDTH, until.index_width))
    with reading.mistakes_at("learning", "until", "rmse"):
        return _errors(str(until.rmse).strip(), scalars)
    return {}


def _errors(text: str, scalars: Mapping[str, Output]) -> dict[str, Goal]:
    """The RMSE as a goal of each output whose unit it converts to."""
    found = units.NUMBER_AND_UNIT.fullmatch(text)
    if found is None:
        raise StudyError(f"rmse '{text}' is not a number; write 0.4 or '0.4 mmHg'")
    goals, lost = {}, ""
    for name, output in scalars.items():
        try:
            scale = units.conversion(found[2] or output.unit, output.unit)
        except StudyError as error:
            lost = str(error)
            continue
        goals[name] = Goal(RMSE, scale.distance(float(found[1])))
    if lost and not goals:
        raise StudyError(f"rmse {text} suits no output: {lost}")
    if any(not goal.value > 0.0 for goal in goals.values()):
        raise StudyError(f"rmse {text} must be above 0")
    return goals
