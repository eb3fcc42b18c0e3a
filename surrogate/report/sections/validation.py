"""Surrogates and other models beside cases that none of them has seen."""

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
    Points,
    Section,
    Table,
    Text,
    anchor,
)
from surrogate.report.content import Content
from surrogate.report.figures.agreement import difference_plot, scatter_plot

#: From this many models on, drawings of all but the first ones are folded.
SHOWN = 4
HEADS = ("model", "cases", "slope", "R² (1 − SSE/SST)", "R² (correlation)", "mean error (%)",
         "RMSE", "bias", "lower limit of agreement", "upper limit of agreement",
         "in its 95 % intervals")
WITH_UNIT = ("RMSE", "bias", "lower limit of agreement", "upper limit of agreement")
MEANING = (
    "Slope: of the regression through the origin, reference on x, model on y. R² as 1 − SSE/SST "
    "compares the errors of the model as it stands with the scatter of the reference about its "
    "mean; it is negative when the mean would do better. R² as squared correlation is blind to "
    "scale and offset. Errors are model minus reference; mean error: their mean in percent of "
    "each reference; bias: their mean; limits of agreement: bias ∓ 1.96 standard deviations, "
    "between which 95 % of differences are expected (Bland and Altman 1986). Intervals of the "
    "limits: {how}. Last column: share of the reference values inside the surrogate's own "
    "95 % intervals.")


def section(content: Content) -> Section:
    """Which cases, which were set aside, and for each output the figures and the plots."""
    data = content.validation
    blocks: list = [Text(_cases(data))]
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
        words += (f"; {int((~inside).sum())} of them outside the ranges of the study's parameters "
                  "and set aside: no figure is drawn from there.")
    if "subject" in data:
        subjects = len(np.unique(data["subject"].values[inside]))
        words += (f" They come from {digits.quantity(subjects, 'subject')}; limits of agreement "
                  "count the scatter within and between subjects, the interval of the slope "
                  "takes all cases for independent.")
    return words


def verdicts(content: Content) -> list[tuple[str, str, str]]:
    """(output, the closest model in a few words, how close) of each output with figures."""
    found = []
    for output in content.validation["output"].values.astype(str):
        data = content.validation.sel(output=output)
        names = [name for name in data["model"].values.astype(str)
                 if np.isfinite(data["lower_limit"].sel(model=name))]
        if names:
            best = min(names, key=lambda name: float(data["rmse"].sel(model=name)))
            row = {key: float(data[key].sel(model=best)) for key in
                   ("bias", "lower_limit", "upper_limit", "n")}
            unit = str(data["units"].item())
            limits = digits.interval(row["lower_limit"], row["upper_limit"])
            bias = digits.with_unit(digits.figure(row["bias"], 2), unit)
            found.append((output, f"{best}, bias {bias}", (
                f"95 % of its differences from {content.validation.attrs['cases']} are expected "
                f"at {digits.with_unit(limits, unit)} ({row['n']:.0f} cases).")))
    return found


def _aside(data: xr.Dataset, rows: np.ndarray) -> Fold:
    table = Table("Cases outside, and the ranges of the study in brackets.",
                  (Head("case", numeric=False), Head("outside", numeric=False)),
                  tuple((Cell(str(data["case"].values[k])), Cell(str(data["outside"].values[k])))
                        for k in rows))
    return Fold(f"{digits.quantity(len(rows), 'case')} set aside", (table,), open=len(rows) <= 10)


def _blocks(data: xr.Dataset, output: str) -> list:
    unit = str(data["units"].item())
    names = [name for name in data["model"].values.astype(str)
             if data["n"].sel(model=name) >= 1]
    heading = Heading(digits.labelled(output, unit), anchor("validation", output))
    if not names:
        return [heading, Text("No case lies inside the ranges of the study, so nothing can be "
                              "compared.", "warning")]
    ranked = sorted(names, key=lambda name: float(data["rmse"].sel(model=name)))
    figures = [[Figure(*pair) for pair in _plots(data.sel(model=name), name, output, unit)]
               for name in ranked]
    shown = [figure for pair in figures[:SHOWN] for figure in pair]
    how = "delta method" if "subject" in data else "noncentral t, exact for normal differences"
    blocks = [heading, _table(data, names, ranked[0], unit), Figures(tuple(shown)),
              Fold("What the figures are", (Text(MEANING.format(how=how)),), open=True)]
    if figures[SHOWN:]:
        more = digits.quantity(len(figures) - SHOWN, "further model")
        blocks.append(Fold(f"Plots of {more}", (Figures(tuple(
            figure for pair in figures[SHOWN:] for figure in pair)),)))
    return blocks


def _table(data: xr.Dataset, names: list[str], best: str, unit: str) -> Table:
    rows = []
    for name in names:
        row = {key: float(value) for key, value in data.sel(model=name).data_vars.items()
               if value.ndim == 0 and np.issubdtype(value.dtype, np.number)}
        rows.append(_row(row, name, name == best))
    heads = tuple(Head(digits.labelled(word, unit) if word in WITH_UNIT else word, numeric=k > 0)
                  for k, word in enumerate(HEADS))
    return Table("Each model beside the reference; 95 % intervals in brackets. The smallest RMSE "
                 "is set strong.", heads, tuple(rows), sortable=len(rows) > 2, wide=True)


def _row(row: dict[str, float], name: str, best: bool) -> tuple[Cell, ...]:
    words = (
        (name, None), (f"{row['n']:.0f}", row["n"]),
        (digits.with_interval(row["slope"], row["slope_low"], row["slope_high"]), row["slope"]),
        (digits.figure(row["r2"], 2), row["r2"]),
        (digits.figure(row["r2_correlation"], 2), row["r2_correlation"]),
        (digits.figure(row["mean_error_percent"], 2), row["mean_error_percent"]),
        (digits.figure(row["rmse"]), row["rmse"]),
        (digits.with_interval(row["bias"], row["bias_low"], row["bias_high"]), row["bias"]),
        *((digits.with_interval(*(row[f"{end}_limit{part}"] for part in ("", "_low", "_high"))),
           row[f"{end}_limit"]) for end in ("lower", "upper")),
        (digits.percent(row["coverage_95"]), row["coverage_95"]))
    return tuple(Cell(word, value if value is not None and np.isfinite(value) else None,
                      "strong" if best and k == 0 else "")
                 for k, (word, value) in enumerate(words))


def _plots(data: xr.Dataset, name: str, output: str, unit: str) -> list:
    reference, model = data["reference"].values, data["prediction"].values
    known = data["inside"].values & np.isfinite(reference) & np.isfinite(model)
    reference, model = reference[known], model[known]
    half = (data["high"].values - data["low"].values)[known] / 2.0
    labels = data["case"].values[known].astype(str)
    figures = {str(key): float(value) for key, value in data.data_vars.items() if value.ndim == 0
               and np.issubdtype(value.dtype, np.number)}
    bars = " Bars are its 95 % intervals, cut at the frame." if np.isfinite(half).any() else ""
    return [
        (scatter_plot(reference, model, half, labels, figures["slope"], name, output, unit),
         f"{name} over the reference. Dashed: equality; solid: regression through the "
         f"origin.{bars}"),
        (difference_plot(reference, model, labels, figures, name, output, unit),
         f"{name} minus the reference, over the mean of both (Bland and Altman 1986). Solid: bias; "
         "dashed: limits of agreement; bands: their 95 % intervals.")]
