"""Parity and residual plots: predicted values of the surrogate, simulated ones of the solver."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import Panel, group, line, mark, span
from surrogate.report.parity import Parity
from surrogate.report.plot import Column, Plot, column, plot


def parity_plot(
    data: Parity, output: str, unit: str, surrogate: str, *, height: float = 340.0
) -> Plot:
    """Predicted over observed, with the line of equality and 95 % intervals."""
    shown = data.drawn
    reach = np.where(np.isfinite(data.half), data.half, 0.0)
    both = span(data.observed, data.predicted + reach, data.predicted - reach)
    panel = Panel.within(both, both, height=height)
    diagonal = line(
        panel.x(both[0]), panel.y(both[0]), panel.x(both[1]), panel.y(both[1]), "reference"
    )
    bars = [
        line(panel.x(x), panel.y(y - half), panel.x(x), panel.y(y + half), "bar")
        for x, y, half in zip(shown.observed, shown.predicted, shown.half, strict=True)
        if np.isfinite(half)
    ]
    marks = _marks(panel, shown, shown.observed, shown.predicted, unit)
    return plot(
        360,
        height,
        panel.frame(digits.labelled(data.truth, unit), digits.labelled("predicted", unit)),
        diagonal,
        group(*bars),
        group(*marks),
        title=f"{surrogate}: predicted against {data.truth} {output}",
        says=_differences(data, unit),
        numbers=(
            *_which(shown),
            column(digits.labelled(data.truth, unit), shown.observed),
            column(digits.labelled("predicted", unit), shown.predicted),
            column(digits.labelled("half-width of the 95 % interval", unit), shown.half),
        ),
    )


def residual_plot(data: Parity, output: str, unit: str, surrogate: str) -> Plot:
    """Observed minus predicted, over predicted."""
    shown = data.drawn
    panel = Panel.within(
        span(data.predicted), span(data.residual, include=[0.0], pad=0.08), height=340.0
    )
    zero = line(panel.x.start, panel.y(0.0), panel.x.end, panel.y(0.0), "reference")
    marks = _marks(panel, shown, shown.predicted, shown.residual, unit)
    return plot(
        360,
        340,
        panel.frame(
            digits.labelled("predicted", unit),
            digits.labelled(f"{data.truth} minus predicted", unit),
        ),
        zero,
        group(*marks),
        title=f"{surrogate}: residuals of {output}",
        says=_differences(data, unit),
        numbers=(
            *_which(shown),
            column(digits.labelled("predicted", unit), shown.predicted),
            column(digits.labelled(f"{data.truth} minus predicted", unit), shown.residual),
        ),
    )


def _differences(data: Parity, unit: str) -> str:
    """How far predictions are off, of held-out runs and of training runs."""
    said = []
    for kind, which in (("held-out run", ~data.learnt), ("training run", data.learnt)):
        off = data.residual[which]
        if np.isfinite(off).any():
            rms = digits.figure(float(np.sqrt(np.nanmean(off**2))), 2)
            worst = int(np.nanargmax(np.abs(off)))
            largest = digits.with_unit(digits.figure(off[worst], 2), unit)
            said.append(
                f"{digits.quantity(int(which.sum()), kind)}: root mean square difference "
                f"{digits.with_unit(rms, unit)}, largest {largest} at run {data.run[which][worst]}"
            )
    low, high = float(np.nanmin(data.observed)), float(np.nanmax(data.observed))
    values = digits.with_unit(digits.interval(low, high), unit)
    return f"{data.truth.capitalize()} values from {values}. {'; '.join(said)}."


def _which(data: Parity) -> tuple[Column, ...]:
    use = np.where(data.learnt, "training", "held out")
    return column("run", data.run), column("use", use)


def _marks(panel: Panel, data: Parity, x: np.ndarray, y: np.ndarray, unit: str) -> list[Markup]:
    decimals = digits.decimals_of(data.observed, 4)
    return [
        mark(
            "hollow" if data.learnt[k] else "filled",
            panel.x(x[k]),
            panel.y(y[k]),
            data_run=data.run[k],
            data_tip=_tip(data, k, unit, decimals),
        )
        for k in range(len(data.run))
    ]


def _tip(data: Parity, k: int, unit: str, decimals: int) -> str:
    predicted = (
        digits.with_half(data.predicted[k], data.half[k])
        if np.isfinite(data.half[k])
        else digits.fixed(data.predicted[k], decimals)
    )
    return (
        f"{data.truth} {digits.with_unit(digits.fixed(data.observed[k], decimals), unit)}\n"
        f"predicted {digits.with_unit(predicted, unit)}"
    )
