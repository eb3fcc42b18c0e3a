"""Inputs that reach a goal, as the command prints them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from surrogate.cli.page import Page
from surrogate.cli.progress import RunsBar, StagesBar
from surrogate.cli.table import Table
from surrogate.solving.solution import Candidate, Solution, chance
from surrogate.stages.solve import figures_of
from surrogate.study import solving
from surrogate.study.study import Study

#: Candidates that stand side by side at most.
ACROSS = 6


def solve(
    study: Study,
    results: Path,
    name: str | None,
    goals: solving.Goals,
    *,
    verify: bool,
    runs: int | None,
    workers: int | None,
    quiet: bool,
) -> Page:
    """The candidates for the study's goal of that name, or for what the command states.

    verify: run the solver at them.
    """
    problem = solving.stated(study, name, goals)
    with StagesBar(study.name, hidden=quiet) as steps:
        answer = solving.solve(study, results, problem, steps=steps)
    if verify:
        with RunsBar(study.name, hidden=quiet) as bar:
            answer = solving.check(study, results, answer, runs=runs, workers=workers, progress=bar)
    found = answer.solution
    units = {name: one.unit for name, one in study.offered.items()}
    units |= {p.name: p.unit for p in study.space.parameters}
    return Page(figures_of(found), [*filter(None, [answer.note]), *lines(found, units)])


def lines(solution: Solution, units: Mapping[str, str]) -> list[str | Table]:
    """The goal, a table of the candidates, how the promises held, and the sentence."""
    problem = solution.problem
    parts: list[str | Table] = [f"{problem.name}: {solution.goal}"]
    if problem.held:
        held = ", ".join(f"{n} = {_number(v)} {units[n]}".rstrip() for n, v in problem.held.items())
        parts.append(f"held: {held}")
    if problem.uncertain:
        parts.append(f"uncertain, by their distributions: {', '.join(problem.uncertain)}")
    parts += [_table(solution, units), ""]
    if len(solution.candidates) > ACROSS:
        parts.append("inputs of each: --json, the report, or solve.nc")
    return [*parts, str(solution), *filter(None, [solution.tested])]


def _table(solution: Solution, units: Mapping[str, str]) -> Table:
    """A column a candidate; of a long front a row each, outputs only."""
    rows = solution.candidates
    checked = any(one.verified is not None for one in rows)
    outputs = {name: f"{name} ({units[name] or '-'})" for name in rows[0].predicted}
    if len(rows) > ACROSS:
        heads = ["", *outputs.values(), "probability", *["solver"] * checked]
        lines = [
            (
                str(k + 1),
                *(f"{at.value:.4g} [{at.low:.4g}, {at.high:.4g}]" for at in one.predicted.values()),
                chance(one.probability),
                *[_checked(one)] * checked,
            )
            for k, one in enumerate(rows)
        ]
        return Table("", heads, lines)
    found = [
        (f"{n} ({units[n] or '-'})", *(_number(one.inputs[n]) for one in rows))
        for n in rows[0].inputs
    ]
    for name, title in outputs.items():
        at = [one.predicted[name] for one in rows]
        found.append((f"{title}: expected", *(f"{one.value:.4g}" for one in at)))
        found.append(("  95 % of it from", *(f"{one.low:.4g}" for one in at)))
        found.append(("  to", *(f"{one.high:.4g}" for one in at)))
    if rows[0].desirability is not None:
        found.append(("desirability", *(f"{one.desirability or 0.0:.3f}" for one in rows)))
    found.append(("probability", *(chance(one.probability) for one in rows)))
    if checked:
        found.append(("the solver says", *(_checked(one) for one in rows)))
    return Table("", ["candidate", *(str(k + 1) for k in range(len(rows)))], found)


def _number(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.5g}"


def _checked(one: Candidate) -> str:
    """What the solver says at a candidate."""
    found = one.verified
    if found is None:
        return "-"
    if not found.runs:
        return "failed"
    if found.runs == 1:
        values = ", ".join(f"{values[0]:.4g}" for values in found.values.values())
        return f"{values} {'met' if found.met else 'NOT met'}"
    _, low, high = found.share
    return f"{found.met} of {found.runs} met, {100 * low:.0f} to {100 * high:.0f} %"
