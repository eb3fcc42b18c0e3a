"""What a surrogate says of all cases together: means, and the covariance of its errors.

A regressor that knows the joint law of new runs gives it. The errors of any other are taken as
independent between different points and as equal at the same point: two measurements at the same
known inputs do not make the surrogate better. Errors by Student's law with v degrees of freedom
count as normal with the same variance, v / (v - 2).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError
from surrogate.estimator import has_joint
from surrogate.fitting.fit import Fit

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Emulator:
    """A fit, as the likelihood asks it."""

    fit: Fit

    def predicted(self, points: Array) -> tuple[Array, Array]:
        """Means (w, case), covariances (w, case, case) of the solver at points (w, case, d)."""
        if has_joint(self.fit.estimator):
            mean, found = self.fit.estimator.predict_joint(points)
            return mean, found * self.inflation
        mean, std = self.fit.predict(points.reshape(-1, points.shape[2]), return_std=True)
        std = np.asarray(std).reshape(points.shape[:2])
        same = (np.abs(points[0, :, None] - points[0, None, :]) < 1e-9).all(axis=2)
        found = std[:, :, None] * std[:, None, :] * same * self.inflation
        return np.asarray(mean).reshape(points.shape[:2]), found

    @cached_property
    def inflation(self) -> float:
        """Variance of standardised errors; for v <= 2 the normal law with the same 95 % ends."""
        law = self.fit.error_law
        variance = float(law.var())
        return variance if np.isfinite(variance) else float((law.ppf(0.975) / 1.959964) ** 2)


def check(fit: Fit) -> None:
    """Raise `StudyError` for a surrogate whose error nobody knows."""
    middle = np.zeros((1, fit.space.size))
    if not np.isfinite(fit.predict(middle, return_std=True)[1]).all():
        raise StudyError(
            f"calibration: surrogate '{fit.surrogate}' of '{fit.output}' does not know its error; "
            "add runs or name another surrogate"
        )
