"""Sentences about a polynomial: how well it fits, what tests say, which runs move it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import xarray as xr

from surrogate.errors import FitError
from surrogate.regressors.regression import nested
from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.parity import rows_learnt

#: Beginnings of the table's own notes that the page says in its own words.
SAID_ELSEWHERE = ("The solver is deterministic", "The fit is saturated")
#: Beyond these a run moves the fit by itself (Cook and Weisberg 1982), or is far off it.
LARGE_COOK, LARGE_STUDENTISED = 1.0, 3.0
#: Runs named in a sentence.
NAMED = 6


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
    if table.attrs.get("transformation"):
        low, high = get["box_cox_low"], get["box_cox_high"]
        powers = f"power {low:.2f}" if low == high else f"powers {low:.2f} to {high:.2f}"
        said.append(
            f"Box and Cox: these terms describe {table.attrs['transformation']} better than y "
            f"({powers})."
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
