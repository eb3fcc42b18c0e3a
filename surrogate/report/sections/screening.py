"""Screening: which parameters to keep, which may be frozen, and what that costs."""

from __future__ import annotations

import numpy as np

from surrogate.report import digits
from surrogate.report.blocks import (
    Block,
    Cell,
    Figure,
    Figures,
    Fold,
    Head,
    Listing,
    Section,
    Table,
    Text,
    heads,
)
from surrogate.report.content import Content
from surrogate.report.figures.sobol import share_plot
from surrogate.sensitivity.frozen import VarianceKept
from surrogate.sensitivity.importance import TOTAL
from surrogate.sensitivity.screening import Screening, Verdict

#: Names written out in a sentence; the table has them all.
MOST = 8
REDUCED = "study_reduced.yaml"


def section(content: Content) -> Section:
    """The decision, its cost, the older rule beside it, the reduced study file."""
    decision = content.screening
    title = "Screening"
    if decision is None:
        return Section("screening", title, (Text("No screening was asked for.", "note"),))
    blocks: list[Block] = (
        [Text(digits.squared(decision.refused), "warning")] if decision.refused else []
    )
    blocks.append(Text(sentence(decision), "lead"))
    blocks += [Text(words, "note") for words in [_voters(content, decision)] if words]
    blocks.append(_verdicts(content, decision))
    if decision.freeze:
        blocks.append(_cost(decision))
    blocks += [Figures((_shares(decision),)), Text(_old_rule(decision))]
    if content.reduced_study:
        blocks += [
            Text(f"The study without the frozen parameters is {REDUCED} beside this page:"),
            Fold(REDUCED, (Listing(content.reduced_study),)),
        ]
    return Section("screening", title, tuple(blocks))


def sentence(decision: Screening) -> str:
    """The decision in one sentence."""
    if decision.refused:
        return "Nothing is frozen, because the indices cannot be trusted."
    rule = (
        f"the {digits.percent(decision.confidence)} interval of its {decision.index} lies below "
        f"{digits.number(decision.freeze_below)}"
    )
    if not decision.freeze:
        return f"Nothing is frozen. A parameter is frozen when {rule}."
    return (
        f"Keep {digits.listing(decision.keep, MOST) or 'nothing'}; freeze "
        f"{digits.listing(decision.freeze, MOST)}. A parameter is frozen when {rule}."
    )


def _voters(content: Content, decision: Screening) -> str:
    """Which outputs have decided, when not all have; or nothing."""
    silent = [name for name in content.outputs if name not in decision.outputs]
    if not silent:
        return ""
    return (
        f"Only {digits.listing(decision.outputs)} decides; a frozen parameter may matter for "
        f"{digits.listing(silent)}."
    )


def _verdicts(content: Content, decision: Screening) -> Table:
    titles = [
        "parameter",
        "decision",
        "total index" if decision.index == TOTAL else "largest index",
        "worst case",
        "one-at-a-time share",
        f"{digits.percent(decision.threshold)} rule",
        "why",
    ]
    rows = tuple(_row(content, verdict) for verdict in decision.verdicts)
    several = (
        f" Numbers are the largest over {digits.listing(decision.outputs)}."
        if len(decision.outputs) > 1
        else ""
    )
    return Table(
        f"The decision on each parameter.{several} {digits.capital(decision.index)}: its value, "
        "and the upper end of its interval, which decides. Worst case: largest possible "
        f"{'total ' if decision.index == TOTAL else ''}index of the solver itself, if all "
        "variance that the surrogate misses were due to this parameter. One-at-a-time shares "
        "are shown for comparison only.",
        tuple(Head(title, numeric=k in (2, 3, 4)) for k, title in enumerate(titles)),
        rows,
    )


def _row(content: Content, verdict: Verdict) -> tuple[Cell, ...]:
    total = f"{digits.fixed(verdict.total, 3)}, at most {digits.fixed(verdict.high, 3)}"
    return (
        Cell(verdict.parameter),
        Cell(_decision(content, verdict), tone="" if verdict.frozen else "strong"),
        Cell(total, verdict.total),
        Cell(digits.figure(verdict.worst_case, 2)),
        Cell(digits.percent(verdict.one_at_a_time)),
        Cell("keeps" if verdict.kept_by_old_rule else "drops"),
        Cell(_reason(verdict)),
    )


def _reason(verdict: Verdict) -> str:
    """The verdict's sentence without the parameter's name, which stands at the row's head."""
    words = verdict.sentence.removeprefix(f"{verdict.parameter}: ")
    return digits.capital(words)


def _decision(content: Content, verdict: Verdict) -> str:
    if not verdict.frozen:
        return "keep"
    if isinstance(verdict.value, str):
        return f"freeze at\u00a0{verdict.value}"
    unit = content.unit(verdict.parameter)
    return f"freeze at\u00a0{digits.with_unit(digits.number(verdict.value, 4), unit)}"


def _cost(decision: Screening) -> Table:
    rows = tuple(
        (Cell(kept.output), Cell(share_kept(kept)), Cell(digits.percent(kept.frozen_error)))
        for kept in decision.variance_kept
    )
    return Table(
        "Cost of freezing: share of the variance that the kept parameters explain, and mean "
        "square error of the reduced model as a share of the variance.",
        heads("output", "variance kept (interval)", "error of the reduced model"),
        rows,
    )


def may_be_frozen(decision: Screening, most: int = MOST) -> str:
    """What may be frozen, in a clause that names so many inputs."""
    if decision.refused:
        return "nothing is frozen, because the indices cannot be trusted"
    if not decision.freeze:
        return "no input may be frozen"
    return f"{digits.listing(decision.freeze, most)} may be frozen"


def share_kept(kept: VarianceKept) -> str:
    """`98.1 % (97.5 to 98.6)`."""
    whole = digits.with_interval(
        *(100.0 * end for end in (kept.share, kept.low, kept.high)), most=2
    )
    value, _, ends = whole.partition(" (")
    return f"{value}{digits.THIN}%" + (f" ({ends}" if ends else "")


def _shares(decision: Screening) -> Figure:
    total = {
        part: np.array([getattr(verdict, name) for verdict in decision.verdicts])
        for part, name in (("value", "total"), ("high", "high"))
    }
    total["low"] = total["value"]
    plot = share_plot(
        [verdict.parameter for verdict in decision.verdicts],
        [verdict.one_at_a_time for verdict in decision.verdicts],
        total,
        decision.freeze_below,
    )
    return Figure(
        plot,
        f"Square: share of the one-at-a-time effects. Disc: {decision.index}, with the upper "
        "half of its interval. Dashed: limit for freezing. The two do not compare in size: an "
        "index is "
        "a share of the variance, in which effects count squared.",
    )


def _old_rule(decision: Screening) -> str:
    old, new = set(decision.kept_by_old_rule), set(decision.keep)
    rule = (
        f"The one-at-a-time rule keeps the largest shares until their sum exceeds "
        f"{digits.percent(decision.threshold)}: "
        f"{digits.listing(decision.kept_by_old_rule, MOST) or 'nothing'}."
    )
    if decision.refused:
        return f"{rule} It is not used here."
    apart = [name for name in (*decision.keep, *decision.freeze) if (name in old) != (name in new)]
    if not apart:
        return f"{rule} It agrees."
    return (
        f"{rule} It differs on {digits.listing(apart, MOST)}. One-at-a-time effects contain no "
        "interactions and have no interval."
    )
