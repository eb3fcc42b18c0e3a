"""Accuracy of each surrogate of an output: cross-validated, and on held-out runs."""

from __future__ import annotations

from collections.abc import Sequence

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
from surrogate.report.content import POOR_Q2, Content
from surrogate.report.figures.accuracy import accuracy_plot
from surrogate.report.figures.calibration import calibration_plot
from surrogate.report.figures.parity import parity_plot, residual_plot
from surrogate.report.parity import Parity, parity, rows_learnt

#: The design that the comparison holds out.
TEST = "test"


def blocks(content: Content, output: str) -> list[Block]:
    """Comparison table, margin sentence, parity and residuals; nothing if none was asked for."""
    if not content.fits:
        return []
    result: list[Block] = [Heading("Comparison of surrogates", anchor(output, "comparison"))]
    names = list(content.fits_of(output))
    if not names:
        return [*result, Text("No surrogate could be fitted to these runs.", "warning")]
    if content.comparison is not None:
        result += _comparison(content, content.comparison, output, names)
    best = content.best(output) or names[0]
    result += _parities(content, output, best, [name for name in names if name != best])
    return result


def _comparison(content: Content, table: xr.Dataset, output: str, names: list[str]) -> list[Block]:
    rows = {name: content.row(name, output) for name in names}
    cv = [rows[name].get("q2_cv", np.nan) for name in names]
    test = [rows[name].get("q2_test", np.nan) for name in names]
    figures = []
    if np.isfinite([*cv, *test]).any():
        figures.append(
            Figure(
                accuracy_plot(names, cv, test, output),
                "Q² of each surrogate. Open disc: cross-validated; filled disc: on the held-out "
                f"runs. 1 is perfect; 0 is as good as the mean.{_off_scale(cv, test)}",
            )
        )
    figures += _calibration(content, table, output)
    sentence = margin(content, output)
    return [
        *([Text(sentence, "lead")] if sentence else []),
        _table(content, output, rows),
        *([Figures(tuple(figures))] if figures else []),
    ]


def _table(content: Content, output: str, rows: dict[str, dict[str, float]]) -> Table:
    unit = content.unit(output)
    best = content.best(output)
    titles = {
        "q2_cv": "Q² (cross-validated)",
        "rmse_cv": digits.labelled("RMSE, cross-validated", unit),
        "q2_test": "Q² (held-out)",
        "rmse_test": digits.labelled("RMSE, held-out", unit),
        "max_error_test": digits.labelled("largest error, held-out", unit),
        "coverage_95": f"coverage of 95{digits.THIN}% intervals",
        "fit_seconds": "fit time",
        "predict_seconds": "time of 1000 predictions",
    }
    shown = [
        key for key in titles if any(np.isfinite(row.get(key, np.nan)) for row in rows.values())
    ]
    lines = []
    for name, row in rows.items():
        line = [
            Cell(
                f"{name} (best)" if name == best and len(rows) > 1 else name,
                tone="strong" if name == best else "",
            )
        ]
        for key in shown:
            value = row.get(key, np.nan)
            tone = "bad" if key.startswith("q2") and value < POOR_Q2 else ""
            words = (
                digits.duration(value)
                if key.endswith("seconds")
                else digits.percent(value)
                if key == "coverage_95"
                else digits.score(value)
                if key.startswith("q2")
                else digits.figure(value)
            )
            line.append(Cell(words, float(value) if np.isfinite(value) else None, tone))
        lines.append(tuple(line))
    caption = f"Surrogates of {output} on the same folds and the same held-out runs."
    if not _trained_alike(content, output):
        caption = (
            f"Surrogates of {output} on the same held-out runs. Their training designs differ, "
            "so their cross-validated figures do not compare."
        )
    return Table(
        caption,
        (Head("surrogate", numeric=False), *(Head(titles[key]) for key in shown)),
        tuple(lines),
        sortable=len(lines) > 3,
    )


def _off_scale(*scores: Sequence[float]) -> str:
    """What the sign at the left end of the scale means, where it stands."""
    known = np.concatenate([np.asarray(column, dtype=float) for column in scores])
    return " ‹: value below the scale." if (known < 0.0).any() else ""


def _trained_alike(content: Content, output: str) -> bool:
    """Whether all surrogates of an output have the same training design."""
    first, *others = content.fits_of(output).values()
    return all(
        fit.coded.shape == first.coded.shape and np.array_equal(fit.coded, first.coded)
        for fit in others
    )


def margin(content: Content, output: str) -> str:
    """Whether the best surrogate is really ahead of the second; empty for a single one."""
    table = content.comparison
    if (
        table is None
        or "sentence" not in table
        or len(content.fits_of(output)) < 2
        or output not in table["output"].values.astype(str)
    ):
        return ""
    words = digits.squared(str(table["sentence"].sel(output=output).item()))
    words = words.removeprefix(f"{output}: ")
    return digits.capital(words)


def runner_up(content: Content, output: str) -> str:
    """The second best surrogate and how far it is behind: the margin's second sentence."""
    return margin(content, output).partition("). ")[2]


def _calibration(content: Content, table: xr.Dataset, output: str) -> list[Figure]:
    """Coverage of the best surrogate's intervals at each level, when known."""
    best = content.best(output)
    if best is None or "coverage" not in table or not content.row(best, output):
        return []
    observed = np.asarray(table["coverage"].sel(surrogate=best, output=output).values, float)
    if not np.isfinite(observed).any():
        return []
    held = held_out(content, output)
    plot = calibration_plot(table["level"].values, observed, held, f"{best} for {output}")
    return [
        Figure(
            plot,
            f"Calibration of {best}: share of the held-out values inside the prediction "
            "intervals of each level. On the line the intervals are right; below it they are "
            f"too narrow. Within the band, {held} runs show no difference.",
        )
    ]


def held_out(content: Content, output: str) -> int:
    """Number of finished runs that coverage was counted on: those of the test design.

    Of a study without one, the runs in no training design of the output.
    """
    finished = content.finished(output)
    if TEST in content.designs:
        return int((finished & (content.words("design") == TEST)).sum())
    points = content.coded[finished]
    seen = [rows_learnt(fit, points) >= 0 for fit in content.fits_of(output).values()]
    return int((~np.any(seen, axis=0)).sum())


def _parities(content: Content, output: str, best: str, others: list[str]) -> list[Block]:
    unit = content.unit(output)
    data = parity(content, content.fits_of(output)[best], output)
    if data.run.size == 0:
        return [Text("No finished run to compare predictions with.", "warning")]
    what = f"the mean of {output}" if content.is_field(output) else output
    result: list[Block] = [
        Heading("Parity and residuals", anchor(output, "parity")),
        Figures(
            (
                Figure(
                    parity_plot(data, output, unit, best),
                    f"{best}: {what}, predicted against {data.truth}. {_reading(data)}",
                ),
                Figure(
                    residual_plot(data, output, unit, best),
                    f"{best}: residuals ({data.truth} minus predicted). {_pattern(data, unit)}",
                ),
            )
        ),
    ]
    if others:
        figures = []
        for name in others:
            found = parity(content, content.fits_of(output)[name], output)
            figures.append(
                Figure(
                    parity_plot(found, output, unit, name),
                    f"{name}: predicted against {found.truth}. {_reading(found)}",
                )
            )
        which = "surrogate" if len(others) == 1 else f"{len(others)} surrogates"
        result.append(Fold(f"Parity plots of the other {which}", (Figures(tuple(figures)),)))
    return result


def _reading(data: Parity) -> str:
    said = []
    if (~data.learnt).any():
        bars = (
            " with 95 % prediction intervals" if np.isfinite(data.half[~data.learnt]).any() else ""
        )
        held = digits.quantity(int((~data.learnt).sum()), "held-out run")
        said.append(f"Filled: {held}{bars}.")
    if data.learnt.any():
        how = (
            "each predicted by cross-validation"
            if data.honest
            else "as fitted, so closer than new points will be"
        )
        said.append(f"Open: {digits.quantity(int(data.learnt.sum()), 'training run')}, {how}.")
    if data.drawn is not data:
        said.append(f"{len(data.drawn.run)} of these runs are drawn.")
    return " ".join(said)


def _pattern(data: Parity, unit: str) -> str:
    held = ~data.learnt
    chosen = held if held.any() else np.ones(len(held), dtype=bool)
    residual = np.where(chosen, data.residual, np.nan)
    if not np.isfinite(residual).any():
        return ""
    worst = int(np.nanargmax(np.abs(residual)))
    where = "held-out run" if held.any() else "run"
    return (
        f"Largest residual of a {where}: run {data.run[worst]}, "
        f"{digits.with_unit(digits.figure(data.residual[worst]), unit)}."
    )
