"""Parameters and outputs, with units and ranges."""

from __future__ import annotations

import numpy as np

from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Figure, Figures, Section, Table, Text, heads
from surrogate.report.content import Content
from surrogate.report.figures.cloud import cloud_plot
from surrogate.space.dependence import correlated_pairs
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.distributions import Distribution
from surrogate.space.space import Parameter

#: Pairs of correlated parameters that are drawn.
PICTURES = 4


def section(content: Content) -> Section:
    """Parameters with ranges, units and distributions; outputs with units."""
    blocks: list[Block] = [_parameters(content)]
    if content.space.correlation is not None:
        blocks += _correlation(content)
    if content.space.constraints:
        kept = digits.listing([one.text for one in content.space.constraints])
        blocks.append(Text(f"All points keep these constraints: {kept}.", "note"))
    blocks.append(_outputs(content))
    return Section("parameters", "Parameters and outputs", tuple(blocks))


def _parameters(content: Content) -> Table:
    described = any(p.description for p in content.space.parameters)
    titles = ["parameter", "unit", "smallest", "largest", "distribution"]
    rows = [_row(parameter, described) for parameter in content.space.parameters]
    table = heads(*titles, *(["meaning"] if described else []), names=2)
    words = tuple(
        h if k in (2, 3) else type(h)(h.words, numeric=False) for k, h in enumerate(table)
    )
    rest = (
        "All other inputs have the solver's nominal value."
        if content.runs.attrs.get("constants", "{}") == "{}"
        else "All other inputs have the value of the study's constants (see Provenance) or the "
        "solver's nominal value."
    )
    rest = "They are columns of the table." if content.recorded else rest
    return Table(f"Parameters that vary. {rest}", words, tuple(rows))


def _row(parameter: Parameter, described: bool) -> tuple[Cell, ...]:
    unit = digits.unit(parameter.unit) or digits.NOTHING
    meaning = (Cell(parameter.description),) if described else ()
    law = parameter.distribution
    if law is None:
        kind = f"one of {digits.listing(parameter.levels)}"
        return (
            Cell(parameter.name),
            Cell(unit),
            Cell(digits.NOTHING),
            Cell(digits.NOTHING),
            Cell(kind),
            *meaning,
        )
    lower, upper = law.support
    return (
        Cell(parameter.name),
        Cell(unit),
        Cell(digits.number(lower), lower),
        Cell(digits.number(upper), upper),
        Cell(_law(law)),
        *meaning,
    )


def _law(law: Distribution | DiscreteLaw) -> str:
    if isinstance(law, DiscreteLaw):
        return str(law)
    words = dict(law.words)
    name = words.pop("distribution")
    bounds = words.pop("range", None)
    written = ", ".join(f"{key} {digits.number(value)}" for key, value in words.items())
    cut = ", truncated to the range" if bounds is not None and words else ""
    return f"{name}{': ' if written else ''}{written}{cut}"


def _outputs(content: Content) -> Table:
    rows = []
    for name in content.outputs:
        variable = content.runs[name]
        own = [dim for dim in variable.dims if dim != "run"]
        shape = " × ".join(f"{variable.sizes[dim]} {dim}" for dim in own) or "one number"
        values = content.values(name)[content.ok]
        low, high = (np.min(values), np.max(values)) if values.size else (np.nan, np.nan)
        rows.append(
            (
                Cell(name),
                Cell(digits.unit(content.unit(name)) or digits.NOTHING),
                Cell(shape),
                Cell(digits.figure(low, 4)),
                Cell(digits.figure(high, 4)),
                Cell(str(variable.attrs.get("long_name", ""))),
            )
        )
    titles = heads("output", "unit", "shape", "smallest", "largest", "meaning", names=3)
    return Table(
        "Outputs of the solver, and their smallest and largest value in all runs.",
        (*titles[:5], type(titles[5])("meaning", numeric=False)),
        tuple(rows),
    )


def _correlation(content: Content) -> list[Block]:
    """Which parameters depend on each other; for a table, what its cloud leaves empty."""
    found = correlated_pairs(content.space)
    pairs = [f"{other} and {one} ({digits.fixed(c, 2)})" for one, other, c in found]
    words = f"The parameters are correlated (Gaussian copula): {digits.listing(pairs)}."
    if not content.recorded:
        return [Text(words, "note")]
    words += (
        " The runs are a cloud and not a box: combinations that no run comes near are "
        "extrapolation, although each value lies in its range. Sensitivity takes the parameters "
        "as dependent."
    )
    pictures = tuple(
        Figure(
            cloud_plot(content.space, content.coded, content.numbers, (one, other)),
            f"Runs by {one} and {other}, from smallest to largest; shaded: corners without runs.",
        )
        for one, other, _ in found[:PICTURES]
    )
    return [Text(words, "note"), Figures(pictures)]
