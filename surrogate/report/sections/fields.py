"""Field outputs: mean, standard deviation and accuracy at each point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import Block, Figure, Figures, Heading, Text, anchor
from surrogate.report.content import Content
from surrogate.report.figures.fields import field_line, field_map
from surrogate.report.parity import rows_learnt
from surrogate.report.plot import Plot


def blocks(content: Content, output: str) -> list[Block]:
    """Mean, standard deviation and Q2 at each point; nothing for a single number."""
    if not content.is_field(output):
        return []
    result: list[Block] = [Heading("The field", anchor(output, "field"))]
    finished = content.finished(output)
    if not finished.any():
        return [*result, Text("No finished run has this field.", "warning")]
    values = content.values(output)[finished]
    dims = [str(dim) for dim in content.runs[output].dims if dim != "run"]
    if values.ndim > 3:
        return [
            *result,
            Text(
                f"{output} has {len(dims)} dimensions ({', '.join(dims)}); fields of "
                "more than two are not drawn.",
                "note",
            ),
        ]
    axes = [_axis(content.runs, dim) for dim in dims]
    draw = _lines if len(dims) == 1 else _maps
    return [*result, Figures(tuple(draw(content, output, values, judged(content, output), axes)))]


#: Places along a dimension, and its label.
Axis = tuple[np.ndarray, str]


@dataclass(frozen=True)
class Judged:
    """Fields of held-out (or left-out) runs, and the best surrogate's predictions of them.

    run (n,) numbers, values and predicted (n, ...), how: which surrogate, on which runs.
    """

    run: np.ndarray
    values: np.ndarray
    predicted: np.ndarray
    how: str

    @property
    def q2(self) -> np.ndarray:
        """Q2 at each point of the field; NaN where the field does not vary."""
        return _q2(self.values, self.predicted)

    @property
    def worst(self) -> int:
        """Row of the largest root mean square error."""
        errors = (self.values - self.predicted).reshape(len(self.run), -1)
        return int((errors**2).mean(axis=1).argmax())


def judged(content: Content, output: str) -> Judged | None:
    """Held-out runs where there are two, otherwise cross-validation; or None."""
    best = content.best(output)
    if best is None:
        return None
    fit = content.fits_of(output)[best]
    finished = content.finished(output)
    numbers, coded, values = (
        part[finished] for part in (content.numbers, content.coded, content.values(output))
    )
    rows = rows_learnt(fit, coded)
    held = rows < 0
    if held.sum() >= 2:
        return Judged(
            numbers[held],
            values[held],
            np.asarray(fit.predict(coded[held])),
            f"{best}, on {held.sum()} held-out runs",
        )
    if (~held).any() and np.isfinite(fit.left_out).all():
        return Judged(
            numbers[~held],
            values[~held],
            np.asarray(fit.left_out)[rows[~held]],
            f"{best}, by cross-validation",
        )
    return None


def _q2(values: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    total = ((values - values.mean(axis=0)) ** 2).sum(axis=0)
    wrong = ((values - np.asarray(predicted)) ** 2).sum(axis=0)
    varies = total > 1e-12 * total.max(initial=0.0)
    return np.where(varies, 1.0 - wrong / np.where(varies, total, 1.0), np.nan)


def _axis(runs: xr.Dataset, dim: str) -> Axis:
    """Places along a dimension and its label; counted from 0 without numeric coordinates."""
    if dim in runs.coords and np.issubdtype(runs[dim].dtype, np.number):
        unit = runs[dim].attrs.get("units")
        return (
            np.asarray(runs[dim].values, dtype=float),
            dim if unit is None else digits.labelled(dim, str(unit)),
        )
    return np.arange(runs.sizes[dim], dtype=float), f"{dim} (number)"


def _lines(
    content: Content, output: str, values: np.ndarray, seen: Judged | None, axes: list[Axis]
) -> list[Figure]:
    ((x, x_label),) = axes
    label = digits.labelled(output, content.unit(output))
    mean, spread = values.mean(axis=0), values.std(axis=0)
    figures = [
        Figure(
            field_line(
                x,
                {"mean": mean},
                x_label,
                label,
                f"Mean of {output}",
                band=(mean - spread, mean + spread),
            ),
            f"Mean of {output} over the finished runs; band: ± one standard deviation.",
        )
    ]
    if seen is None:
        return figures
    k = seen.worst
    curves = {"simulated": seen.values[k], "predicted": seen.predicted[k]}
    return [
        *figures,
        Figure(
            field_line(
                x,
                {"Q²": seen.q2},
                x_label,
                "Q² (–)",
                f"Q² of {output} at each point",
                y_span=_q2_span(seen.q2),
            ),
            f"Q² at each point: {seen.how}.{_worst(seen.q2)}",
        ),
        Figure(
            field_line(x, curves, x_label, label, f"Worst run of {output}"),
            f"Run {seen.run[k]}, which has the largest error: simulated (solid) and predicted "
            f"(dashed); {seen.how}.",
        ),
    ]


def _maps(
    content: Content, output: str, values: np.ndarray, seen: Judged | None, axes: list[Axis]
) -> list[Figure]:
    (y, y_label), (x, x_label) = axes
    unit = digits.unit(content.unit(output)) or digits.NOTHING

    def draw(
        field: np.ndarray, key: str, what: str, limits: tuple[float, float] | None = None
    ) -> Plot:
        return field_map(x, y, field, x_label, y_label, key, f"{what} of {output}", limits=limits)

    figures = [
        Figure(
            draw(values.mean(axis=0), unit, "Mean"), f"Mean of {output} over the finished runs."
        ),
        Figure(
            draw(values.std(axis=0), unit, "Standard deviation"),
            f"Standard deviation of {output} over the finished runs.",
        ),
    ]
    if seen is None:
        return figures
    k = seen.worst
    missed = np.abs(seen.values[k] - seen.predicted[k])
    return [
        *figures,
        Figure(
            draw(seen.q2, "Q² (–)", "Q² at each point", _q2_span(seen.q2)),
            f"Q² at each point: {seen.how}.{_worst(seen.q2)}",
        ),
        Figure(
            draw(missed, unit, "Largest errors", (0.0, float(missed.max()) or 1.0)),
            f"Run {seen.run[k]}, which has the largest error: absolute error at each point; "
            f"{seen.how}.",
        ),
    ]


def _q2_span(scores: np.ndarray) -> tuple[float, float]:
    lowest = float(np.nanmin(scores)) if np.isfinite(scores).any() else 0.0
    return max(0.0, min(lowest - 0.02, 0.9)), 1.0


def _worst(scores: np.ndarray) -> str:
    known = scores[np.isfinite(scores)]
    if known.size == 0:
        return ""
    poor = digits.percent(float((known < 0.9).mean()))
    return f" Lowest {digits.fixed(known.min(), 3)}; {poor} of the points are below 0.9."
