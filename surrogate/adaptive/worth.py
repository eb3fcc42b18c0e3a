"""What a run at a candidate is worth, for each aim."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive.aim import ACCURACY, INDEX_WIDTH, OPTIMUM, TARGET, Aim
from surrogate.adaptive.contour import contour_improvement
from surrogate.adaptive.expected_feasibility import expected_feasibility
from surrogate.adaptive.expected_improvement import expected_improvement
from surrogate.adaptive.index_variance import total_index_weights
from surrogate.adaptive.variance import taken
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Points over which a variance is averaged.
REFERENCE = 300


class Worth:
    """The acquisition function of an aim, given a process of each output."""

    def __init__(
        self, aim: Aim, space: Space, processes: Mapping[str, GaussianProcess], seed: int = 0
    ) -> None:
        self.aim, self.space, self.processes, self.seed = aim, space, processes, seed

    def of(self, X: Array) -> Array:
        """Worth (m,) of coded points X (m, d)."""
        if self.aim.kind == ACCURACY:
            return self._mean(lambda one: taken(one, X, self._reference) / one.scale_**2)
        if self.aim.kind == INDEX_WIDTH:
            weights = self._weights
            return self._mean(lambda one: taken(one, X, *weights[id(one)]).sum(axis=1))
        (process,) = self.processes.values()
        mean, deviation = prediction(process, X)
        if self.aim.kind == OPTIMUM:
            return expected_improvement(self.aim.sign * mean, deviation, self.best)
        if self.aim.kind == TARGET:
            return contour_improvement(mean, deviation, self.aim.value)
        return expected_feasibility(mean, deviation, self.aim.value)

    def _mean(self, of_one: Callable[[GaussianProcess], Array]) -> Array:
        """Mean over the outputs that vary."""
        varying = [one for one in self.processes.values() if one.scale_ > 0.0]
        return np.asarray(np.mean([of_one(one) for one in varying], axis=0))

    @cached_property
    def best(self) -> float:
        """Least prediction at a run of sign times the output."""
        (process,) = self.processes.values()
        return float((self.aim.sign * at_runs(process)).min())

    @cached_property
    def _reference(self) -> Array:
        return self.space.sample(REFERENCE, seed=self.seed)

    @cached_property
    def _weights(self) -> dict[int, tuple[Array, Array]]:
        return {
            id(one): total_index_weights(one, self.space, seed=self.seed)
            for one in self.processes.values()
        }


def prediction(process: GaussianProcess, X: Array) -> tuple[Array, Array]:
    """Mean and deviation (m,) of the process itself, without the scatter of a run."""
    mean, deviation = process.predict(X, return_std=True)
    scatter = process.variance_ * process.nugget_
    return mean, np.sqrt(np.maximum(deviation**2 - scatter, 0.0))


def at_runs(process: GaussianProcess) -> Array:
    """Predictions (n,) at the runs that the process is given: y - nugget (its weight)."""
    fitted = process.standard_ - process.nugget_ * process.weights_
    return np.asarray(process.offset_ + process.scale_ * fitted)
