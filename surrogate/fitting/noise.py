"""Noise: the part of an output's variance that no model of its inputs predicts.

Replicates show it as their pure error s^2. Without them the nugget of a Gaussian process stands
for it, which cannot tell noise from what changes too fast for the runs. With V the variance of
single runs and MSE the mean square error of their predictions, the mean answer has the variance
V - s^2, of which the surrogate misses MSE - s^2:

    Q2 of the mean = 1 - (MSE - s^2) / (V - s^2)

This is the Q2 that indices of the mean answer need: of single runs none exceeds 1 - s^2 / V.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from surrogate.fitting.fit import Fit
from surrogate.fitting.replicates import Replicates, replicates
from surrogate.regressors.fitted_process import FittedProcess
from surrogate.space.units import dimensionless

#: Share of the variance from which noise is told: above it no surrogate reaches the Q2 of 0.7
#: that indices need.
LOUD = 0.3


@dataclass(frozen=True)
class Noise:
    """The noise of one output.

    share     of the variance of its training runs
    std       standard deviation, in the output's unit
    points    with replicates, which show it; 0 where it is the nugget of `surrogate`
    sentence  what it means, and what helps
    """

    share: float
    std: float
    points: int
    surrogate: str
    sentence: str


def noise(output: str, unit: str, fits: Iterable[Fit], scatter: Replicates | None) -> Noise | None:
    """The noise of an output by its replicates, else by its best process; None when it is low.

    fits: of the output, all surrogates
    """
    known = [fit for fit in fits if fit.values.ndim == 1 and float(fit.values.var()) > 0.0]
    if not known:
        return None
    variance = float(_best(known).values.var(ddof=1))
    if scatter is not None:
        share = min(scatter.std**2 / variance, 1.0)
        told = _shown(output, unit, share, scatter)
        return Noise(share, scatter.std, scatter.points, "", told) if share > LOUD else None
    processes = [fit for fit in known if isinstance(fit.estimator, FittedProcess)]
    if not processes:
        return None
    one = _best(processes)
    assert isinstance(one.estimator, FittedProcess)
    std = math.sqrt(one.estimator.nugget_ * one.estimator.variance_)
    share = min(std**2 / float(one.values.var(ddof=1)), 1.0)
    if not share > LOUD:
        return None
    return Noise(share, std, 0, one.surrogate, _guessed(output, unit, share, std, one.surrogate))


def _best(fits: Iterable[Fit]) -> Fit:
    """The fit of largest Q2; one without a Q2 comes last."""
    return max(fits, key=lambda fit: -math.inf if math.isnan(fit.q2) else fit.q2)


def q2_of_mean(fit: Fit) -> float | None:
    """Cross-validated Q2 of the mean answer; None where the runs of a fit show no noise.

    The missed share is one standard error larger than estimated, as MSE^2 2 / n and
    s^4 2 / freedom are the variances of MSE and s^2.
    """
    scatter = replicates(fit.coded, fit.values) if fit.values.ndim == 1 else None
    if scatter is None or not math.isfinite(fit.q2):
        return None
    mse, pure, n = fit.rmse**2, scatter.std**2, len(fit.values)
    signal = float(fit.values.var()) - pure
    if not signal > 0.0:
        return min(fit.q2, 0.0)
    error = math.sqrt(2.0 * mse**2 / n + 2.0 * pure**2 / scatter.freedom)
    return max(fit.q2, 1.0 - (max(mse - pure, 0.0) + error) / signal)


def _shown(output: str, unit: str, share: float, scatter: Replicates) -> str:
    return (
        f"{_start(output, unit, share, scatter.std)} by {scatter.points} points with replicates). "
        f"{_limit(share)} More replicates and more points both bring the mean answer nearer: "
        "four times the runs halve what the noise adds to its error"
    )


def _guessed(output: str, unit: str, share: float, std: float, surrogate: str) -> str:
    return (
        f"{_start(output, unit, share, std)} by the nugget of {surrogate}). {_limit(share)} Run "
        "some points several times: equal answers show that the output changes faster than "
        "these runs can follow, and more of them help; different ones are noise, whose size the "
        "replicates tell, so that indices of the mean answer are judged without it"
    )


def _start(output: str, unit: str, share: float, std: float) -> str:
    named = "" if dimensionless(unit) else f" {unit}"
    return (
        f"About {100.0 * share:.0f} % of the variance of {output} looks like noise (standard "
        f"deviation {std:.3g}{named},"
    )


def _limit(share: float) -> str:
    return f"No surrogate predicts single runs with a Q2 above {1.0 - share:.2f}."
