"""How many runs are enough: learning curves, and what more runs would bring."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import (
    Block,
    Cell,
    Figure,
    Figures,
    Fold,
    Head,
    Heading,
    Section,
    Table,
    Text,
    anchor,
)
from surrogate.report.content import Content
from surrogate.report.figures.learning import Band, learning_plot


def section(content: Content, table: xr.Dataset) -> Section:
    """For each output: what is said of the best surrogate, its curve, the others folded."""
    blocks: list[Block] = []
    for output in table["output"].values.astype(str):
        blocks.append(
            Heading(digits.labelled(output, content.unit(output)), anchor(output, "runs"))
        )
        blocks += _output(content, table, output)
    return Section("learning", "How many runs are enough", tuple(blocks))


def _output(content: Content, table: xr.Dataset, output: str) -> list[Block]:
    own = table.sel(output=output)
    names = [
        str(name) for name in own["surrogate"].values if own["training_runs"].sel(surrogate=name)
    ]
    best = content.best(output)
    first = best if best in names else names[0]
    said = str(own["sentence"].sel(surrogate=first).item()).splitlines()
    found: list[Block] = [
        Text(f"{_printed(words, content.unit(output))}.", "lead") for words in said
    ]
    found += _figures(content, own, [first], output)
    found.append(_table(content, own, names, output))
    others = [name for name in names if name != first]
    if others:
        drawn = tuple(_figures(content, own, others, output))
        found += [Fold(f"Curves of {digits.listing(others)}", drawn)] if drawn else []
    return found


def _printed(words: str, unit: str) -> str:
    """A sentence of the dataset as the page prints it."""
    words = digits.squared(words)
    return words[:1].upper() + (words[1:].replace(unit, digits.unit(unit)) if unit else words[1:])


def _figures(content: Content, own: xr.Dataset, names: list[str], output: str) -> list[Block]:
    """The curves of these surrogates; none of one whose errors are zero."""
    drawn = [
        _figure(content, own, n, output)
        for n in names
        if (own["rmse_low"].sel(surrogate=n) > 0.0).any()
    ]
    return [Figures(tuple(drawn))] if drawn else []


def _figure(content: Content, own: xr.Dataset, surrogate: str, output: str) -> Figure:
    one = own.sel(surrogate=surrogate)
    seen = _band(one, one["runs"].values, "rmse")
    ahead = _band(one, one["ahead"].values * float(one["training_runs"]), "rmse_ahead")
    goal = float(one["rmse_goal"])
    plot = learning_plot(seen, ahead, goal, surrogate, output, content.unit(output))
    judged = str(own.attrs["judged"])
    level = " Level line: the goal." if np.isfinite(goal) else ""
    return Figure(
        plot,
        f"{surrogate}: RMSE on {judged}, against the number of training runs. Line and band: "
        "median, 5 and 95 % of random subsets. Dashed: the law through the medians with its "
        f"90 % interval. Both axes are logarithmic.{level}",
    )


def _band(one: xr.Dataset, runs: np.ndarray, name: str) -> Band:
    value, low, high = (one[name + end].values for end in ("", "_low", "_high"))
    known = np.isfinite(runs) & (value > 0.0) & (low > 0.0)  # on logarithmic axes
    return Band(runs[known], value[known], low[known], high[known])


def _table(content: Content, own: xr.Dataset, names: list[str], output: str) -> Table:
    unit, rows = content.unit(output), []
    for name in names:
        one = own.sel(surrogate=name)
        rows.append(
            (
                Cell(name),
                Cell(str(int(one["training_runs"]))),
                Cell(digits.figure(_last(one, "rmse"))),
                Cell(digits.score(_last(one, "q2"))),
                Cell(_ends(one, "rmse_doubled")),
                Cell(digits.score(float(one["q2_doubled"]))),
                Cell(_needed(one)),
            )
        )
    goal = str(own["goal"].item())
    heads = (
        Head("surrogate", numeric=False),
        Head("training runs"),
        Head(digits.labelled("RMSE", unit)),
        Head("Q²"),
        Head(digits.labelled("RMSE, twice the runs", unit)),
        Head("Q², twice the runs"),
        Head(f"runs for {digits.squared(goal)}" if goal else "runs for the goal"),
    )
    caption = (
        "RMSE and Q² of the largest subset, and the forecast with its 90 % interval. The "
        "forecast takes for granted that more runs are of the same kind."
    )
    return Table(caption, heads, tuple(rows))


def _last(one: xr.Dataset, name: str) -> float:
    values = one[name].values[np.isfinite(one[name].values)]
    return float(values[-1]) if len(values) else float("nan")


def _ends(one: xr.Dataset, name: str) -> str:
    return digits.with_interval(*(float(one[name + end]) for end in ("", "_low", "_high")))


def _needed(one: xr.Dataset) -> str:
    value, low, high = (float(one["runs_needed" + end]) for end in ("", "_low", "_high"))
    if not np.isfinite(value):
        return digits.NOTHING if np.isnan(value) else f"more than {8 * int(one['training_runs'])}"
    if bool(one["reached"]):
        return f"reached: {value:.0f}"
    return (
        f"{value:.0f} ({low:.0f} to {high:.0f})" if np.isfinite(high) else f"{value:.0f}, or more"
    )
