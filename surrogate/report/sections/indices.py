"""Sobol' indices of an output: what its variance comes from, and how sure that is."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import (
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
from surrogate.report.figures.sobol import sobol_bars

#: Interactions listed by name.
LISTED = 10
PARTS = ("low", "high", "sampling", "surrogate")


def index(table: xr.Dataset, name: str) -> dict[str, np.ndarray]:
    """`value`, `low`, `high`, `sampling`, `surrogate` of an index, NaN where not stored."""
    value = np.asarray(table[name].values, dtype=float)
    parts = {part: np.asarray(table[f"{name}_{part}"].values, dtype=float)
             if f"{name}_{part}" in table else np.full(value.shape, np.nan) for part in PARTS}
    return {"value": value, **parts}


def of_output(content: Content, output: str) -> xr.Dataset | None:
    """The sensitivity dataset of one output, or None."""
    table = content.sensitivity
    if table is None or output not in table["output"].values.astype(str):
        return None
    return table.sel(output=output)


def refusal(content: Content, output: str) -> str:
    """Why the indices of this output are not to be trusted; empty when they are."""
    table = of_output(content, output)
    if table is None:
        return ""
    return str(table["refused"].item()) if "refused" in table else ""


def blocks(content: Content, output: str) -> list:
    """Bars, numbers, interactions."""
    title = Heading("Sensitivity", anchor(output, "sensitivity"))
    table = of_output(content, output)
    if table is None:
        return [title, Text("No sensitivity analysis was made for this output.", "note")]
    refused = refusal(content, output)
    names = [str(name) for name in table["parameter"].values]
    first, total = index(table, "first_order"), index(table, "total")
    freeze_below = getattr(content.screening, "freeze_below", None)
    bars = sobol_bars(names, first, total, freeze_below=freeze_below, trusted=not refused,
                      output=output)
    figures = [Figure(bars, _caption(table, freeze_below), stamp="not to be trusted"
                      if refused else "")]
    said: list = [Text(f"Refused: {refused}", "warning")] if refused else []
    said.append(Text(_how(table, names, first)))
    if "second_order" in table:
        second = index(table, "second_order")
        if len(names) > 1 and np.isfinite(second["value"]).any():
            figures.append(Figure(
                interaction_map(names, second["value"], second["low"], second["high"], output),
                "Second-order indices: the share of the variance that each pair of parameters "
                "makes together, beyond both alone. Darker is larger.",
                stamp="not to be trusted" if refused else ""))
            said_later = [_interactions(names, second)]
        else:
            said_later = []
    else:
        said_later = []
    numbers = Fold("Indices in numbers", (_table(names, first, total), *said_later), open=True)
    return [title, *said, Figures(tuple(figures)), numbers]


def _how(table: xr.Dataset, names: list[str], first: dict) -> str:
    method = table.attrs.get("method", "sobol")
    surrogate = _word(table, "surrogate")
    alone = float(np.nansum(first["value"]))
    of = f" of {surrogate}" if surrogate else ""
    rest = digits.percent(max(0.0, 1.0 - alone))
    return (f"Method: {method}{of}. The parameters by themselves make "
            f"{digits.percent(min(alone, 1.0))} of the variance, interactions the other {rest}.")


def _word(table: xr.Dataset, name: str) -> str:
    return str(table[name].item()) if name in table else str(table.attrs.get(name, ""))


def _caption(table: xr.Dataset, freeze_below: float | None) -> str:
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    line = (f" Dashed line: parameters surely below {digits.plain(freeze_below)} may be frozen."
            if freeze_below is not None else "")
    return (f"Dark bar: first order (alone). Light bar: total (with all interactions). Long "
            f"whisker: whole {confidence} interval; the short strokes above and below it are its "
            f"sampling and its surrogate part.{line}")


def _table(names: list[str], first: dict, total: dict) -> Table:
    order = np.argsort(-np.nan_to_num(total["value"], nan=-1.0))
    titles = ("parameter", "first order (interval)", "± sampling", "± surrogate",
              "total (interval)", "± sampling", "± surrogate")
    rows = []
    for k in order:
        row = [Cell(names[k])]
        for values in (first, total):
            row.append(Cell(digits.with_interval(values["value"][k], values["low"][k],
                                                 values["high"][k]), _sort(values["value"][k])))
            row += [Cell(digits.figure(values[part][k], 2), _sort(values[part][k]))
                    for part in ("sampling", "surrogate")]
        rows.append(tuple(row))
    return Table("First-order and total indices with their intervals and the two half-widths "
                 "that these are made of.",
                 tuple(Head(title, numeric=k > 0) for k, title in enumerate(titles)),
                 tuple(rows), sortable=len(rows) > 3)


def _sort(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _interactions(names: list[str], second: dict) -> Table:
    pairs = [(i, j) for i in range(len(names)) for j in range(i)
             if np.isfinite(second["value"][i, j])]
    pairs.sort(key=lambda pair: -second["value"][pair])
    rows = tuple((Cell(f"{names[j]} × {names[i]}"),
                  Cell(digits.with_interval(*(second[key][i, j] for key in
                                              ("value", "low", "high")))))
                 for i, j in pairs[:LISTED])
    more = f" The {LISTED} largest of {len(pairs)}." if len(pairs) > LISTED else ""
    return Table(f"Second-order indices of the pairs.{more}",
                 (Head("pair", numeric=False), Head("second order (interval)")), rows)
