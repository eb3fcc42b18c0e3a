"""Field outputs: where the answer is large, where it varies, where the surrogate is right."""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.blocks import Figure, Figures, Heading, Text, anchor
from surrogate.report.content import Content
from surrogate.report.figures.fields import field_line, field_map
from surrogate.report.parity import rows_learnt


def blocks(content: Content, output: str) -> list:
    """Mean, standard deviation and Q2 at each point; nothing for a single number."""
    if not content.is_field(output):
        return []
    result: list = [Heading("The field", anchor(output, "field"))]
    finished = content.finished(output)
    if not finished.any():
        return [*result, Text("No finished run has this field.", "warning")]
    values = content.values(output)[finished]
    dims = [str(dim) for dim in content.runs[output].dims if dim != "run"]
    if values.ndim > 3:
        return [*result, Text(f"{output} has {len(dims)} dimensions ({', '.join(dims)}); fields of "
                              "more than two are not drawn.", "note")]
    scores, how = point_q2(content, output)
    axes = [_axis(content.runs, dim) for dim in dims]
    draw = _lines if len(dims) == 1 else _maps
    return [*result, Figures(tuple(draw(content, output, values, scores, how, axes)))]


def point_q2(content: Content, output: str) -> tuple[np.ndarray | None, str]:
    """Q2 of the best surrogate at each point of the field, and on which runs; or None.

    On held-out runs where there are at least two, otherwise on the training runs,
    each predicted by a fit without its fold. NaN where the field does not vary.
    """
    best = content.best(output)
    if best is None:
        return None, ""
    fit = content.fits_of(output)[best]
    finished = content.finished(output)
    coded, values = content.coded[finished], content.values(output)[finished]
    held = rows_learnt(fit, coded) < 0
    if held.sum() >= 2:
        return _q2(values[held], fit.predict(coded[held])), f"{best}, on the held-out runs"
    left_out = np.asarray(fit.left_out)
    if np.isfinite(left_out).all():
        return _q2(fit.values, left_out), f"{best}, by cross-validation"
    return None, ""


def _q2(values: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    total = ((values - values.mean(axis=0)) ** 2).sum(axis=0)
    wrong = ((values - np.asarray(predicted)) ** 2).sum(axis=0)
    varies = total > 1e-12 * total.max(initial=0.0)
    return np.where(varies, 1.0 - wrong / np.where(varies, total, 1.0), np.nan)


def _axis(runs: xr.Dataset, dim: str) -> tuple[np.ndarray, str]:
    """Places along a dimension and its label; counted from 0 without numeric coordinates."""
    if dim in runs.coords and np.issubdtype(runs[dim].dtype, np.number):
        unit = runs[dim].attrs.get("units")
        return (np.asarray(runs[dim].values, dtype=float),
                dim if unit is None else digits.labelled(dim, str(unit)))
    return np.arange(runs.sizes[dim], dtype=float), f"{dim} (number)"


def _lines(content, output, values, scores, how, axes) -> list[Figure]:
    (x, x_label), = axes
    unit = digits.labelled(output, content.unit(output))
    mean, spread = values.mean(axis=0), values.std(axis=0)
    figures = [Figure(field_line(x, {"curve": mean}, x_label, unit, f"Mean of {output}",
                                 band=(mean - spread, mean + spread)),
                      f"Mean of {output} over the finished runs, and one standard deviation "
                      "about it.")]
    if scores is not None:
        figures.append(Figure(
            field_line(x, {"curve": scores}, x_label, "Q² (–)", f"Q2 of {output} at each point",
                       y_span=_q2_span(scores)), f"Q² at each point: {how}.{_worst(scores)}"))
    return figures


def _maps(content, output, values, scores, how, axes) -> list[Figure]:
    (y, y_label), (x, x_label) = axes
    unit = digits.unit(content.unit(output)) or digits.NOTHING
    mean, spread = values.mean(axis=0), values.std(axis=0)
    figures = [
        Figure(field_map(x, y, mean, x_label, y_label, unit, f"Mean of {output}"),
               f"Mean of {output} over the finished runs."),
        Figure(field_map(x, y, spread, x_label, y_label, unit, f"Standard deviation of {output}"),
               f"Standard deviation of {output} over the finished runs.")]
    if scores is not None:
        figures.append(Figure(
            field_map(x, y, scores, x_label, y_label, "Q² (–)", f"Q2 of {output} at each point",
                      limits=_q2_span(scores)), f"Q² at each point: {how}.{_worst(scores)}"))
    return figures


def _q2_span(scores: np.ndarray) -> tuple[float, float]:
    lowest = float(np.nanmin(scores)) if np.isfinite(scores).any() else 0.0
    return max(0.0, min(lowest - 0.02, 0.9)), 1.0


def _worst(scores: np.ndarray) -> str:
    known = scores[np.isfinite(scores)]
    if known.size == 0:
        return ""
    poor = digits.percent(float((known < 0.9).mean()))
    return f" Lowest {digits.fixed(known.min(), 3)}; {poor} of the points are below 0.9."
