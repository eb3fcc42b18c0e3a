"""Sensitivity of an output: Sobol' indices or other measures, with their intervals."""

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
    Table,
    Text,
    anchor,
)
from surrogate.report.content import Content
from surrogate.report.figures.interactions import interaction_map
from surrogate.report.figures.sobol import SHARE, Bars, index_bars, part_bars
from surrogate.report.sections import groups, measures
from surrogate.report.sections.measures import Index, index, method_of, names_of, sort_key
from surrogate.sensitivity import ranks

#: Interactions listed by name.
LISTED = 10
#: Decimals of shares beyond which nobody reads.
DECIMALS = 4
STAMP = "not to be trusted"


def of_output(content: Content, output: str) -> xr.Dataset | None:
    """The sensitivity dataset of one output, or None."""
    table = content.sensitivity
    if table is None or output not in table["output"].values.astype(str):
        return None
    return table.sel(output=output)


def refusal(content: Content, output: str) -> str:
    """Why the indices of this output are not to be trusted; empty when they are."""
    table = of_output(content, output)
    if table is None or "refused" not in table:
        return ""
    return digits.squared(str(table["refused"].item()))


def blocks(content: Content, output: str) -> list[Block]:
    """Bars, numbers, interactions."""
    title = Heading("Sensitivity", anchor(output, "sensitivity"))
    table = of_output(content, output)
    if table is None and not content.fits:
        return []
    if table is None:
        return [title, Text("No sensitivity analysis was made for this output.", "note")]
    refused = refusal(content, output)
    said = [Text(f"Refused. {refused}", "warning")] if refused else []
    stamp = STAMP if refused else ""
    if "first_order" in table and "total" in table:
        shown = _sobol(content, output, table, stamp)
    else:
        shown = measures.blocks(table, output, content.unit(output), stamp)
    grouped = groups.blocks(table, output, stamp)
    if grouped:
        grouped.insert(0, Heading("Groups of parameters", anchor(output, "groups")))
    return [title, *said, *shown, *grouped]


def _sobol(content: Content, output: str, table: xr.Dataset, stamp: str) -> list[Block]:
    names, first, total = names_of(table), index(table, "first_order"), index(table, "total")
    freeze_below = content.screening.freeze_below if content.screening else None
    series = [
        Bars("dark", "first order", first["value"], first["low"], first["high"]),
        Bars("light", "total", total["value"], total["low"], total["high"]),
    ]
    figures = [
        Figure(
            index_bars(
                names,
                series,
                SHARE,
                f"Sobol' indices of {output}",
                freeze_below=freeze_below,
                trusted=not stamp,
            ),
            _bars_caption(table, freeze_below),
            stamp=stamp,
        )
    ]
    if _parts(total):
        figures.append(Figure(part_bars(names, total), _parts_caption(table, total)))
    worst = (
        np.asarray(table["total_worst"].values, dtype=float)
        if "total_worst" in table
        else np.full(len(names), np.nan)
    )
    numbers = [_table(names, first, total, worst)]
    second = index(table, "second_order") if "second_order" in table else None
    if second is not None and np.isfinite(second["value"]).any():
        figures.append(
            Figure(
                interaction_map(names, second["value"], second["low"], second["high"], output),
                "Second-order indices: share of the variance due to the interaction of each pair. "
                "The stronger the colour, the larger.",
                stamp=stamp,
            )
        )
        numbers.append(_interactions(names, second))
    tied = ranks.sentence(names, "total index", *(total[end] for end in ("value", "low", "high")))
    return [
        Text(" ".join(filter(None, [_how(table, first), tied]))),
        Figures(tuple(figures)),
        Fold("Indices in numbers", tuple(numbers), open=True),
    ]


def _how(table: xr.Dataset, first: Index) -> str:
    alone = float(np.clip(np.nansum(first["value"]), 0.0, 1.0))
    return (
        f"{method_of(table)} Main effects explain {digits.percent(alone)} of the variance, "
        f"interactions {digits.percent(1.0 - alone)}."
    )


def _bars_caption(table: xr.Dataset, freeze_below: float | None) -> str:
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    line = (
        f" Dashed: limit for freezing ({digits.number(freeze_below)})."
        if freeze_below is not None
        else ""
    )
    return (
        f"Filled: first-order index (main effect). Outlined: total index (with all "
        f"interactions). Whiskers: {confidence} intervals.{line}"
    )


def _parts_caption(table: xr.Dataset, total: Index) -> str:
    told = str(table.attrs.get("surrogate_part", ""))
    how = told.partition(";")[0] + (" and its missed variance" if "missed variance" in told else "")
    surrogate = f"error of the surrogate{f' ({how})' if how else ''}"
    if "sampling" not in _parts(total):
        return (
            f"Half-width of the intervals of the total indices: {surrogate}. The indices have a "
            "closed form and no sampling error."
        )
    return (
        "The two parts of the intervals of the total indices. Filled: sampling error, from the "
        f"finite sample. Outlined: {surrogate}."
    )


def _table(names: list[str], first: Index, total: Index, worst: np.ndarray) -> Table:
    order = np.argsort(-np.nan_to_num(total["value"], nan=-1.0), kind="stable")
    # A closed form has no sampling part, and a column of zeros would only take room.
    parts = _parts(first, total)
    titles = ["parameter"]
    for title in ("first order (interval)", "total (interval)"):
        titles += [title, *(f"±\u00a0{part}" for part in parts)]
    rows = [[Cell(names[k]), *_numbers(first, k, parts), *_numbers(total, k, parts)] for k in order]
    caption = (
        "First-order and total indices with their intervals, and the half-widths of the "
        f"{'two parts' if len(parts) == 2 else 'parts'} of each interval."
    )
    if np.isfinite(worst).any():
        titles.append("total at worst")
        rows = [
            [*row, Cell(digits.figure(worst[k], 2), sort_key(worst[k]))]
            for row, k in zip(rows, order, strict=True)
        ]
        caption += (
            " At worst: largest possible total index of the solver itself, if all variance that "
            "the surrogate misses were due to this parameter."
        )
    return Table(
        caption,
        tuple(Head(title, numeric=k > 0) for k, title in enumerate(titles)),
        tuple(map(tuple, rows)),
        sortable=len(rows) > 3,
    )


def _parts(*indices: Index) -> list[str]:
    """Parts of the intervals that are more than rounding somewhere."""
    return [
        part
        for part in ("sampling", "surrogate")
        if any((np.nan_to_num(values[part]) > 1e-9).any() for values in indices)
    ]


def _numbers(values: Index, k: int, parts: list[str]) -> list[Cell]:
    whole = digits.with_interval(
        *(values[part][k] for part in ("value", "low", "high")), most=DECIMALS
    )
    return [
        Cell(whole, sort_key(values["value"][k])),
        *(Cell(digits.figure(values[part][k], 2), sort_key(values[part][k])) for part in parts),
    ]


def _interactions(names: list[str], second: Index) -> Table:
    pairs = [
        (i, j) for i in range(len(names)) for j in range(i) if np.isfinite(second["value"][i, j])
    ]
    pairs.sort(key=lambda pair: -second["value"][pair])
    rows = tuple(
        (
            Cell(f"{names[j]} × {names[i]}"),
            Cell(
                digits.with_interval(
                    *(second[key][i, j] for key in ("value", "low", "high")), most=DECIMALS
                )
            ),
        )
        for i, j in pairs[:LISTED]
    )
    more = f" The {LISTED} largest of {len(pairs)}." if len(pairs) > LISTED else ""
    return Table(
        f"Second-order indices of the pairs.{more}",
        (Head("pair", numeric=False), Head("second order (interval)")),
        rows,
    )
