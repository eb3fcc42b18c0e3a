"""Warnings: what a reader must know before using a figure, a sentence each."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.content import POOR_COVERAGE, POOR_Q2, Content
from surrogate.report.parity import learnt_only_from
from surrogate.report.sections.designs import roman
from surrogate.report.sections.indices import refusal


def warnings(content: Content) -> list[str]:
    """The warnings of a study; none when all is well."""
    said = []
    failed = int(content.failed.sum())
    if failed:
        of = digits.quantity(len(content.ok), "run")
        said.append(f"{failed} of {of} failed and are not used for training; see Runs.")
        said += [content.failing] if content.failing else []
    missing = int(content.missing.sum())
    if missing:
        said.append(
            f"{digits.quantity(missing, 'run')} of the designs "
            f"{'is' if missing == 1 else 'are'} not done yet."
        )
    said += content.not_done
    said += [words for name in content.outputs if (words := uneven(content, name))]
    said += [loud(content, name) for name in content.noise]
    said += [f"{one.sentence}." for one in content.suspicious.values()]
    for output in content.outputs:
        said += [*_poor(content, output), *_saturated(content, output)]
        said += [words] if (words := refusal(content, output)) else []
    for design, aliasing in content.aliasing.items():
        names = learnt_only_from(content, design)
        if aliasing.resolution == 3 and names:
            said.append(
                f"Design {design}, the training design of "
                f"{'surrogate' if len(names) == 1 else 'surrogates'} {digits.listing(names)}, has "
                f"resolution {roman(3)}: main effects are aliased with two-factor interactions."
            )
    return said


def uneven(content: Content, output: str) -> str:
    """A sentence when the scatter of replicates depends on the place; "" otherwise."""
    scatter = content.replicates.get(output)
    if scatter is None or not scatter.uneven:
        return ""
    low, high = (digits.figure(std, 2) for std in (scatter.smallest, scatter.largest))
    unit = content.unit(output)
    return (
        f"The scatter of {output} depends on the place: its replicates have standard deviations "
        f"from {low} to {digits.with_unit(high, unit)} (Brown-Forsythe test, "
        f"p = {digits.figure(scatter.p, 2)}). The intervals, which take it to be the same "
        "everywhere, are too wide at some places and too narrow at others."
    )


def loud(content: Content, output: str) -> str:
    """How much of an output is noise, what helps, and what its learning curve says of more runs."""
    words = f"{content.noise[output].sentence}."
    table, best = content.learning, content.best(output)
    if table is not None and best in table["surrogate"] and output in table["output"]:
        curve = str(table["sentence"].sel(surrogate=best, output=output).item()).splitlines()
        words += "".join(f" Learning curve: {one}." for one in curve[:1])
    return digits.squared(words)


def _poor(content: Content, output: str) -> list[str]:
    best = content.best(output)
    if best is None:
        return [f"No surrogate of {output} could be fitted."] if content.fits else []
    said, q2 = [], content.q2(best, output)
    if np.isfinite(q2) and q2 < POOR_Q2:
        said.append(
            f"The best surrogate of {output}, {best}, has a Q² of only {digits.fixed(q2, 2)}, "
            f"below {POOR_Q2:g}: its predictions are rough."
        )
    coverage = content.row(best, output).get("coverage_95", np.nan)
    if coverage < POOR_COVERAGE:
        said.append(
            f"The 95{digits.THIN}% intervals of {best} contain only "
            f"{digits.percent(coverage)} of the held-out values of {output}: they are too "
            "narrow."
        )
    return said


def _saturated(content: Content, output: str) -> list[str]:
    names = [
        name
        for name, by_output in content.regression.items()
        if output in by_output and _no_freedom(by_output[output])
    ]
    return (
        [
            f"{digits.listing(names)} of {output}: saturated, as many coefficients as runs. R² and "
            "residuals say nothing."
        ]
        if names
        else []
    )


def _no_freedom(table: xr.Dataset) -> bool:
    if "df_residual" in table:
        return float(table["df_residual"]) == 0.0
    return not np.isfinite(float(table["residual_sd"])) if "residual_sd" in table else False
