"""Total Sobol' indices as weighted sums of the output, to first order in its errors.

With A and B independent samples and A_i that with column i from B, the total index is
(Jansen 1999; Saltelli et al. 2010, Comput. Phys. Commun. 181, 259-270, table 2)

    T_i = V_i / V,   V_i = mean (f(A) - f(A_i))^2 / 2,   V = mean (f(A) - f)^2.

An error e of the surrogate moves it by the delta method by

    dT_i = [mean (f(A) - f(A_i)) (e(A) - e(A_i)) - 2 T_i mean (f(A) - f) e(A)] / V,

a weighted sum of e at A and all A_i. So its variance, and what a further run takes from it,
follow from the covariance of the Gaussian process (`variance.taken`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Points of A.
PAIRS = 128


def total_index_weights(
    process: GaussianProcess, space: Space, *, pairs: int = PAIRS, seed: int = 0
) -> tuple[Array, Array]:
    """Coded points ((d + 1) pairs, d), and weights (points, d) of what the indices move by.

    Of independent parameters. Weights are zero for an output that does not vary.
    """
    d = space.size
    u = np.random.default_rng(seed).random((pairs, 2 * d))
    first = u[:, :d]
    mixed = [first]
    for i in range(d):
        other = first.copy()
        other[:, i] = u[:, d + i]
        mixed.append(other)
    points = np.vstack([space.snap(space.quantile(one)) for one in mixed])
    values = process.predict(points).reshape(d + 1, pairs)
    away = values[0] - values[0].mean()
    whole = float((away**2).mean())
    weights = np.zeros((d + 1, pairs, d))
    if whole > 0.0:
        for i in range(d):
            moved = values[0] - values[i + 1]
            total = 0.5 * float((moved**2).mean()) / whole
            weights[0, :, i] = (moved - 2.0 * total * away) / (pairs * whole)
            weights[i + 1, :, i] = -moved / (pairs * whole)
    return points, weights.reshape(-1, d)
