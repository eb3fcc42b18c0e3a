"""What the variance that a surrogate misses allows: how far an index of the solver can lie.

The square root of an unscaled index, such as sqrt(E[Var(f | x_~i)]), is a seminorm of f: of
total, first-order, closed and second-order indices, and of Shapley effects, which are sums of
such squares. With f = surrogate + rest, the rest holding the share m = 1 - Q2 of Var f, and
e = sqrt(m), an index I of the surrogate and J of the solver keep

    sqrt(J) <= (1 + e) sqrt(I) + e   and   sqrt(I) <= (1 + e) sqrt(J) + e

up to terms of e^2 in the second, where the shares of f and of the surrogate change roles.
"""

from __future__ import annotations

import numpy as np

from surrogate.estimator import Array


def largest(index: Array, missed: float) -> Array:
    """Largest index that the solver can have when its surrogate has this one; at most 1."""
    e = np.sqrt(np.clip(missed, 0.0, 1.0))
    root = np.sqrt(np.maximum(index, 0.0))
    return np.asarray(np.minimum((root * (1.0 + e) + e) ** 2, 1.0))


def smallest(index: Array, missed: float) -> Array:
    """Smallest index that the solver can have when its surrogate has this one; at least 0."""
    e = np.sqrt(np.clip(missed, 0.0, 1.0))
    root = np.sqrt(np.maximum(index, 0.0))
    return np.asarray(np.maximum((root - e) / (1.0 + e), 0.0) ** 2)
