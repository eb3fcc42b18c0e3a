"""Coefficients of all polynomials of an output side by side: which remain with more runs."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import Cell, Head, Table
from surrogate.report.content import Content
from surrogate.report.parity import learnt_only_from

#: What the last column says.
KEPT, MOVED = "yes", "no"


@dataclass(frozen=True)
class Column:
    """One polynomial: its number of runs, and term -> (coefficient, half interval)."""

    name: str
    runs: int
    confidence: float
    terms: dict[str, tuple[float, float]]

    @classmethod
    def of(cls, name: str, table: xr.Dataset) -> Column:
        """From a regression table; the half interval is NaN where there is none."""
        value, high = (
            np.asarray(table[key].values, dtype=float) for key in ("coefficient", "high")
        )
        terms = zip(table["term"].values.astype(str), value, high - value, strict=True)
        return cls(
            name,
            table.sizes.get("run", 0),
            float(table.attrs.get("confidence", 0.95)),
            {term: (float(v), float(h)) for term, v, h in terms},
        )


def table(content: Content, output: str) -> Table | None:
    """Coefficients of the terms that two or more polynomials share; None with nothing to share.

    Columns from few runs to many. The last says whether the interval of the first
    coefficient of a row covers the last one.
    """
    columns = sorted(
        (
            Column.of(name, by_output[output])
            for name, by_output in content.regression.items()
            if output in by_output
        ),
        key=lambda column: (column.runs, len(column.terms)),
    )
    count = Counter(term for column in columns for term in column.terms)
    shared = [
        term for term in dict.fromkeys(term for c in columns for term in c.terms) if count[term] > 1
    ]
    if not shared:
        return None
    aliased = {column.name: _aliased(content, column.name) for column in columns}
    told = [column for column in columns if aliased[column.name]]
    rows = tuple(
        (
            Cell(printed(term)),
            *(_cell(column, term, columns) for column in columns),
            *(
                Cell(
                    digits.listing(map(printed, aliased[column.name].get(term, ())))
                    or digits.NOTHING
                )
                for column in told
            ),
            _verdict(columns, term),
        )
        for term in shared
    )
    unit = content.unit(output)
    heads = (
        Head("term", numeric=False),
        *(
            Head(digits.labelled(f"{column.name}, {digits.quantity(column.runs, 'run')}", unit))
            for column in columns
        ),
        *(Head(f"aliased in {column.name}", numeric=False) for column in told),
        Head("first interval contains last value", numeric=False),
    )
    return Table(_caption(told, columns), heads, rows)


def printed(term: str) -> str:
    """A term as it is printed: `tension × mu_skin`, `tension²`, the constant by name."""
    sign = digits.MINUS if term.startswith("-") else ""
    term = term.lstrip("-")
    return sign + ("constant" if term == "1" else term.replace(":", " × ").replace("^2", "²"))


def _aliased(content: Content, name: str) -> dict[str, list[str]]:
    """Main effect -> interactions that are aliased with it in the surrogate's training design.

    Read off the smallest two-level fraction that contains all its runs; empty without one.
    """
    holding = [design for design in content.aliasing if name in learnt_only_from(content, design)]
    if not holding:
        return {}
    smallest = min(holding, key=lambda design: (content.words("design") == design).sum())
    return {
        effect: found
        for effect, aliases in content.aliasing[smallest].table
        if ":" not in effect and (found := [alias for alias in aliases if ":" in alias])
    }


def _cell(column: Column, term: str, columns: list[Column]) -> Cell:
    if term not in column.terms:
        return Cell("")
    value, half = column.terms[term]
    moved = column is _holders(columns, term)[0] and _covers(columns, term) is False
    # A wide interval must not round its coefficient away: 2.31 ± 23.
    words = (
        digits.with_half(value, half)
        if half <= abs(value) or not np.isfinite(half)
        else f"{digits.figure(value)} ± {digits.figure(half, 2)}"
    )
    return Cell(words, value if np.isfinite(value) else None, tone="bad" if moved else "")


def _verdict(columns: list[Column], term: str) -> Cell:
    covers = _covers(columns, term)
    words = {True: KEPT, False: MOVED, None: digits.NOTHING}[covers]
    return Cell(words, tone="bad" if covers is False else "")


def _holders(columns: list[Column], term: str) -> list[Column]:
    return [column for column in columns if term in column.terms]


def _covers(columns: list[Column], term: str) -> bool | None:
    """Whether the first interval holds the last value; None when one of them is not known."""
    first, *_, last = _holders(columns, term)
    (value, half), (other, _) = first.terms[term], last.terms[term]
    # Rounding must not count: an exact polynomial has intervals of width zero.
    slack = 1e-9 * max(abs(value), abs(other))
    return bool(abs(other - value) <= half + slack) if np.isfinite([half, other]).all() else None


def _caption(told: list[Column], columns: list[Column]) -> str:
    confidence = digits.percent(columns[0].confidence)
    said = (
        f"Coefficients per coded unit, from few runs to many, each ± half its {confidence} "
        "interval. A first coefficient is marked when its interval does not contain the last one "
        "of its row: more runs contradict it. A yes beside an interval wider than its "
        "coefficient is no evidence."
    )
    if told:
        said += (
            " Aliased: interactions aliased with the term in the training design; the coefficient "
            "is the sum of all of them."
        )
    if any(column.runs <= len(column.terms) for column in columns):
        said += " A saturated model has no intervals."
    return said
