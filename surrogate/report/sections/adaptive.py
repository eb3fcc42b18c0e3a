"""Adaptive designs: what they aimed at, how they went on, why they ended, whether it paid."""

from __future__ import annotations

import math
from collections.abc import Mapping

from surrogate.adaptive.aim import NAMES, OPTIMUM, PROBABILITY
from surrogate.adaptive.outcome import Grown, Outcome
from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Figure, Figures, Head, Section, Table, Text
from surrogate.report.figures.reviews import reviews_plot

ESTIMATES = {OPTIMUM: "best value predicted at a run", PROBABILITY: "probability"}


def section(grown: Mapping[str, Grown]) -> Section:
    """For each design: how it stands, whether it paid, and its reviews."""
    blocks: list[Block] = []
    for name, one in grown.items():
        blocks.append(Text(f"Design {name}: {digits.squared(str(one.outcome))}.", "lead"))
        blocks += [Text(f"{digits.capital(sentence)}.", "note") for sentence in one.paid]
        if one.outcome.reviews:
            blocks += _reviews(name, one.outcome)
    return Section("adaptive", "Points chosen from the answers", tuple(blocks))


def _reviews(name: str, one: Outcome) -> list[Block]:
    """The figure against the number of runs, and the same as a table."""
    figure = digits.labelled(digits.squared(NAMES[one.figure]), one.figure_unit)
    known = [review for review in one.reviews if math.isfinite(review.figure)]
    blocks: list[Block] = []
    if len(known) > 1:
        plot = reviews_plot(
            [review.runs for review in known],
            [review.figure for review in known],
            one.goal,
            figure,
            name,
        )
        level = " Level line: the goal." if math.isfinite(one.goal) else ""
        caption = (
            f"{digits.capital(figure)} against the number of runs that had ended, judged "
            f"by a Gaussian process; the first {one.initial} runs were there before.{level}"
        )
        blocks.append(Figures((Figure(plot, caption),)))
    estimate = ESTIMATES.get(one.kind)
    rows = tuple(
        (
            Cell(str(review.runs)),
            Cell(digits.figure(review.figure)),
            *((Cell(digits.figure(review.estimate)),) if estimate else ()),
        )
        for review in one.reviews
    )
    unit = one.unit if one.kind == OPTIMUM else ""
    more = (Head(digits.labelled(estimate, unit)),) if estimate else ()
    titles = (Head("runs"), Head(figure), *more)
    return [*blocks, Table(f"Reviews of design {name}.", titles, rows)]
