"""Effects: regression tables of the polynomials and response curves of the best surrogate."""

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
    Table,
    Text,
    anchor,
)
from surrogate.report.content import Content
from surrogate.report.figures.coefficients import MOST, coefficient_plot
from surrogate.report.figures.half_normal import half_normal_plot
from surrogate.report.figures.slices import slice_plots
from surrogate.report.sections import goodness, side_by_side, stationary
from surrogate.report.sections.side_by_side import printed

DETERMINISTIC = (
    "The solver is deterministic, so the residuals are not noise. Standard errors, p-values and "
    "intervals measure the lack of fit of the polynomial, not the evidence for an effect."
)


def blocks(content: Content, output: str) -> list[Block]:
    """Regression tables, then response curves."""
    result: list[Block] = []
    tables = {
        name: by_output[output]
        for name, by_output in content.regression.items()
        if output in by_output
    }
    if tables:
        result.append(Heading("Effects", anchor(output, "effects")))
        if content.deterministic:
            result.append(Text(DETERMINISTIC, "note"))
        result += [Text(words) for words in goodness.comparisons(content, output, list(tables))]
        beside = side_by_side.table(content, output) if len(tables) > 1 else None
        result += [beside] if beside else []
    for place, (name, table) in enumerate(tables.items()):
        inside = _regression(content, output, name, table)
        fold = Fold(
            f"{name}: {digits.quantity(table.sizes['term'], 'term')}",
            tuple(inside),
            open=place == 0,
        )
        result.append(fold)
    return [*result, *_slices(content, output)]


def _regression(content: Content, output: str, name: str, table: xr.Dataset) -> list[Block]:
    unit = content.unit(output)
    terms = [str(term) for term in table["term"].values]
    columns = {
        key: np.asarray(table[key].values, dtype=float) for key in ("coefficient", "low", "high")
    }
    effects = [k for k, term in enumerate(terms) if term != "1"]
    said = [*goodness.sentences(table, unit), *goodness.influence(content, output, name, table)]
    parts: list[Block] = [Points(tuple(said))]
    known = [k for k in effects if np.isfinite(columns["coefficient"][k])]
    if known:
        more = f" The {MOST} largest of {len(known)}." if len(known) > MOST else ""
        confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
        intervals = np.isfinite(columns["low"][known]).any()
        reading = (
            f"with {confidence} intervals; filled where zero lies outside the interval"
            if intervals
            else "without intervals, because there are no residual degrees of freedom"
        )
        parts.append(
            Figures(
                (
                    Figure(
                        coefficient_plot(
                            [printed(terms[k]) for k in known],
                            columns["coefficient"][known],
                            columns["low"][known],
                            columns["high"][known],
                            unit,
                            name,
                        ),
                        f"Coefficients of {name} per coded unit (half the change of {output} from "
                        f"the smallest to the largest value), {reading}.{more}",
                    ),
                )
            )
        )
    parts += _half_normal(table, terms, unit, name)
    return [*parts, _table(table, terms, unit, name), *stationary.blocks(content, output, name)]


def _half_normal(table: xr.Dataset, terms: list[str], unit: str, name: str) -> list[Block]:
    """Which effects stand out where nothing else can test them."""
    if "lenth_margin" not in table:
        return []
    value = np.asarray(table["coefficient"].values, dtype=float)
    shown = [k for k, term in enumerate(terms) if term != "1" and np.isfinite(value[k])]
    pse, margin = float(table["lenth_pse"]), float(table["lenth_margin"])
    words = [printed(terms[k]) for k in shown]
    drawing = half_normal_plot(words, value[shown], pse, margin, unit, name)
    active = [printed(terms[k]) for k in shown if abs(value[k]) > margin]
    said = (
        f"active: {digits.listing(active, goodness.NAMED)}"
        if active
        else "no coefficient is active"
    )
    return [
        Text(
            f"No run is left to test by. By Lenth's method, beyond a margin of "
            f"{digits.with_unit(digits.figure(margin, 2), unit)}, {said}."
        ),
        Figures(
            (
                Figure(
                    drawing,
                    "Coefficients that are noise lie about the line through zero; those beyond "
                    "the dashed margin are active (Lenth 1989).",
                ),
            )
        ),
    ]


def _table(table: xr.Dataset, terms: list[str], unit: str, name: str) -> Table:
    get = {
        key: np.asarray(table[key].values, dtype=float)
        if key in table
        else np.full(len(terms), np.nan)
        for key in ("coefficient", "standard_error", "t", "p", "low", "high", "vif")
    }
    rows = []
    for k, term in enumerate(terms):
        value = get["coefficient"][k]
        rows.append(
            (
                Cell(printed(term), term),
                _number(_matching(value, get["standard_error"][k]), value),
                _number(digits.figure(get["standard_error"][k], 2), get["standard_error"][k]),
                _number(digits.figure(get["t"][k]), get["t"][k]),
                _number(digits.p_value(get["p"][k]), get["p"][k]),
                _number(digits.interval(get["low"][k], get["high"][k]), get["low"][k]),
                _number(digits.fixed(get["vif"][k], 2), get["vif"][k]),
            )
        )
    confidence = digits.percent(float(table.attrs.get("confidence", 0.95)))
    titles = (
        "term",
        digits.labelled("coefficient", unit),
        "standard error",
        "t",
        "p",
        f"{confidence} interval",
        "VIF",
    )
    return Table(
        f"Regression table of {name}; coefficients per coded unit.",
        tuple(Head(title, numeric=k > 0) for k, title in enumerate(titles)),
        tuple(rows),
        sortable=len(rows) > 3,
    )


def _matching(value: float, error: float) -> str:
    """The coefficient with the decimals that its standard error (two digits) deserves."""
    if not (np.isfinite(value) and np.isfinite(error) and error > 1e-12 * abs(value)):
        return digits.figure(value, 4)
    return digits.with_half(value, error).split(" ± ")[0]


def _number(words: str, value: float) -> Cell:
    return Cell(words, float(value) if np.isfinite(value) else None)


def _slices(content: Content, output: str) -> list[Block]:
    best = content.best(output)
    if best is None:
        return []
    fit = content.fits_of(output)[best]
    what = f"mean {output}" if content.is_field(output) else output
    plots = slice_plots(fit, content.space, content.unit(output), what)
    figures = tuple(Figure(plot, "") for _, plot in plots)
    return [
        Heading("Response curves", anchor(output, "curves")),
        Text(
            f"{best} over each parameter, the others at the middle of their ranges. Band: 95 % "
            "prediction interval, where the surrogate has one. All curves share one scale."
        ),
        Figures(figures, small=True),
    ]
