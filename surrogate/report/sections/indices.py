"""Sensitivity of an output: what its variance comes from, and how sure that is."""

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
from surrogate.report.figures.sobol import SHARE, Bars, index_bars, part_bars

#: Interactions listed by name.
LISTED = 10
PARTS = ("low", "high", "sampling", "surrogate")
STAMP = "not to be trusted"


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
    return str(table["refused"].item()) if table is not None and "refused" in table else ""


def blocks(content: Content, output: str) -> list:
    """Bars, numbers, interactions."""
    title = Heading("Sensitivity", anchor(output, "sensitivity"))
    table = of_output(content, output)
    if table is None:
        return [title, Text("No sensitivity analysis was made for this output.", "note")]
    refused = refusal(content, output)
    said = [Text(f"Refused. {refused}", "warning")] if refused else []
    stamp = STAMP if refused else ""
    if "first_order" in table and "total" in table:
        shown = _sobol(content, output, table, stamp)
    else:
        shown = _others(table, output, stamp)
    return [title, *said, *shown]


def names_of(table: xr.Dataset) -> list[str]:
    """Parameters of a sensitivity dataset."""
    return [str(name) for name in table["parameter"].values]


def _sobol(content: Content, output: str, table: xr.Dataset, stamp: str) -> list:
    names, first, total = names_of(table), index(table, "first_order"), index(table, "total")
    freeze_below = content.screening.freeze_below if content.screening else None
    series = [Bars("dark", "first order", first["value"], first["low"], first["high"]),
              Bars("light", "total", total["value"], total["low"], total["high"])]
    figures = [Figure(index_bars(names, series, SHARE, f"Sobol' indices of {output}",
                                 freeze_below=freeze_below, trusted=not stamp),
                      _bars_caption(table, freeze_below), stamp=stamp)]
    if np.isfinite(total["sampling"]).any() or np.isfinite(total["surrogate"]).any():
        figures.append(Figure(part_bars(names, total), _parts_caption(table, total)))
    worst = np.asarray(table["total_worst"].values, dtype=float) if "total_worst" in table \
        else np.full(len(names), np.nan)
    numbers = [_table(names, first, total, worst)]
    second = index(table, "second_order") if "second_order" in table else None
    if second is not None and np.isfinite(second["value"]).any():
        figures.append(Figure(
            interaction_map(names, second["value"], second["low"], second["high"], output),
            "Second order: the share of the variance that each pair of parameters makes "
            "together, beyond both alone. Darker is larger.", stamp=stamp))
        numbers.append(_interactions(names, second))
    return [Text(_how(table, first)), Figures(tuple(figures)),
            Fold("Indices in numbers", tuple(numbers), open=True)]


def _how(table: xr.Dataset, first: dict) -> str:
    alone = float(np.clip(np.nansum(first["value"]), 0.0, 1.0))
    return (f"{_method(table)} The parameters by themselves make {digits.percent(alone)} of the "
            f"variance, interactions {digits.percent(1.0 - alone)}.")


def _method(table: xr.Dataset) -> str:
    words = [str(table.attrs.get("method", "")).replace("sobol", "Sobol'").replace("_", " ")]
    surrogate = str(table.attrs.get("surrogate", ""))
    words += [f"of surrogate {surrogate}"] if surrogate else []
    computed = str(table.attrs.get("computed", ""))
    words += [f"by {computed}"] if computed else []
    return f"Method: {' '.join(word for word in words if word)}."


def _bars_caption(table: xr.Dataset, freeze_below: float | None) -> str:
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    line = (f" Dashed: a parameter surely below {digits.plain(freeze_below)} may be frozen."
            if freeze_below is not None else "")
    return (f"Dark: first order (the parameter alone). Light: total (with all its "
            f"interactions). Whiskers: {confidence} intervals.{line}")


def _parts_caption(table: xr.Dataset, total: dict) -> str:
    how = str(table.attrs.get("surrogate_part", ""))
    exact = not np.nan_to_num(total["sampling"]).any()
    sampling = "closed form, no sampling" if exact else "from the finite sample"
    return (f"What the intervals of the total indices are made of. Dark: sampling part "
            f"({sampling}). Light: the surrogate's own part{f' ({how})' if how else ''}.")


def _table(names: list[str], first: dict, total: dict, worst: np.ndarray) -> Table:
    order = np.argsort(-np.nan_to_num(total["value"], nan=-1.0), kind="stable")
    titles = ["parameter", "first order (interval)", "±\u00a0sampling", "±\u00a0surrogate",
              "total (interval)", "±\u00a0sampling", "±\u00a0surrogate"]
    rows = [[Cell(names[k]), *_numbers(first, k), *_numbers(total, k)] for k in order]
    caption = ("First-order and total indices with their intervals, and the half-widths of the "
               "two parts of each interval.")
    if np.isfinite(worst).any():
        titles.append("total at worst")
        rows = [[*row, Cell(digits.figure(worst[k], 2), _sort(worst[k]))]
                for row, k in zip(rows, order, strict=True)]
        caption += (" At worst: the largest total index that the solver itself can have, should "
                    "all that the surrogate misses belong to this parameter.")
    return Table(caption, tuple(Head(title, numeric=k > 0) for k, title in enumerate(titles)),
                 tuple(map(tuple, rows)), sortable=len(rows) > 3)


def _numbers(values: dict, k: int) -> list[Cell]:
    whole = digits.with_interval(*(values[part][k] for part in ("value", "low", "high")))
    return [Cell(whole, _sort(values["value"][k])),
            *(Cell(digits.figure(values[part][k], 2), _sort(values[part][k]))
              for part in ("sampling", "surrogate"))]


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


def _others(table: xr.Dataset, output: str, stamp: str) -> list:
    """Any other method: bars and a table of each index that has a value a parameter."""
    names = names_of(table)
    found = [str(name) for name, variable in table.data_vars.items()
             if variable.dims == ("parameter",) and np.issubdtype(variable.dtype, np.number)
             and str(name).rpartition("_")[2] not in PARTS]
    if not found:
        return [Text(_method(table))]
    values = {name: index(table, name) for name in found}
    figures = tuple(Figure(
        index_bars(names, [Bars("dark", name, *(values[name][part]
                                                for part in ("value", "low", "high")))],
                   _label(table, name), f"{name} of {output}", trusted=not stamp),
        f"{name}{_meaning(table, name)}, with its interval where one is known.", stamp=stamp)
        for name in found)
    rows = tuple((Cell(names[k]), *(Cell(digits.with_interval(
        *(values[name][part][k] for part in ("value", "low", "high"))),
        _sort(values[name]["value"][k])) for name in found)) for k in range(len(names)))
    heads = (Head("parameter", numeric=False), *(Head(_label(table, name)) for name in found))
    return [Text(_method(table)), Figures(figures),
            Table(f"Indices of {output} with their intervals.", heads, rows,
                  sortable=len(rows) > 3)]


def _label(table: xr.Dataset, name: str) -> str:
    return digits.labelled(name, str(table[name].attrs.get("units", "")))


def _meaning(table: xr.Dataset, name: str) -> str:
    words = str(table[name].attrs.get("long_name", ""))
    return f": {words}" if words and words != name else ""
