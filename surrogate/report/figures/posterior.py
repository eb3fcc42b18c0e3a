"""Posteriors: of one unknown beside its prior, of pairs, and of measurements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from surrogate.report import digits
from surrogate.report.drawing import Panel, line, mark, path, span
from surrogate.report.plot import Plot, column, plot

Array = NDArray[np.float64]

WIDTH, HEIGHT, BINS, POINTS = 360.0, 260.0, 36, 300
#: Ticks of an axis of cases.
TICKS = 10


def marginal_plot(name: str, unit: str, posterior: Array, prior: Array) -> Plot:
    """Densities of draws (draw,) of the posterior, filled, and of the prior, dashed."""
    joined = np.concatenate([posterior, prior])
    start, end = np.quantile(joined, (0.002, 0.998)).tolist()
    edges = np.linspace(start, end, BINS + 1)
    heights = [
        np.histogram(values, edges)[0] / (len(values) * (edges[1] - edges[0]))
        for values in (posterior, prior)
    ]
    panel = Panel.within(
        (float(edges[0]), float(edges[-1])), (0.0, 1.05 * max(map(max, heights))), height=HEIGHT
    )
    low, high = np.quantile(posterior, (0.025, 0.975)).tolist()
    label = digits.labelled(name, unit)
    return plot(
        WIDTH,
        HEIGHT,
        path(_steps(panel, edges, heights[0], closed=True), "band", closed=True),
        panel.frame(label, "density", x_count=4, y_count=3),
        path(_steps(panel, edges, heights[0]), "curve"),
        path(_steps(panel, edges, heights[1]), "curve dashed"),
        title=f"Posterior of {name}",
        says=(
            f"Posterior of {name}: mean {digits.number(float(posterior.mean()), 4)}, 95 % of it "
            f"from {digits.number(low, 4)} to {digits.number(high, 4)} {unit}".rstrip()
            + "."
        ),
        numbers=(
            column(label, 0.5 * (edges[:-1] + edges[1:])),
            column("posterior density", heights[0]),
            column("prior density", heights[1]),
        ),
    )


def _steps(
    panel: Panel, edges: Array, heights: Array, closed: bool = False
) -> list[tuple[float, float]]:
    x, y = np.repeat(edges, 2)[1:-1], np.repeat(heights, 2)
    if closed:
        x, y = np.concatenate([[x[0]], x, [x[-1]]]), np.concatenate([[0.0], y, [0.0]])
    return list(zip(panel.x(x), panel.y(y), strict=True))


def pair_plot(names: tuple[str, str], units: tuple[str, str], drawn: tuple[Array, Array]) -> Plot:
    """Some draws (draw,) of two unknowns."""
    step = max(len(drawn[0]) // POINTS, 1)
    x, y = (values[::step][:POINTS] for values in drawn)
    panel = Panel.within(span(x), span(y), height=HEIGHT, left=56.0)
    labels = [digits.labelled(*pair) for pair in zip(names, units, strict=True)]
    r = float(np.corrcoef(*drawn)[0, 1])
    return plot(
        WIDTH,
        HEIGHT,
        panel.frame(*labels, x_count=4, y_count=4),
        *(mark("filled", panel.x(a), panel.y(b), 1.8) for a, b in zip(x, y, strict=True)),
        title=f"Posterior of {names[0]} and {names[1]}",
        says=f"{len(x)} draws of {names[0]} and {names[1]}; correlation {digits.fixed(r, 2)}.",
        numbers=(column(labels[0], x), column(labels[1], y)),
    )


def _numbered(cases: int) -> list[tuple[float, str]]:
    """Ticks at whole cases, ten at most."""
    step = -(-cases // TICKS)
    return [(float(k), str(k)) for k in range(1, cases + 1, step)]


def predictive_plot(
    output: str,
    unit: str,
    labels: Sequence[str],
    measured: Array,
    replicates: Array,
    solver: Array,
    ran: tuple[NDArray[np.intp], Array] | None = None,
) -> Plot:
    """Measurements (case,), with new ones (draw, case) and the solver's values (draw, case).

    ran: cases (pair,) at which the solver was run, and its values.
    """
    runs = (np.empty(0, dtype=int), np.empty(0)) if ran is None else ran
    at = np.arange(1.0, len(measured) + 1.0)
    low, high = np.quantile(replicates, (0.025, 0.975), axis=0)
    middle = solver.mean(axis=0)
    panel = Panel.within(
        (0.4, len(at) + 0.6), span(low, high, measured, middle, runs[1]), height=300.0, left=56.0
    )
    inside = int(((low <= measured) & (measured <= high)).sum())
    label = digits.labelled(output, unit)
    marks = [
        line(panel.x(k), panel.y(a), panel.x(k), panel.y(b), "stem")
        for k, a, b in zip(at, low, high, strict=True)
    ]
    marks += [mark("cross", panel.x(k), panel.y(v)) for k, v in zip(at, middle, strict=True)]
    marks += [
        mark(
            "hollow",
            panel.x(at[k] + 0.25),
            panel.y(v),
            data_tip=f"run of the solver at a draw of the posterior\n{digits.number(float(v), 4)}",
        )
        for k, v in zip(*runs, strict=True)
    ]
    marks += [
        mark(
            "filled",
            panel.x(k),
            panel.y(v),
            data_tip=f"case {name}\nmeasured {digits.number(float(v), 4)}",
        )
        for k, v, name in zip(at, measured, labels, strict=True)
    ]
    return plot(
        WIDTH,
        300.0,
        panel.frame("case, in the order of the file", label, x_ticks=_numbered(len(at))),
        *marks,
        title=f"Measurements and posterior of {output}",
        says=f"{inside} of {len(at)} measurements lie inside the 95 % interval of a new one.",
        numbers=(
            column("case", list(labels)),
            column(f"measured {label}", measured),
            column("new measurement, 2.5 %", low),
            column("new measurement, 97.5 %", high),
            column("solver, mean", middle),
        ),
    )
