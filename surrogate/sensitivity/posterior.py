"""Draws of functions from the posterior of a Gaussian process."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import linalg
from scipy.stats import qmc

from surrogate.regressors.columns import expand
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.matern import condition, correlation, weighted_sum

#: Places where a draw is fixed exactly; between them and the runs it is interpolated.
ANCHORS = 256
#: Added to the correlations of places with themselves, against rounding.
JITTER = 1e-9


def draws(process: GaussianProcess, size: int, *, seed=0) -> Callable[[np.ndarray], np.ndarray]:
    """`size` functions drawn from the posterior, as one function coded (m, d) -> (m, size).

    The process is drawn jointly at `ANCHORS` places of a Sobol' sequence, given the runs,
    with trend and variance uncertain (Student t; lengths and nugget as fitted), and each
    draw is the kriging mean through runs and anchors (Le Gratiet et al. 2014, section 3.3;
    Chiles and Delfiner 2012, section 7.3, conditioning by kriging).
    """
    generator = np.random.default_rng(seed)
    sequence = qmc.Sobol(process.n_features_in_, scramble=True, rng=generator)
    anchors = expand(2.0 * sequence.random(ANCHORS) - 1.0, process.columns_)
    runs, lengths = process.points_, process.lengths_
    values = _at_anchors(process, anchors, size, generator)
    places = np.vstack([runs, anchors])
    known = np.vstack([np.tile(process.standard_[:, None], size), values])
    matrix = correlation(places, places, lengths)
    matrix[np.diag_indices(len(runs))] += process.nugget_
    matrix[np.diag_indices(len(places))] += JITTER
    F = _trend(process, places)
    # Only the algebra that does not depend on the values is used; one column stands for all.
    state = condition(matrix, F, known[:, 0])
    weights = state.projected @ known
    trend = state.gain @ (F.T @ np.linalg.solve(matrix, known))

    def functions(coded: np.ndarray) -> np.ndarray:
        points = expand(np.asarray(coded, dtype=float), process.columns_)
        standard = _trend(process, points) @ trend + weighted_sum(points, places, lengths, weights)
        return process.offset_ + process.scale_ * standard

    return functions


def _trend(process: GaussianProcess, points: np.ndarray) -> np.ndarray:
    """Trend columns (m, q): ones, and the columns themselves for a linear trend."""
    ones = np.ones((len(points), 1))
    return np.hstack([ones, points]) if process.trend == "linear" else ones


def _at_anchors(process: GaussianProcess, anchors: np.ndarray, size: int, generator):
    """Standardised values (anchor, draw) of the noise-free process given the runs."""
    runs, state = process.points_, process.state_
    cross = correlation(anchors, runs, process.lengths_)
    F = _trend(process, anchors)
    mean = F @ state.trend + cross @ state.weights
    explained = linalg.solve_triangular(state.factor, cross.T, lower=True)
    rest = F - explained.T @ linalg.solve_triangular(state.factor, _trend(process, runs),
                                                     lower=True)
    covariance = (correlation(anchors, anchors, process.lengths_)
                  - explained.T @ explained + rest @ state.gain @ rest.T)
    spread, directions = np.linalg.eigh(covariance)
    root = directions * np.sqrt(np.maximum(spread, 0.0))
    freedom = process.interval_freedom
    scale = np.sqrt(state.variance * freedom / generator.chisquare(freedom, size))
    return mean[:, None] + root @ generator.standard_normal((len(anchors), size)) * scale
