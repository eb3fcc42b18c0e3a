"""Observed against predicted values of one fit, run by run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.fitting.fit import Fit
from surrogate.report.content import Content, thinned


@dataclass(frozen=True)
class Parity:
    """Observed and predicted values; a field stands for its mean over its points.

    run (n,) numbers, observed (n,), predicted (n,), half (n,) of the 95 % interval
    or NaN, learnt (n,) whether the fit has seen the run, honest: True when learnt
    runs are predicted by fits without them. truth: how the values were come by.
    """

    run: np.ndarray
    observed: np.ndarray
    predicted: np.ndarray
    half: np.ndarray
    learnt: np.ndarray
    honest: bool
    truth: str = "simulated"

    @property
    def residual(self) -> np.ndarray:
        """Observed minus predicted."""
        return np.asarray(self.observed - self.predicted)

    def only(self, which: np.ndarray) -> Parity:
        """Some of the runs, (n,) of bool."""
        return Parity(
            self.run[which],
            self.observed[which],
            self.predicted[which],
            self.half[which],
            self.learnt[which],
            self.honest,
            self.truth,
        )

    @property
    def drawn(self) -> Parity:
        """The runs that a drawing has room for, see `thinned`."""
        which = thinned(len(self.run))
        return self if which.all() else self.only(which)


def parity(content: Content, fit: Fit, output: str) -> Parity:
    """Every finished run beside what the fit says of it; worked out once for a page.

    Runs that the fit has learnt from are predicted by the fit without their fold,
    because a fit that interpolates is perfect on what it has seen. A run that several designs
    share is shown once.
    """
    key = (id(fit), output)
    if key not in content.known:
        content.known[key] = _parity(content, fit, output)
    found: Parity = content.known[key]
    return found


def _parity(content: Content, fit: Fit, output: str) -> Parity:
    finished = np.flatnonzero(content.finished(output))
    rows = rows_learnt(fit, content.coded[finished])
    shown = rows < 0
    shown[np.unique(rows, return_index=True)[1]] = True
    finished, rows = finished[shown], rows[shown]
    coded, values = content.coded[finished], content.values(output)[finished]
    predicted, half = predictions(fit, coded)
    learnt = rows >= 0
    left_out = np.asarray(fit.left_out)[rows]
    known = learnt & np.isfinite(left_out).reshape(len(rows), -1).all(axis=1)
    predicted = np.where(known.reshape(-1, *[1] * (predicted.ndim - 1)), left_out, predicted)
    bars = np.full(len(rows), np.nan) if half.ndim > 1 else np.where(learnt, np.nan, half)
    return Parity(
        content.numbers[finished],
        mean_over_points(values),
        mean_over_points(predicted),
        bars,
        learnt,
        bool(known[learnt].all()),
        "observed" if content.recorded else "simulated",
    )


def predictions(fit: Fit, coded: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Predicted values (n, ...) and half-widths of their 95 % intervals, NaN when unknown."""
    if len(coded) == 0:
        empty = np.empty((0, *fit.values.shape[1:]))
        return empty, empty
    mean, (half,) = fit.half_widths(coded, (0.95,))
    return mean, np.broadcast_to(half, mean.shape)


def rows_learnt(fit: Fit, coded: np.ndarray) -> np.ndarray:
    """Row of the fit's own points that equals each point (n,), -1 where none does."""
    known = {key: row for row, key in reversed(list(enumerate(_keys(fit.coded))))}
    return np.array([known.get(key, -1) for key in _keys(coded)], dtype=int)


def learnt_only_from(content: Content, design: str) -> list[str]:
    """Surrogates that have seen no run outside this design."""
    points = set(_keys(content.coded[content.words("design") == design]))
    return [
        name
        for name, by_output in content.fits.items()
        if all(points.issuperset(_keys(fit.coded)) for fit in by_output.values())
    ]


def _keys(points: np.ndarray) -> list[bytes]:
    """A key for each point (n, d), the same for points that agree to nine decimals."""
    return [row.tobytes() for row in np.round(np.asarray(points, dtype=float), 9) + 0.0]


def mean_over_points(values: np.ndarray) -> np.ndarray:
    """Mean over the dimensions behind the first, shape (n,)."""
    return values.reshape(len(values), -1).mean(axis=1) if values.size else np.empty(len(values))
