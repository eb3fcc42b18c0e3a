"""Figures of `summary.json` as tables: comparison, indices, agreement with cases."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

from surrogate.cli.table import Table

COMPARED = {
    "q2_cv": "Q2 (cross-validated)",
    "q2_test": "Q2 (test)",
    "rmse_test": "RMSE (test)",
    "rmse_cv": "RMSE (cross-validated)",
}
INDICES = {
    "first_order": "first order",
    "total": "total",
    "group_first_order": "first order",
    "group_total": "total",
    "group_shapley": "share of the variance",
}


def figure_tables(figures: Mapping[str, Any], titles: Mapping[str, str]) -> list[Table]:
    """Tables of each output, one for surrogates, parameters or groups.

    Columns are the variables in `titles`; all flat ones when none of the titles is there.
    """
    rows_of = {
        key: next(d for d in figure["dimensions"] if d != "output")
        for key, figure in figures.items()
        if len(figure.get("dimensions", ())) == 2 and "output" in figure["dimensions"]
    }
    made = []
    for (k, output), kind in product(
        enumerate(figures["output"]["values"]), dict.fromkeys(rows_of.values())
    ):
        own = [key for key, rows in rows_of.items() if rows == kind]
        columns = {key: title for key, title in titles.items() if key in own} or {
            key: key.replace("_", " ")
            for key in own
            if not key.endswith(("_low", "_high", "_sampling", "_surrogate"))
        }
        made.append(
            Table(
                output,
                (kind, *columns.values()),
                [
                    (name, *(_cell(figures, key, k, j) for key in columns))
                    for j, name in enumerate(figures[kind]["values"])
                ],
            )
        )
    return made


def _cell(figures: Mapping[str, Any], key: str, output: int, row: int) -> Any:
    """A figure, with its interval in four decimals when it has one."""
    value, low, high = _ends(figures, key, output, row)
    if value is None:
        return "-"
    return value if low is None or high is None else f"{value:.4f} [{low:.4f}, {high:.4f}]"


def _ends(figures: Mapping[str, Any], key: str, output: int, row: int) -> tuple[Any, Any, Any]:
    """A figure and the ends of its interval, None for what there is not."""
    value, low, high = (
        _value(figures[name], output, row) if name in figures else None
        for name in (key, f"{key}_low", f"{key}_high")
    )
    return value, low, high


def _value(figure: Mapping[str, Any], output: int, row: int) -> Any:
    first, second = (output, row) if figure["dimensions"][0] == "output" else (row, output)
    return figure["values"][first][second]


def validation_tables(figures: Mapping[str, Any]) -> list[str | Table]:
    """How many cases, which were excluded, and a table for each output."""
    inside, why = figures["inside"]["values"], figures["outside"]["values"]
    labels, models = figures["case"]["values"], figures["model"]["values"]
    parts: list[str | Table] = [
        f"validation: {len(inside)} cases from {figures['attributes']['cases']}, "
        f"{inside.count(False)} outside the ranges and excluded"
    ]
    aside = [f"  {label}: {words}" for label, words in zip(labels, why, strict=True) if words]
    parts += aside[:10] + [f"  and {len(aside) - 10} more; the page lists all"] * (len(aside) > 10)
    parts += [f"  {note}" for note in figures["attributes"]["notes"].split("\n") if note]
    units = figures["units"]["values"]
    for k, output in enumerate(figures["output"]["values"]):
        rows = [
            (title, *(_agreed(figures, key, k, j) for j in range(len(models))))
            for key, title in _AGREEMENT.items()
        ]
        parts.append(Table(f"{output} ({units[k] or '-'})", ("", *models), rows))
    return parts


_AGREEMENT = {
    "n": "cases",
    "slope": "slope through origin",
    "r2": "R2, 1 - SSE/SST",
    "r2_correlation": "R2, correlation",
    "mean_error_percent": "mean error (%)",
    "rmse": "RMSE",
    "bias": "bias",
    "lower_limit": "lower limit of agreement",
    "upper_limit": "upper limit of agreement",
    "coverage_95": "coverage of 95 % intervals",
}


def _agreed(figures: Mapping[str, Any], key: str, output: int, model: int) -> str:
    """A figure of agreement in three digits, with its interval when it has one."""
    value, low, high = _ends(figures, key, output, model)
    if value is None:
        return "-"
    return f"{value:.3g}" + (f" [{low:.3g}, {high:.3g}]" if None not in (low, high) else "")
