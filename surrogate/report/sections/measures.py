"""Measures of sensitivity, whatever the method: values and intervals, one a parameter."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Figure, Figures, Head, Table, Text
from surrogate.report.figures.sobol import Bars, index_bars

PARTS = ("low", "high", "sampling", "surrogate")

#: Names of methods as a sentence has them.
METHODS = {
    "sobol": "Sobol' indices",
    "shapley": "Shapley effects",
    "dependent_sobol": "full and independent Sobol' indices",
    "given_data": "first-order indices of the runs themselves",
    "morris": "elementary effects (Morris)",
    "dgsm": "squared derivatives (DGSM)",
    "pawn": "PAWN",
    "rbd_fast": "first-order indices (RBD-FAST)",
    "quantile": "goal-oriented indices of a quantile",
    "target": "Sobol' indices",
}
#: What the measures of the methods that ship are, and the power of the output's unit in them.
KNOWN = {
    "mu_star": (1, "mean absolute elementary effect (Morris)"),
    "mu": (1, "mean elementary effect (Morris)"),
    "sigma": (1, "standard deviation of the elementary effects: curvature or interaction (Morris)"),
    "nu": (2, "mean squared derivative"),
    "total_bound": (0, "upper bound of the total index, from derivatives"),
    "median": (0, "median distance of the conditional distributions (PAWN)"),
    "mean": (0, "mean distance of the conditional distributions (PAWN)"),
    "maximum": (0, "largest distance of the conditional distributions (PAWN)"),
    "first_order": (0, "share of the variance by the parameter alone, without interactions"),
    "first_order_rbd": (0, "share of the variance by the parameter alone (RBD-FAST)"),
    "quantile_share": (0, "share of the loss at the quantile that knowing the parameter saves"),
    "shapley": (0, "Shapley effect: share of the variance, dependence split evenly"),
    "closed_first_order": (
        0,
        "share of the variance explained by the parameter and what depends on it",
    ),
    "independent_total": (0, "share of the variance due to the independent part of the parameter"),
    "full_first_order": (
        0,
        "share of the variance by the parameter with what depends on it, without interactions",
    ),
    "full_total": (0, "the same with interactions"),
    "independent_first_order": (
        0,
        "share of the variance by what is the parameter's own, without interactions",
    ),
    "effect": (1, "change of the output from the smallest to the largest value, others fixed"),
    "share": (0, "share of the sum of the absolute effects"),
    "share_squared": (0, "share of the sum of squares of the effects"),
}


#: `value`, `low`, `high`, `sampling` and `surrogate` of an index.
Index = dict[str, np.ndarray]


def index(table: xr.Dataset, name: str) -> Index:
    """`value`, `low`, `high`, `sampling`, `surrogate` of an index, NaN where not stored."""
    value = np.asarray(table[name].values, dtype=float)
    parts = {
        part: np.asarray(table[f"{name}_{part}"].values, dtype=float)
        if f"{name}_{part}" in table
        else np.full(value.shape, np.nan)
        for part in PARTS
    }
    return {"value": value, **parts}


def names_of(table: xr.Dataset) -> list[str]:
    """Parameters of a sensitivity dataset."""
    return [str(name) for name in table["parameter"].values]


def measures_of(table: xr.Dataset) -> list[str]:
    """Names of what has one number a parameter, the method's leading one first."""
    return [
        str(name)
        for name, variable in table.data_vars.items()
        if variable.dims == ("parameter",)
        and np.issubdtype(variable.dtype, np.floating)
        and str(name).rpartition("_")[2] not in PARTS
    ]


def blocks(table: xr.Dataset, output: str, unit: str, stamp: str) -> list[Block]:
    """Bars and a table of each measure of one output."""
    names, found = names_of(table), measures_of(table)
    values = {name: index(table, name) for name in found}
    labels = {name: digits.labelled(name, unit_of(name, table, unit)) for name in found}
    figures = tuple(
        Figure(
            index_bars(
                names,
                [Bars("dark", name, *(values[name][part] for part in ("value", "low", "high")))],
                labels[name],
                f"{name} of {output}",
                trusted=not stamp,
            ),
            f"{name}{_meaning(table, name)}.",
            stamp=stamp,
        )
        for name in found
    )
    rows = tuple(
        (
            Cell(names[k]),
            *(
                Cell(
                    digits.with_interval(
                        *(values[name][part][k] for part in ("value", "low", "high"))
                    ),
                    sort_key(values[name]["value"][k]),
                )
                for name in found
            ),
        )
        for k in range(len(names))
    )
    heads = (Head("parameter", numeric=False), *(Head(labels[name]) for name in found))
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    return [
        Text(method_of(table)),
        Figures(figures),
        Table(
            f"The same in numbers, with {confidence} intervals where they are known.",
            heads,
            rows,
            sortable=len(rows) > 3,
        ),
    ]


def unit_of(name: str, table: xr.Dataset, unit: str) -> str:
    """Unit of a measure of an output with this unit."""
    if "units" in table[name].attrs:
        return str(table[name].attrs["units"])
    power = KNOWN.get(name, (0, ""))[0]
    return f"({unit})^{power}" if unit and power > 1 else unit if power else ""


def _meaning(table: xr.Dataset, name: str) -> str:
    words = str(table[name].attrs.get("long_name", "")) or KNOWN.get(name, (0, ""))[1]
    return f": {words}" if words and words != name else ""


def method_of(table: xr.Dataset) -> str:
    """How the indices were computed, as a sentence."""
    method = str(table.attrs.get("method", ""))
    words = [METHODS.get(method, method.replace("_", " "))]
    if table.attrs.get("event"):
        words += [f"of whether it is {table.attrs['event']}"]
        if "probability" in table:
            words += [f"(probability {digits.figure(float(table['probability']))})"]
    surrogate = str(table.attrs.get("surrogate", ""))
    words += [f"of surrogate {surrogate}"] if surrogate else []
    computed = str(table.attrs.get("computed", ""))
    words += [f"by {computed}"] if computed else []
    if "probability" in table.attrs:
        words += [f"at probability {table.attrs['probability']:g}"]
    return f"Method: {' '.join(word for word in words if word)}."


def variance_of(table: xr.Dataset) -> str:
    """What the shares are shares of: the output's variance, or that of an event."""
    event = table.attrs.get("event")
    return f"the variance of whether it is {event}" if event else "its variance"


def sort_key(value: float) -> float | None:
    """What a table sorts a number by."""
    return float(value) if np.isfinite(value) else None
