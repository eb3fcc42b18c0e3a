"""How an output answers to its leading inputs, all on one scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surrogate.fitting.fit import Fit
from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, line, path, shortened, span, text, width_of
from surrogate.report.figures.slices import centre
from surrogate.report.parity import mean_over_points
from surrogate.report.plot import Plot, column, plot
from surrogate.space.space import Space

POINTS = 41
#: Curves that can be told apart; each has a colour and a dash of its own.
MOST = 4
HEIGHT = 310.0
#: Distance of two names at the right end of their curves.
APART = 14.0
#: Coded values of an input, in words.
PLACES = ((-1.0, "smallest"), (0.0, "middle"), (1.0, "largest"))


def response_plot(fit: Fit, space: Space, names: Sequence[str], unit: str, output: str) -> Plot:
    """The surrogate along each of these parameters, the others in the middle of their ranges.

    A field output is shown by its mean over its points; a categorical parameter is left out.
    """
    shown = [name for name in names if not space[name].categorical][:MOST]
    places = np.linspace(-1.0, 1.0, POINTS)
    curves = {name: _curve(fit, space, name, places) for name in shown}
    right = min(96.0, max((width_of(name) for name in shown), default=20.0) + 12.0)
    panel = Panel.within((-1.0, 1.0), span(*curves.values()), right=right, height=HEIGHT)
    ends = _spread([panel.y(float(curve[-1])) for curve in curves.values()])
    marks = []
    for k, (name, curve) in enumerate(curves.items()):
        marks.append(path(zip(panel.x(places), panel.y(curve), strict=True), f"response r{k}"))
        at, end = panel.x.end, panel.y(float(curve[-1]))
        marks.append(line(at, end, at + 6, ends[k], f"leader r{k}"))
        marks.append(text(at + 8, ends[k] + 4, shortened(name, right - 8), f"name r{k}"))
    told = [
        f"along {name} from {digits.figure(float(curve[0]))} to "
        f"{digits.with_unit(digits.figure(float(curve[-1])), unit)}"
        for name, curve in curves.items()
    ]
    return plot(
        WIDTH,
        HEIGHT,
        panel.frame(
            "value of the input", digits.labelled(shortened(output, 170), unit), x_ticks=PLACES
        ),
        *marks,
        title=f"Response of {output} to its leading inputs",
        says=f"{output} {'; '.join(told)}; the other inputs in the middle of their ranges.",
        numbers=(
            column("coded value of the input", places),
            *(column(f"along {name}", curve) for name, curve in curves.items()),
        ),
    )


def _curve(fit: Fit, space: Space, name: str, places: np.ndarray) -> np.ndarray:
    coded = np.tile(centre(space), (len(places), 1))
    parameter = space[name]
    reach = places if parameter.bounded else 0.98 * places
    coded[:, list(space.names).index(name)] = (
        reach
        if parameter.allowed is None
        else parameter.allowed[np.abs(parameter.allowed[None] - reach[:, None]).argmin(axis=1)]
    )
    mean = fit.predict(coded)
    return mean_over_points(mean) if mean.ndim > 1 else mean


def _spread(at: list[float]) -> list[float]:
    """Places moved down until no two are closer than the height of a name."""
    moved = list(at)
    last = -np.inf
    for k in np.argsort(at, kind="stable"):
        moved[k] = max(at[k], last + APART)
        last = moved[k]
    return moved
