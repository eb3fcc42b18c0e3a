"""The goals: which inputs reach them, how surely, and whether the solver agreed."""

from __future__ import annotations

from surrogate.report import digits
from surrogate.report.blocks import (
    Block,
    Cell,
    Figure,
    Figures,
    Head,
    Heading,
    Section,
    Table,
    Text,
    anchor,
)
from surrogate.report.content import Content
from surrogate.report.figures.promises import front_plot, promises_plot
from surrogate.solving.problem import Problem
from surrogate.solving.promise import Verified
from surrogate.solving.solution import Candidate, Solution, chance


def section(content: Content) -> Section:
    """A heading, a sentence and a table a goal."""
    blocks: list[Block] = []
    for name, solution in content.solve.items():
        blocks.append(Heading(name, anchor("goal", name)))
        blocks += _goal(content, solution)
    return Section("solve", "Inputs that reach the goals", tuple(blocks))


def _goal(content: Content, solution: Solution) -> list[Block]:
    front = len(solution.problem.objectives) > 1
    tone = "lead" if solution.sure or front else "warning"
    found: list[Block] = [Text(goal(solution), "plain"), Text(str(solution), tone)]
    found += [Text(words, "note") for words in _setting(content, solution.problem)]
    if solution.tested:
        found.append(Text(solution.tested))
    return [*found, _figures(content, solution), _table(content, solution)]


def _figures(content: Content, solution: Solution) -> Figures:
    """The front of several objectives; else the candidates, a figure an output."""
    objectives = solution.problem.objectives
    if len(objectives) > 1:
        labels = [digits.labelled(one.output, content.unit(one.output)) for one in objectives[:2]]
        caption = "No candidate is better than another in all objectives."
        return Figures((Figure(front_plot(solution, (labels[0], labels[1])), caption),))
    checked = any(one.verified for one in solution.candidates)
    caption = (
        "Discs: expected, with the 95 % interval of the surrogate's error"
        + " and the uncertain inputs" * bool(solution.problem.uncertain)
        + "."
        + " Band: the goal." * bool(solution.ends)
        + " Crosses: what the solver said." * checked
    )
    outputs = solution.candidates[0].predicted
    return Figures(
        tuple(
            Figure(
                promises_plot(solution, name, digits.labelled(name, content.unit(name))), caption
            )
            for name in outputs
        )
    )


def goal(solution: Solution) -> str:
    """What was wanted, as a sentence."""
    return f"Goal: {solution.goal}."


def _setting(content: Content, problem: Problem) -> list[str]:
    found = []
    if problem.held:
        held = [
            f"{name} {digits.setting(value, content.unit(name))}"
            for name, value in problem.held.items()
        ]
        found.append(f"Held: {digits.listing(held)}.")
    if problem.uncertain:
        names = digits.listing(problem.uncertain)
        found.append(
            f"The probability is taken over the distribution of {names}, which nobody controls, "
            "and over the error of the surrogate."
        )
    return found


def _table(content: Content, solution: Solution) -> Table:
    rows = solution.candidates
    inputs, outputs = list(rows[0].inputs), list(rows[0].predicted)
    checked = any(one.verified is not None for one in rows)
    heads = [Head("candidate", numeric=False)]
    heads += [Head(digits.labelled(name, content.unit(name))) for name in inputs]
    heads += [
        Head(f"{digits.labelled(name, content.unit(name))}, expected (95 % interval)")
        for name in outputs
    ]
    heads += [Head("desirability")] * (rows[0].desirability is not None)
    heads += [Head("probability")] + [Head("the solver says")] * checked
    return Table(
        "Candidates, the best first. Probability: that the solver meets goal and limits there, "
        "given the error of the surrogate"
        + (" and the uncertain inputs." if solution.problem.uncertain else "."),
        tuple(heads),
        tuple(_row(k, one, checked) for k, one in enumerate(rows)),
        wide=True,
    )


def _row(k: int, one: Candidate, checked: bool) -> tuple[Cell, ...]:
    cells = [Cell(str(k + 1))]
    cells += [Cell(digits.setting(value)) for value in one.inputs.values()]
    cells += [
        Cell(digits.with_interval(at.value, at.low, at.high), at.value)
        for at in one.predicted.values()
    ]
    if one.desirability is not None:
        cells.append(Cell(digits.fixed(one.desirability, 3)))
    cells.append(Cell(chance(one.probability), one.probability, "strong"))
    return (*cells, *[Cell(_checked(one.verified))] * checked)


def _checked(found: Verified | None) -> str:
    if found is None:
        return digits.NOTHING
    if not found.runs:
        return "failed"
    if found.runs == 1:
        values = digits.listing([digits.number(values[0], 4) for values in found.values.values()])
        return f"{values}: {'met' if found.met else 'not met'}"
    _, low, high = found.share
    return f"{found.met} of {found.runs} met ({digits.percent(low)} to {digits.percent(high)})"
