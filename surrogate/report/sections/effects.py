"""Effects: regression tables of the polynomials and response curves of the best surrogate."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import xarray as xr

from surrogate.errors import FitError
from surrogate.regressors.regression import nested
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
from surrogate.report.figures.slices import slice_plots
from surrogate.report.parity import rows_learnt
from surrogate.report.sections import side_by_side
from surrogate.report.sections.side_by_side import printed

DETERMINISTIC = (
    "The solver is deterministic, so the residuals are not noise. Standard errors, p-values and "
    "intervals measure the lack of fit of the polynomial, not the evidence for an effect."
)

#: Beginnings of the table's own notes that the page says in its own words.
SAID_ELSEWHERE = ("The solver is deterministic", "The fit is saturated")
#: Beyond these a run moves the fit by itself (Cook and Weisberg 1982), or is far off it.
LARGE_COOK, LARGE_STUDENTISED = 1.0, 3.0
#: Runs named in a sentence.
NAMED = 6


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
        result += [Text(words) for words in comparisons(content, output, list(tables))]
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
    said = [*sentences(table, unit), *influence(content, output, name, table)]
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
    return [*parts, _table(table, terms, unit, name)]


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


def sentences(table: xr.Dataset, unit: str) -> list[str]:
    """Goodness of fit, F test and lack of fit of a polynomial."""
    get = {str(key): float(value) for key, value in table.data_vars.items() if value.ndim == 0}
    said = [_fit_sentence(get, unit)]
    if get.get("df_residual", np.nan) == 0.0 or not np.isfinite(get.get("residual_sd", np.nan)):
        said.append(
            "The model is saturated: as many coefficients as runs. It passes through every run, "
            "so R² says nothing and there are no intervals."
        )
    elif np.isfinite(get.get("f", np.nan)):
        said.append(
            f"F test against the mean: F = {digits.figure(get['f'])}, "
            f"p {_equals(get.get('f_p', np.nan))}."
        )
    if np.isfinite(get.get("lack_of_fit_p", np.nan)):
        poor = get["lack_of_fit_p"] < 0.05
        said.append(
            f"Lack of fit against the replicates: F = {digits.figure(get['lack_of_fit_f'])}, "
            f"p {_equals(get['lack_of_fit_p'])}; "
            + ("significant, so terms are missing." if poor else "not significant.")
        )
    notes = str(table.attrs.get("notes", "")).splitlines()
    return said + [note for note in notes if note and not note.startswith(SAID_ELSEWHERE)]


def influence(content: Content, output: str, name: str, table: xr.Dataset) -> list[str]:
    """Runs that move the polynomial by themselves, and runs far off it, by number."""
    fit = content.fits_of(output).get(name)
    if fit is None or not {"cooks_distance", "studentised_external"} <= set(table.data_vars):
        return []
    number: dict[int, str] = {}
    for run, row in zip(content.numbers, rows_learnt(fit, content.coded), strict=True):
        number.setdefault(int(row), str(run))  # of designs that share a run, the first
    said = []
    for key, limit, words in (
        (
            "cooks_distance",
            LARGE_COOK,
            "Cook's distance above 1 (influential)",
        ),
        (
            "studentised_external",
            LARGE_STUDENTISED,
            "externally studentised residual above 3 (outlying)",
        ),
    ):
        sizes = np.abs(np.asarray(table[key].values, dtype=float))
        large = [k for k in np.argsort(-np.nan_to_num(sizes)) if sizes[k] > limit]
        if large:
            runs = digits.listing([number.get(int(k), "unknown") for k in large], NAMED)
            said.append(f"{'Run' if len(large) == 1 else 'Runs'} {runs}: {words}.")
    return said


def comparisons(content: Content, output: str, names: list[str]) -> list[str]:
    """F tests of each larger polynomial against the next smaller one of the same runs."""
    models = [
        (name, fit.estimator.model_)
        for name in names
        if (fit := content.fits_of(output).get(name)) and hasattr(fit.estimator, "model_")
    ]
    models.sort(key=lambda pair: len(pair[1].names))
    said = []
    for (small, fewer), (large, more) in pairwise(models):
        try:
            test = nested(fewer, more)
        except FitError:
            continue  # other runs, or other terms: nothing to test
        if np.isfinite(test.p):
            verb = "is" if test.df_terms == 1 else "are"
            verdict = "significant" if test.p < 0.05 else "not significant"
            terms = digits.quantity(test.df_terms, "additional term")
            said.append(
                f"{large} against {small}: the {terms} {verb} {verdict} "
                f"(F = {digits.figure(test.f)}, p {_equals(test.p)})."
            )
    return said


def _fit_sentence(get: dict[str, float], unit: str) -> str:
    parts = [
        f"{label} = {digits.score(get[key])}"
        for key, label in (("r2", "R²"), ("r2_adjusted", "adjusted R²"), ("q2", "leave-one-out Q²"))
        if np.isfinite(get.get(key, np.nan))
    ]
    if np.isfinite(get.get("residual_sd", np.nan)):
        spread = digits.with_unit(digits.figure(get["residual_sd"], 2), unit)
        parts.append(f"residual standard deviation {spread}")
    if np.isfinite(get.get("press", np.nan)):
        squared = f"({unit})²" if unit else ""
        parts.append(f"PRESS {digits.with_unit(digits.figure(get['press']), squared)}")
    if np.isfinite(get.get("aicc", np.nan)):
        parts.append(f"AICc {digits.figure(get['aicc'], 4)}")
    return (", ".join(parts) or "No measure of fit exists") + "."


def _equals(p: float) -> str:
    words = digits.p_value(p)
    return words if words.startswith("<") else f"= {words}"


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
