"""Where a quadratic is stationary: maximum, minimum or saddle, and the best way from the centre."""

from __future__ import annotations

import numpy as np

from surrogate.regressors.canonical import Canonical
from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Fold, Head, Table, Text
from surrogate.report.content import Content

#: Distances from the centre, in coded units, at which the ridge is shown.
RADII = (0.25, 0.5, 0.75, 1.0)
KINDS = {
    "maximum": "a maximum",
    "minimum": "a minimum",
    "saddle": "a saddle: in some directions the output rises, in others it falls",
    "ridge": "on a ridge: along at least one axis the runs cannot tell whether the output bends",
}


def blocks(content: Content, output: str, name: str) -> list[Block]:
    """A sentence, the axes, and the ridge; nothing unless the surrogate is a full quadratic."""
    fit = content.fits_of(output).get(name)
    found = fit.estimator.canonical() if fit and hasattr(fit.estimator, "canonical") else None
    if found is None or len(found.parameters) != content.space.size:
        return []
    unit = content.unit(output)
    constant = float(fit.predict(np.zeros((1, content.space.size)))[0]) if fit else np.nan
    inside = (_axes(content, found, unit), _ridge(content, found, constant, output))
    return [Text(sentence(content, found, constant, output)), Fold("Canonical analysis", inside)]


def sentence(content: Content, found: Canonical, constant: float, output: str) -> str:
    """Kind and place of the stationary point, in physical values where it is inside."""
    kind = KINDS[found.kind]
    if not found.inside:
        far = np.abs(found.stationary).max()
        return (
            f"The stationary point is {kind}; it lies outside of the ranges (coded values up to "
            f"{digits.figure(far, 2)}), where the polynomial was not fitted."
        )
    value = digits.with_unit(
        digits.figure(constant + found.at(found.stationary)), content.unit(output)
    )
    return f"The stationary point, {_place(content, found.stationary)}, is {kind}; {value} there."


def _place(content: Content, coded: np.ndarray) -> str:
    physical = content.space.decode(coded[None])
    return ", ".join(
        f"{p.name} {digits.with_unit(digits.figure(float(physical[p.name][0])), p.unit)}"
        for p in content.space.parameters
    )


def _axes(content: Content, found: Canonical, unit: str) -> Table:
    names = content.space.names
    rows = [
        (
            Cell(str(k + 1)),
            Cell(digits.with_half(found.values[k], found.errors[k]), float(found.values[k])),
            *(Cell(digits.fixed(part, 2), float(part)) for part in found.axes[:, k]),
        )
        for k in range(len(found.values))
    ]
    return Table(
        "Axes of the quadratic: curvature along each with its interval, and the axis in coded "
        "parameters.",
        (
            Head("axis", numeric=False),
            Head(digits.labelled("eigenvalue", unit)),
            *(Head(name) for name in names),
        ),
        tuple(rows),
    )


def _ridge(content: Content, found: Canonical, constant: float, output: str) -> Table:
    rows = []
    for largest in (True, False):
        for radius in RADII:
            point = found.ridge(radius, largest=largest)
            physical = content.space.decode(point[None])
            rows.append(
                (
                    Cell("largest" if largest else "smallest"),
                    Cell(digits.figure(radius, 2), radius),
                    Cell(digits.figure(constant + found.at(point))),
                    *(Cell(digits.figure(float(physical[n][0]))) for n in content.space.names),
                )
            )
    units = [digits.labelled(p.name, p.unit) for p in content.space.parameters]
    return Table(
        "Ridge analysis: where the polynomial is largest and smallest at a distance from the "
        "centre of the ranges, in coded units.",
        (
            Head("value", numeric=False),
            Head("distance"),
            Head(digits.labelled(output, content.unit(output))),
            *(Head(name) for name in units),
        ),
        tuple(rows),
    )
