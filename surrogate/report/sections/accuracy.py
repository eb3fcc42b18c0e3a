"""How good each surrogate of an output is, on runs that it has not seen."""

from __future__ import annotations

import numpy as np

from surrogate.report import digits
from surrogate.report.blocks import Cell, Figure, Figures, Fold, Head, Heading, Table, Text, anchor
from surrogate.report.content import POOR_Q2, Content
from surrogate.report.figures.accuracy import accuracy_plot
from surrogate.report.figures.parity import parity_plot, residual_plot
from surrogate.report.parity import Parity, parity


def blocks(content: Content, output: str) -> list:
    """Comparison table, margin sentence, parity and residuals."""
    result: list = [Heading("Comparison of surrogates", anchor(output, "comparison"))]
    names = list(content.fits_of(output))
    if not names:
        return [*result, Text("No surrogate could be fitted to these runs.", "warning")]
    if content.comparison is not None:
        result += _comparison(content, output, names)
    result += _parities(content, output, names)
    return result


def _comparison(content: Content, output: str, names: list[str]) -> list:
    rows = {name: content.row(name, output) for name in names}
    cv = [rows[name].get("q2_cv", np.nan) for name in names]
    test = [rows[name].get("q2_test", np.nan) for name in names]
    figures = []
    if np.isfinite([*cv, *test]).any():
        figures.append(Figure(
            accuracy_plot(names, cv, test, output),
            "Q² of each surrogate: open disc by cross-validation, filled disc on the held-out "
            "runs. 1 is perfect, 0 is no better than the mean."))
    sentence = margin(content, output)
    return [*([Text(sentence, "lead")] if sentence else []), _table(content, output, rows),
            *([Figures(tuple(figures))] if figures else [])]


def _table(content: Content, output: str, rows: dict[str, dict[str, float]]) -> Table:
    unit = content.unit(output)
    best = content.best(output)
    scales = {"q2_cv": 3, "q2_test": 3, "coverage_95": 3}
    titles = {"q2_cv": "Q² cross-validated",
              "rmse_cv": digits.labelled("RMSE cross-validated", unit),
              "q2_test": "Q² held out", "rmse_test": digits.labelled("RMSE held out", unit),
              "max_error_test": digits.labelled("largest error held out", unit),
              "coverage_95": "coverage of 95 % intervals",
              "fit_seconds": "fit time", "predict_seconds": "prediction time"}
    shown = [key for key in titles
             if any(np.isfinite(row.get(key, np.nan)) for row in rows.values())]
    lines = []
    for name, row in rows.items():
        line = [Cell(f"{name} (best)" if name == best and len(rows) > 1 else name,
                     tone="strong" if name == best else "")]
        for key in shown:
            value = row.get(key, np.nan)
            tone = "bad" if key.startswith("q2") and value < POOR_Q2 else ""
            words = (digits.duration(value) if key.endswith("seconds")
                     else digits.percent(value) if key == "coverage_95"
                     else digits.fixed(value, scales[key]) if key in scales
                     else digits.figure(value))
            line.append(Cell(words, float(value) if np.isfinite(value) else None, tone))
        lines.append(tuple(line))
    caption = f"Surrogates of {output} on the same folds and the same held-out runs."
    return Table(caption, (Head("surrogate", numeric=False), *(Head(titles[key]) for key in shown)),
                 tuple(lines), sortable=len(lines) > 3)


def margin(content: Content, output: str) -> str:
    """Whether the best surrogate is really ahead of the second."""
    best, table = content.best(output), content.comparison
    if table is None or best is None or len(content.fits_of(output)) < 2:
        return ""
    found = {key: _scalar(table, key, output) for key in ("margin", "margin_scatter")}
    if not np.isfinite(found["margin"]):
        return f"{best} is the best surrogate of {output}."
    ahead = digits.figure(found["margin"], 2)
    if not np.isfinite(found["margin_scatter"]):
        return f"{best} is best, ahead by {ahead} in Q²."
    scatter = digits.figure(found["margin_scatter"], 2)
    if found["margin"] > found["margin_scatter"]:
        return (f"{best} is best: ahead by {ahead} in Q², more than the scatter from fold to fold "
                f"({scatter}).")
    return (f"{best} is best only by name: it is ahead by {ahead} in Q², which is not more than "
            f"the scatter from fold to fold ({scatter}). Prefer the simpler one.")


def _scalar(table, key: str, output: str) -> float:
    if key in table.attrs:
        return float(table.attrs[key])
    if key in table and table[key].dims == ("output",):
        return float(table[key].sel(output=output))
    return np.nan


def _parities(content: Content, output: str, names: list[str]) -> list:
    best = content.best(output)
    others = [name for name in names if name != best]
    unit = content.unit(output)
    data = parity(content, content.fits_of(output)[best], output)
    if data.run.size == 0:
        return [Text("No finished run to compare predictions with.", "warning")]
    what = f"the mean of {output}" if content.is_field(output) else output
    result: list = [
        Heading("Parity and residuals", anchor(output, "parity")),
        Figures((Figure(parity_plot(data, output, unit, best),
                        f"{best}: {what}, surrogate over solver. {_reading(data)}"),
                 Figure(residual_plot(data, output, unit, best),
                        f"{best}: what the surrogate misses. {_pattern(data, unit)}")))]
    if others:
        figures = []
        for name in others:
            found = parity(content, content.fits_of(output)[name], output)
            figures.append(Figure(parity_plot(found, output, unit, name),
                                  f"{name}: surrogate over solver. {_reading(found)}"))
        result.append(Fold(f"Parity of the other {digits.quantity(len(others), 'surrogate')}",
                           (Figures(tuple(figures)),)))
    return result


def _reading(data: Parity) -> str:
    said = []
    if (~data.learnt).any():
        bars = " with 95 % intervals" if np.isfinite(data.half[~data.learnt]).any() else ""
        said.append(f"Filled: {digits.quantity(int((~data.learnt).sum()), 'held-out run')}{bars}.")
    if data.learnt.any():
        how = ("each predicted without itself" if data.honest
               else "learnt from, so closer than new points will be")
        said.append(f"Open: {digits.quantity(int(data.learnt.sum()), 'training run')}, {how}.")
    return " ".join(said)


def _pattern(data: Parity, unit: str) -> str:
    held = ~data.learnt
    chosen = held if held.any() else np.ones(len(held), dtype=bool)
    residual = np.where(chosen, data.residual, np.nan)
    if not np.isfinite(residual).any():
        return ""
    worst = int(np.nanargmax(np.abs(residual)))
    where = "held-out run" if held.any() else "run"
    return (f"The worst {where} is {data.run[worst]}: "
            f"{digits.with_unit(digits.figure(data.residual[worst]), unit)}.")
