"""Validation: surrogates and other models against reference cases."""

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
    Points,
    Section,
    Table,
    Text,
    anchor,
)
from surrogate.report.figures.agreement import difference_plot, scatter_plot

#: From this many models on, drawings of all but the first ones are folded.
SHOWN = 4
HEADS = (
    "model",
    "cases",
    "slope",
    "R² (1 − SSE/SST)",
    "R² (correlation)",
    "mean error (%)",
    "coverage of 95 % intervals",
)
DIFFERENCES = ("model", "RMSE", "bias", "lower limit of agreement", "upper limit of agreement")
MEANING = (
    "Slope: regression through the origin, reference on x, model on y. R² (1 − SSE/SST) compares "
    "the errors of the model with the scatter of the reference about its mean; it is negative "
    "when the mean predicts better. R² (correlation) ignores scale and offset. Errors are model "
    "minus reference. Mean error: mean of the errors in percent of each reference. Bias: mean of "
    "the errors. Limits of agreement: bias ± 1.96 standard deviations, between which 95 % of the "
    "differences are expected (Bland and Altman 1986). Intervals of the limits: {how}. Coverage: "
    "share of the reference values inside the surrogate's prediction intervals. These intervals "
    "contain the error of the surrogate against its solver only. They do not contain the error "
    "of the solver, inputs that the study does not vary, or errors of measurement, so a low "
    "coverage need not be the fault of the surrogate."
)


def section(data: xr.Dataset) -> Section:
    """Which cases, which were set aside, and for each output the figures and the plots."""
    blocks: list[Block] = [Text(_cases(data))]
    blocks += [Text(words, "lead") for words in _closest(data)]
    notes = [note for note in str(data.attrs.get("notes", "")).split("\n") if note]
    if notes:
        blocks.append(Points(tuple(notes), "warning"))
    aside = np.flatnonzero(~data["inside"].values)
    if len(aside):
        blocks.append(_aside(data, aside))
    for output in data["output"].values.astype(str):
        blocks += _blocks(data.sel(output=output), output)
    return Section("validation", "Validation", tuple(blocks))


def _cases(data: xr.Dataset) -> str:
    inside = data["inside"].values
    words = f"{digits.quantity(len(inside), 'case')} from {data.attrs['cases']}"
    if inside.all():
        words += ", all inside the ranges of the study's parameters."
    else:
        words += (
            f"; {int((~inside).sum())} of them are outside the ranges of the study's parameters "
            "and are excluded."
        )
    if "subject" in data:
        subjects = len(np.unique(data["subject"].values[inside]))
        words += (
            f" They come from {digits.quantity(subjects, 'subject')}. The limits of agreement "
            "contain the scatter within and between subjects. The interval of the slope "
            "assumes independent cases."
        )
    return words


def _closest(data: xr.Dataset) -> list[str]:
    """A sentence for each output with figures: the closest model, its bias and its limits."""
    said = []
    for output, best, row in _best(data):
        unit = str(data["units"].sel(output=output).item())
        side = "high" if row["bias"] > 0.0 else "low"
        sure = "" if row["bias_low"] > 0.0 or row["bias_high"] < 0.0 else " (not significant)"
        bias = digits.with_unit(digits.figure(abs(row["bias"]), 2), unit)
        limits = digits.with_unit(digits.interval(row["lower_limit"], row["upper_limit"]), unit)
        said.append(
            f"Closest model of {output}: {best}. On average it is {bias} too {side}{sure}. For a "
            f"new case, expect a difference of {limits} (95 % limits of agreement)."
        )
    return said


def _best(data: xr.Dataset) -> list[tuple[str, str, dict[str, float]]]:
    """(output, model with the smallest RMSE, its figures) of each output with figures."""
    found = []
    for output in data["output"].values.astype(str):
        own = data.sel(output=output)
        names = [
            name
            for name in own["model"].values.astype(str)
            if np.isfinite(own["lower_limit"].sel(model=name))
        ]
        if names:
            best = min(names, key=lambda name: float(own["rmse"].sel(model=name)))
            found.append(
                (
                    output,
                    best,
                    {
                        key: float(own[key].sel(model=best))
                        for key in (
                            "bias",
                            "bias_low",
                            "bias_high",
                            "lower_limit",
                            "upper_limit",
                            "n",
                        )
                    },
                )
            )
    return found


def verdicts(data: xr.Dataset) -> list[tuple[str, str, str]]:
    """(output, the closest model in a few words, how close) of each output with figures."""
    found = []
    for output, best, row in _best(data):
        unit = str(data["units"].sel(output=output).item())
        limits = digits.interval(row["lower_limit"], row["upper_limit"])
        bias = digits.with_unit(digits.figure(row["bias"], 2), unit)
        found.append(
            (
                output,
                f"{best}, bias {bias}",
                (
                    f"95 % limits of agreement with {data.attrs['cases']}: "
                    f"{digits.with_unit(limits, unit)} ({row['n']:.0f} cases)."
                ),
            )
        )
    return found


def _aside(data: xr.Dataset, rows: np.ndarray) -> Fold:
    table = Table(
        "Excluded cases; the range of the study in brackets.",
        (Head("case", numeric=False), Head("outside", numeric=False)),
        tuple(
            (Cell(str(data["case"].values[k])), Cell(str(data["outside"].values[k]))) for k in rows
        ),
    )
    return Fold(f"{digits.quantity(len(rows), 'case')} excluded", (table,), open=len(rows) <= 10)


def _blocks(data: xr.Dataset, output: str) -> list[Block]:
    unit = str(data["units"].item())
    names = [name for name in data["model"].values.astype(str) if data["n"].sel(model=name) >= 1]
    heading = Heading(digits.labelled(output, unit), anchor("validation", output))
    if not names:
        return [
            heading,
            Text(
                "No case lies inside the ranges of the study, so nothing can be compared.",
                "warning",
            ),
        ]
    ranked = sorted(names, key=lambda name: float(data["rmse"].sel(model=name)))
    figures = [_plots(data.sel(model=name), name, output, unit) for name in ranked]
    shown = [figure for pair in figures[:SHOWN] for figure in pair]
    how = "delta method" if "subject" in data else "noncentral t, exact for normal differences"
    blocks: list[Block] = [
        heading,
        *_tables(data, names, ranked[0], unit),
        Figures(tuple(shown)),
        Fold("Definitions", (Text(MEANING.format(how=how)),), open=True),
    ]
    if figures[SHOWN:]:
        more = digits.quantity(len(figures) - SHOWN, "further model")
        blocks.append(
            Fold(
                f"Plots of {more}",
                (Figures(tuple(figure for pair in figures[SHOWN:] for figure in pair)),),
            )
        )
    return blocks


def _tables(data: xr.Dataset, names: list[str], best: str, unit: str) -> list[Table]:
    """How the models follow the reference, and how far they are from it."""
    rows = {
        name: {
            str(key): float(value)
            for key, value in data.sel(model=name).data_vars.items()
            if value.ndim == 0 and np.issubdtype(value.dtype, np.number)
        }
        for name in names
    }
    apart = tuple(
        Head(digits.labelled(word, unit) if k else word, numeric=k > 0)
        for k, word in enumerate(DIFFERENCES)
    )
    follow = tuple(Head(word, numeric=k > 0) for k, word in enumerate(HEADS))
    return [
        _table(
            "Each model against the reference; 95 % intervals in brackets.",
            follow,
            {name: _following(row) for name, row in rows.items()},
            best,
        ),
        _table(
            "Each model minus the reference. Bold: smallest RMSE.",
            apart,
            {name: _differing(row) for name, row in rows.items()},
            best,
        ),
    ]


def _table(
    caption: str, heads: tuple[Head, ...], rows: dict[str, list[tuple[str, float]]], best: str
) -> Table:
    return Table(
        caption,
        heads,
        tuple(
            (
                Cell(name, tone="strong" if name == best else ""),
                *(Cell(words, value if np.isfinite(value) else None) for words, value in row),
            )
            for name, row in rows.items()
        ),
        sortable=len(rows) > 2,
    )


def _following(row: dict[str, float]) -> list[tuple[str, float]]:
    words = {
        "n": f"{row['n']:.0f}",
        "slope": _interval(row, "slope"),
        "r2": digits.figure(row["r2"], 2),
        "r2_correlation": digits.figure(row["r2_correlation"], 2),
        "mean_error_percent": digits.figure(row["mean_error_percent"], 2),
        "coverage_95": digits.percent(row["coverage_95"]),
    }
    return [(text, row[key]) for key, text in words.items()]


def _differing(row: dict[str, float]) -> list[tuple[str, float]]:
    return [
        (digits.figure(row["rmse"]), row["rmse"]),
        *((_interval(row, key), row[key]) for key in ("bias", "lower_limit", "upper_limit")),
    ]


def _interval(row: dict[str, float], key: str) -> str:
    return digits.with_interval(*(row[f"{key}{part}"] for part in ("", "_low", "_high")))


def _plots(data: xr.Dataset, name: str, output: str, unit: str) -> list[Figure]:
    reference, model = data["reference"].values, data["prediction"].values
    known = data["inside"].values & np.isfinite(reference) & np.isfinite(model)
    reference, model = reference[known], model[known]
    half = (data["high"].values - data["low"].values)[known] / 2.0
    labels = data["case"].values[known].astype(str)
    figures = {
        str(key): float(value)
        for key, value in data.data_vars.items()
        if value.ndim == 0 and np.issubdtype(value.dtype, np.number)
    }
    bars = " Bars: 95 % prediction intervals, cut at the frame." if np.isfinite(half).any() else ""
    return [
        Figure(
            scatter_plot(reference, model, half, labels, figures["slope"], name, output, unit),
            f"{name} against the reference. Dashed: equality; solid: regression through the "
            f"origin.{bars}",
        ),
        Figure(
            difference_plot(reference, model, labels, figures, name, output, unit),
            f"{name} minus the reference, over the mean of both (Bland and Altman 1986). Solid: "
            "bias; dashed: limits of agreement; bands: their 95 % intervals.",
        ),
    ]
