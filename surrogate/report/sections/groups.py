"""Shares of the variance due to groups of parameters."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Figure, Figures, Head, Table, Text
from surrogate.report.figures.sobol import SHARE, Bars, index_bars
from surrogate.report.sections.measures import Index, index, sort_key

#: Decimals of shares beyond which nobody reads.
DECIMALS = 4
#: What is told of groups: variable, title, kind of bar.
KNOWN = (
    ("group_shapley", "share of the variance", "dark"),
    ("group_first_order", "closed index", "dark"),
    ("group_total", "total index", "light"),
)

#: Title, kind of bar and values of what is told.
Found = tuple[str, str, Index]


def blocks(table: xr.Dataset, output: str, stamp: str) -> list[Block]:
    """Bars and a table of the groups' shares of one output; nothing without groups."""
    if "group" not in table.dims:
        return []
    names = [str(name) for name in table["group"].values]
    found = [(title, kind, index(table, name)) for name, title, kind in KNOWN if name in table]
    series = [
        Bars(kind, title, *(values[part] for part in ("value", "low", "high")))
        for title, kind, values in found
    ]
    figure = Figure(
        index_bars(names, series, SHARE, f"Shares of the groups in {output}", trusted=not stamp),
        _caption(table, found),
        stamp=stamp,
    )
    return [Text(sentence(table)), Figures((figure,)), _table(table, names, found)]


def sentence(table: xr.Dataset) -> str:
    """How the variance divides between the groups, in words."""
    outside = [
        str(name)
        for name in table["parameter"].values
        if name not in ", ".join(table["members"].values.astype(str)).split(", ")
    ]
    if "group_shapley" in table:
        said = "Shapley effects sum to one. Those of its parameters sum to the share of a group."
        left = 1.0 - float(table["group_shapley"].sum())
        if outside:
            said += f" {digits.percent(left)} belong to no group ({digits.listing(outside)})."
        return said
    alone = float(np.clip(table["group_first_order"].sum(), 0.0, 1.0))
    rest = " and parameters of no group" if outside else ""
    return (
        f"The groups alone explain {digits.percent(alone)} of the variance; interactions between "
        f"different groups{rest} explain {digits.percent(1.0 - alone)}."
    )


def answer(table: xr.Dataset) -> tuple[str, str]:
    """The group with the largest share, and all shares with their intervals in a sentence."""
    kind, name = (
        ("Shapley effects", "group_shapley")
        if "group_shapley" in table
        else ("Total indices", "group_total")
    )
    values, groups = index(table, name), table["group"].values.astype(str)
    order = np.argsort(-np.nan_to_num(values["value"]), kind="stable")
    told = "; ".join(f"{groups[k]} {_number(values, k)}" for k in order)
    return groups[order[0]], f"{kind} of the groups: {told}."


def _caption(table: xr.Dataset, found: list[Found]) -> str:
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    told = (
        "Shares of the groups"
        if len(found) == 1
        else "Filled: closed index (the group alone). Outlined: total index (with its interactions "
        "with other parameters)"
    )
    return f"{told}. Whiskers: {confidence} intervals."


def _table(table: xr.Dataset, names: list[str], found: list[Found]) -> Table:
    order = np.argsort(-np.nan_to_num(found[-1][2]["value"]), kind="stable")
    rows = tuple(
        (
            Cell(names[k]),
            Cell(str(table["members"].values[k])),
            *(Cell(_number(values, k), sort_key(values["value"][k])) for _, _, values in found),
        )
        for k in order
    )
    heads = (
        Head("group", numeric=False),
        Head("parameters", numeric=False),
        *(Head(f"{title} (interval)") for title, _, _ in found),
    )
    return Table("Groups of parameters.", heads, rows)


def _number(values: Index, k: int) -> str:
    return digits.with_interval(
        *(values[part][k] for part in ("value", "low", "high")), most=DECIMALS
    )
