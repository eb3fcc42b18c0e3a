"""How probable failures are, how sure that is, and where they begin."""

from __future__ import annotations

from surrogate.reliability.solution import DesignPoint, Reliability
from surrogate.report import digits
from surrogate.report.blocks import (
    Block,
    Cell,
    Figure,
    Figures,
    Heading,
    Section,
    Table,
    Text,
    anchor,
    cells,
    heads,
)
from surrogate.report.content import Content
from surrogate.report.figures.exceedance import exceedance_plot


def section(content: Content) -> Section:
    """A heading, a sentence, a curve and two tables a failure."""
    blocks: list[Block] = []
    for name, found in content.reliability.items():
        blocks.append(Heading(name, anchor("failure", name)))
        blocks += _failure(content, found)
    return Section("reliability", "How probable failures are", tuple(blocks))


def _failure(content: Content, found: Reliability) -> list[Block]:
    label = digits.labelled(found.problem.output, found.problem.unit)
    unit = found.problem.unit
    said = str(found).replace(unit, digits.unit(unit)) if unit else str(found)
    caption = (
        "Probability that the output passes a value, by the surrogate. Line: the limit. "
        "Disc: the answer with its 95 % interval."
    )
    blocks: list[Block] = [
        Text(f"{digits.capital(said)}.", "lead"),
        Figures((Figure(exceedance_plot(found, label), caption),)),
        _parts(found),
    ]
    if found.design_point is not None:
        blocks.append(_point(content, found.design_point))
    return blocks


def _parts(found: Reliability) -> Table:
    rows = [
        (
            "sampling",
            f"{found.estimate.method}, {digits.quantity(found.estimate.evaluations, 'evaluation')}",
        )
        + _ends(*found.sampling),
        ("surrogate", found.how) + _ends(*found.error),
        ("both", "") + _ends(found.low, found.high),
    ]
    return Table(
        "Parts of the 95 % interval.",
        heads("part", "how", "from", "to", names=2),
        tuple(tuple(cells(row)) for row in rows),
    )


def _ends(low: float, high: float) -> tuple[str, str]:
    return digits.figure(low), digits.figure(high)


def _point(content: Content, point: DesignPoint) -> Table:
    """The design point, the parameter that matters most for it first."""
    names = sorted(point.factors, key=lambda name: -point.factors[name])
    return Table(
        f"The most probable failure (first-order method): {digits.figure(point.beta)} standard "
        f"deviations from the median, which would mean a probability of "
        f"{digits.figure(point.first_order)}. Importance: share of the squared distance.",
        heads("parameter", "value", "importance"),
        tuple(
            (
                Cell(digits.labelled(name, content.unit(name))),
                Cell(digits.number(point.inputs[name], 4), point.inputs[name]),
                Cell(digits.percent(point.factors[name]), point.factors[name]),
            )
            for name in names
        ),
    )
