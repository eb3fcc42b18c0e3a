"""Gauss rules: nodes in coded values and weights that sum to 1, for one bounded quantity."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import special

from surrogate.space.distributions import Distribution

Numbers = NDArray[np.float64]
Rule = tuple[Numbers, Numbers]


@lru_cache(maxsize=256)
def legendre(order: int) -> Rule:
    """Nodes and weights of Gauss and Legendre's rule on [-1, 1]; the weights sum to 2."""
    return _shared(special.roots_legendre(order))


@lru_cache(maxsize=256)
def of_law(law: Distribution, order: int) -> Rule:
    """Gauss rule of a bounded law, coded, from Gauss-Legendre panels of the probability.

    The panels halve towards probability 0 and 1, so that narrow laws, long tails and
    densities without a bound are resolved as well as flat ones.
    """
    breaks = np.union1d(np.append(0.0, 0.5 ** np.arange(48.0, 0.0, -1.0)), _kinks(law))
    x, w = legendre(max(16, order))
    half = np.diff(breaks)[:, None] / 2.0
    tail = (breaks[:-1, None] + half + half * x).ravel()
    mass = np.tile((half * w).ravel(), 2)
    lower, upper = law.support
    fine = 2.0 * (np.concatenate([law.ppf(tail), law.isf(tail)]) - lower) / (upper - lower) - 1.0
    return _shared(gauss_rule(fine, mass / mass.sum(), order))


def _shared(rule: Rule) -> Rule:
    """The rule made read-only: it is shared by all who ask."""
    for array in rule:
        array.setflags(write=False)
    return rule


def _kinks(law: Distribution) -> Numbers:
    """Tail probabilities at which the density is not smooth: at the mode of a triangle."""
    mode = dict(law.words).get("mode")
    return np.array([]) if mode is None else np.minimum(law.cdf([mode]), law.sf([mode]))


def gauss_rule(x: Numbers, w: Numbers, order: int) -> Rule:
    """Gauss rule of a discrete measure by Lanczos / Golub and Welsch 1969.

    x, w: nodes and weights of the measure, shape (m,); returns `order` of them.
    """
    alpha, beta = np.zeros(order), np.zeros(order)
    before, now = np.zeros_like(x), np.ones_like(x) / np.sqrt(w.sum())
    for k in range(order):
        alpha[k] = (w * now * now * x).sum()
        after = (x - alpha[k]) * now - (beta[k - 1] * before if k else 0.0)
        beta[k] = np.sqrt((w * after * after).sum())
        before, now = now, after / beta[k]
    jacobi = np.diag(alpha) + np.diag(beta[:-1], 1) + np.diag(beta[:-1], -1)
    nodes, vectors = np.linalg.eigh(jacobi)
    return nodes, vectors[0] ** 2
