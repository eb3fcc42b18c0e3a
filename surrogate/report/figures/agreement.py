"""Agreement of a model with a reference: the scatter, and the plot of Bland and Altman 1986."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import Panel, group, line, mark, path, span, text
from surrogate.report.plot import Plot, column, plot


def scatter_plot(
    reference: np.ndarray,
    model: np.ndarray,
    half: np.ndarray,
    labels: Sequence[str],
    slope: float,
    name: str,
    output: str,
    unit: str,
) -> Plot:
    """Model over reference with the line of equality and the regression through the origin.

    reference, model (n,), half (n,) of the model's 95 % interval or NaN, labels (n,).
    """
    both = span(reference, model, pad=0.1)
    panel = Panel.within(both, both, height=340.0)
    lines = [
        line(panel.x(both[0]), panel.y(both[0]), panel.x(both[1]), panel.y(both[1]), "reference")
    ]
    if np.isfinite(slope) and slope != 0.0:
        ends = np.clip(np.sort(np.array(both) / slope), *both)
        lines.append(path(zip(panel.x(ends), panel.y(slope * ends), strict=True), "curve"))
    bars = [
        line(
            panel.x(x),
            panel.y(float(np.clip(y - h, *both))),
            panel.x(x),
            panel.y(float(np.clip(y + h, *both))),
            "bar",
        )
        for x, y, h in zip(reference, model, half, strict=True)
        if np.isfinite(h)
    ]
    marks = [
        mark("filled", panel.x(x), panel.y(y), data_tip=_tip(label, x, y, unit))
        for x, y, label in zip(reference, model, labels, strict=True)
    ]
    return plot(
        360,
        340,
        panel.frame(digits.labelled("reference", unit), digits.labelled(name, unit)),
        *lines,
        group(*bars),
        group(*marks),
        title=f"{name} against the reference: {output}",
        says=(
            f"{digits.quantity(len(labels), 'case')}. Regression through the origin has slope "
            f"{digits.figure(slope)}; 1 is agreement."
        ),
        numbers=(
            column("case", labels),
            column(digits.labelled("reference", unit), reference),
            column(digits.labelled(name, unit), model),
            column(digits.labelled("half-width of the 95 % interval", unit), half),
        ),
    )


def difference_plot(
    reference: np.ndarray,
    model: np.ndarray,
    labels: Sequence[str],
    figures: Mapping[str, float],
    name: str,
    output: str,
    unit: str,
) -> Plot:
    """Difference over mean, with bias, limits of agreement and the bands of their intervals."""
    mean, difference = (np.asarray(model) + reference) / 2.0, np.asarray(model) - reference
    levels = {"bias": "curve", "lower_limit": "threshold", "upper_limit": "threshold"}
    ends = [figures[f"{key}_{end}"] for key in levels for end in ("low", "high")]
    panel = Panel.within(
        span(mean),
        span(difference, [figures[key] for key in levels], ends, include=[0.0]),
        height=340.0,
        right=52.0,
    )
    left, right = panel.x.start, panel.x.end
    bands = [
        path(
            [
                (left, panel.y(low)),
                (right, panel.y(low)),
                (right, panel.y(high)),
                (left, panel.y(high)),
            ],
            "band",
            closed=True,
        )
        for low, high in zip(ends[::2], ends[1::2], strict=True)
        if np.isfinite(low) and np.isfinite(high)
    ]
    known = [key for key in levels if np.isfinite(figures[key])]
    printed = dict(zip(known, digits.column([figures[key] for key in known], 3), strict=True))
    lines = [
        part
        for key in known
        for part in (
            path([(left, panel.y(figures[key])), (right, panel.y(figures[key]))], levels[key]),
            text(right + 4, panel.y(figures[key]) + 4, printed[key], "tick"),
        )
    ]
    zero = line(left, panel.y(0.0), right, panel.y(0.0), "reference")
    marks = [
        mark("filled", panel.x(x), panel.y(d), data_tip=_tip(label, r, y, unit))
        for x, d, r, y, label in zip(mean, difference, reference, model, labels, strict=True)
    ]
    return plot(
        360,
        340,
        *bands,
        panel.frame(
            digits.labelled(f"mean of reference and {name}", unit),
            digits.labelled(f"{name} minus reference", unit),
        ),
        zero,
        *lines,
        group(*marks),
        title=f"{name} minus the reference: {output}",
        says=(
            f"{digits.quantity(len(labels), 'case')}. Bias {printed.get('bias', digits.NOTHING)}; "
            f"limits of agreement {printed.get('lower_limit', digits.NOTHING)} and "
            f"{digits.with_unit(printed.get('upper_limit', digits.NOTHING), unit)}."
        ),
        numbers=(
            column("case", labels),
            column(digits.labelled("mean", unit), mean),
            column(digits.labelled("difference", unit), difference),
        ),
    )


def _tip(label: str, reference: float, model: float, unit: str) -> str:
    return (
        f"case {label}\nreference {digits.with_unit(digits.figure(reference, 4), unit)}\n"
        f"model {digits.with_unit(digits.figure(model, 4), unit)}"
    )
