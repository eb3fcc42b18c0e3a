"""Search for the most probable lengths and nugget, for one output or many of the same runs.

A guess costs one factorisation, whatever the number of outputs that it is judged for. So
many guesses are judged first; outputs are then searched for one after another, each from
the best place seen so far, and the places that a search visits are judged for all outputs.
An output that is not searched for takes the best place seen.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize
from scipy.stats import qmc

from surrogate.regressors.likelihood import Posterior

Array = NDArray[np.float64]

#: Guesses judged before a search, the lengths that they lie between, and their largest nugget.
GUESSES, LIKELY, LIKELY_NUGGET = 64, (0.2, 10.0), 1.0


def guesses(bounds: Array, seed: int) -> Array:
    """Space-filling guesses (GUESSES + 1, c + 1), a middling one first.

    bounds (c + 1, 2) of log lengths and log nugget.
    """
    rows = qmc.Sobol(len(bounds), seed=seed).random(GUESSES)
    nugget = np.minimum(bounds[-1:], [[np.inf, np.log(LIKELY_NUGGET)]])
    low, high = np.vstack([np.tile(np.log(LIKELY), (len(bounds) - 1, 1)), nugget]).T
    middling = np.append(np.full(len(bounds) - 1, np.log(2.0)), np.log(1e-4))
    return np.asarray(np.clip(np.vstack([middling, low + rows * (high - low)]), *bounds.T))


class Search:
    """Places tried so far, and their -2 log posterior for each output."""

    def __init__(self, posterior: Posterior, bounds: Array) -> None:
        self.posterior, self.bounds = posterior, bounds
        self.places: list[Array] = []
        self.deviances: list[Array] = []

    def judge(self, places: Array) -> None:
        """Try places (k, c + 1) for all outputs; a single one is where a search starts anyway."""
        if len(places) == 1:
            return self._keep(places[0], np.full(self.posterior.y.shape[1], np.inf))
        for logs in places:
            self._value(logs, None)

    def descend(self, output: int, starts: int, end: float) -> None:
        """Local searches for one output, from the best places seen.

        end  relative change of the deviance at which a search ends
        """
        for start in self._best(output, starts):
            optimize.minimize(
                self._value,
                start,
                (output,),
                jac=True,
                method="L-BFGS-B",
                bounds=optimize.Bounds(*self.bounds.T),
                options={"maxiter": 200, "ftol": end},
            )

    def found(self) -> Array:
        """The best place of each output, (outputs, c + 1)."""
        return np.array([self._best(k, 1)[0] for k in range(self.posterior.y.shape[1])])

    def _best(self, output: int, count: int) -> Array:
        values = np.array([deviance[output] for deviance in self.deviances])
        return np.array(self.places)[np.argsort(values, kind="stable")[:count]]

    def _value(self, logs: Array, output: int | None) -> tuple[float, Array]:
        """-2 log posterior and gradient of one output; the place is kept."""
        outputs = self.posterior.y.shape[1]
        try:
            here = self.posterior.at(logs)
        except linalg.LinAlgError:
            self._keep(logs, np.full(outputs, 1e10))
            return 1e10, np.zeros_like(logs)
        deviances = here.deviances
        self._keep(logs, deviances)
        if output is None:
            return 0.0, np.zeros_like(logs)
        return float(deviances[output]), here.gradient(output)

    def _keep(self, logs: Array, deviances: Array) -> None:
        self.places.append(logs.copy())
        self.deviances.append(deviances)
