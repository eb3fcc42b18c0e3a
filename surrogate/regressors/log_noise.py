"""The logarithm of the noise variance at repeated points, for noise that depends on the place.

Of n normal runs at a point with variance sigma^2, s^2 has f = n - 1 degrees of freedom and
log s^2 the mean log sigma^2 + psi(f / 2) - log(f / 2) (Bartlett and Kendall 1946, J. R. Stat. Soc.
Suppl. 8, 128; psi the digamma function). Without this mean it is an unbiased, scattered value
of log sigma^2, and a Gaussian process through such values gives log sigma^2 everywhere
(stochastic kriging: Ankenman, Nelson and Staum 2010, doi 10.1287/opre.1090.0754, section 3.2;
Binois, Gramacy and Ludkovski 2018, doi 10.1080/10618600.2018.1458625, learn both at once).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import special

Array = NDArray[np.float64]

#: Repeated points that tell how noise depends on the place.
FEWEST = 5
#: Smallest s^2 as a share of the pooled one: replicates that agree to rounding.
SMALLEST = 1e-4


def log_variances(points: Array, values: Array) -> tuple[Array, Array]:
    """Repeated points (k, c) among the runs' points (n, c), and log sigma^2 (k,) at them.

    Raises ValueError for fewer than `FEWEST` repeated points, and where replicates agree.
    """
    own, point, count = np.unique(
        np.round(points, 9), axis=0, return_inverse=True, return_counts=True
    )
    point = point.ravel()
    means = np.bincount(point, values) / count
    squares = np.bincount(point, (values - means[point]) ** 2)
    repeated = count > 1
    if repeated.sum() < FEWEST:
        raise ValueError(
            f"noise: replicates needs at least {FEWEST} points that were run more than once, "
            f"but there are {repeated.sum()}; run points again (replicates: 3), or take "
            "noise: equal"
        )
    freedom, squares = count[repeated] - 1.0, squares[repeated]
    pooled = squares.sum() / freedom.sum()
    if not pooled > 1e-24 * float(np.abs(values).max(initial=0.0)) ** 2:
        raise ValueError(
            "noise: replicates finds no noise, for runs at one point agree; take noise: equal"
        )
    logs = np.log(np.maximum(squares / freedom, SMALLEST * pooled))
    return own[repeated], logs - special.digamma(freedom / 2.0) + np.log(freedom / 2.0)
