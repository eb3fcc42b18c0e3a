"""Laws fitted to a column of data: by likelihood, compared by AICc; and the data's own law.

Of k constants fitted to n values, Hurvich and Tsai 1989 (Biometrika 76, 297) compare laws by

    AICc = -2 ln L + 2 k + 2 k (k + 1) / (n - k - 1)

The smallest is the best. Beside it stands the statistic of Kolmogorov and Smirnov, the
largest distance between the law's probabilities and those of the data.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import optimize, special, stats

from surrogate.errors import StudyError
from surrogate.space.distributions import UNBOUNDED, Distribution, distribution
from surrogate.space.laws import Range

Array = NDArray[np.float64]
#: Different values below which no law is fitted.
FEWEST = 8


@dataclass(frozen=True)
class FittedLaw:
    """A law fitted to data.

    name          of the law
    distribution  the law
    aicc          its criterion; inf when there are too few values for its constants
    ks            largest distance between its probabilities and the data's
    """

    name: str
    distribution: Distribution
    aicc: float
    ks: float


def fitted_laws(values: ArrayLike) -> list[FittedLaw]:
    """Laws fitted to values (n,), the best first; raises `StudyError` for too few of them."""
    x = _checked(values)
    found = []
    for name, (fit, constants) in _LAWS.items():
        words = fit(x)
        if words is None:
            continue
        law = distribution(name, **words)
        found.append(FittedLaw(name, law, _aicc(law, x, constants), _distance(law, x)))
    return sorted(found, key=lambda one: one.aicc)


def _checked(values: ArrayLike) -> Array:
    x = np.asarray(values, dtype=float)
    x = np.asarray(x[np.isfinite(x)], dtype=float)
    different = len(np.unique(x))
    if different < FEWEST:
        raise StudyError(
            f"a law needs {FEWEST} different values to be fitted to, the data have {different}; "
            "write the distribution, or a range"
        )
    return x


def _distance(law: Distribution, x: Array) -> float:
    """The statistic of Kolmogorov and Smirnov."""
    probability = law.cdf(np.sort(x))
    below = np.arange(len(x)) / len(x)
    return float(np.max(np.maximum(probability - below, below + 1.0 / len(x) - probability)))


def _aicc(law: Distribution, x: Array, constants: int) -> float:
    spare = len(x) - constants - 1
    density = law.pdf(x)
    if spare <= 0 or not (density > 0).all():
        return math.inf
    correction = 2 * constants * (constants + 1) / spare
    return float(-2.0 * np.log(density).sum() + 2 * constants + correction)


def _normal(x: Array) -> dict[str, Any]:
    return {"mean": float(x.mean()), "std": float(x.std())}


def _lognormal(x: Array) -> dict[str, Any] | None:
    if x.min() <= 0:
        return None
    mean, variance = float(np.log(x).mean()), float(np.log(x).var())
    middle = math.exp(mean + variance / 2.0)
    return {"mean": middle, "std": middle * math.sqrt(math.expm1(variance))}


def _uniform(x: Array) -> dict[str, Any]:
    return {"range": (float(x.min()), float(x.max()))}


def _triangular(x: Array) -> dict[str, Any]:
    """Ends just beyond the data: the likelihood vanishes when a value lies on an end."""
    shape, lower, width = stats.triang.fit(x)
    margin = (x.max() - x.min()) / len(x)
    ends = (min(lower, x.min() - margin), max(lower + width, x.max() + margin))
    mode = float(np.clip(lower + shape * width, *ends))
    return {"mode": mode, "range": (float(ends[0]), float(ends[1]))}


def _weibull(x: Array) -> dict[str, Any] | None:
    if x.min() <= 0:
        return None
    # Of the largest likelihood: 1/c = sum x^c ln x / sum x^c - mean ln x (Cohen 1965).
    logs = np.log(x / x.max())

    def excess(c: float) -> float:
        weights = np.exp(c * logs)
        return float(weights @ logs / weights.sum() - logs.mean() - 1.0 / c)

    shape = float(optimize.brentq(excess, 1e-3, 1e3))
    return {"c": shape, "scale": float(x.max() * np.exp(shape * logs).mean() ** (1.0 / shape))}


def _gamma(x: Array) -> dict[str, Any] | None:
    if x.min() <= 0:
        return None
    shape, _, scale = stats.gamma.fit(x, floc=0.0)
    return {"a": float(shape), "scale": float(scale)}


def _beta(x: Array) -> dict[str, Any]:
    """Between ends one mean gap beyond the data; by moments, then by likelihood."""
    gap = (x.max() - x.min()) / len(x)
    lower, width = float(x.min() - gap), float(x.max() - x.min() + 2 * gap)
    a, b, _, _ = stats.beta.fit(x, floc=lower, fscale=width)
    return {"a": float(a), "b": float(b), "loc": lower, "scale": width}


#: Law -> what fits its words (None when it cannot hold the data), and how many constants it has.
_LAWS: Mapping[str, tuple[Callable[[Array], dict[str, Any] | None], int]] = {
    "normal": (_normal, 2),
    "lognormal": (_lognormal, 2),
    "uniform": (_uniform, 2),
    "triangular": (_triangular, 3),
    "weibull_min": (_weibull, 2),
    "gamma": (_gamma, 2),
    "beta": (_beta, 4),
}


@dataclass(frozen=True, eq=False)
class KernelSmoothed:
    """The law of data, smoothed by Gaussian kernels; offers what a frozen scipy law does.

    F(x) = mean over the data of Phi((x - x_i) / h), h by Silverman 1986, equation 3.31.
    """

    data: Array
    width: float

    @classmethod
    def of(cls, values: ArrayLike) -> KernelSmoothed:
        """The law of values (n,)."""
        x = np.sort(_checked(values))
        spread = min(float(x.std(ddof=1)), float(stats.iqr(x)) / 1.34 or math.inf)
        return cls(x, 0.9 * spread * len(x) ** -0.2)

    def support(self) -> tuple[float, float]:
        """Nearly everything lies within six widths of the data."""
        return float(self.data[0] - 6 * self.width), float(self.data[-1] + 6 * self.width)

    def pdf(self, x: ArrayLike) -> Array:
        """Density; shape of x."""
        z = (np.asarray(x, dtype=float)[..., None] - self.data) / self.width
        return np.asarray(np.exp(-0.5 * z**2).mean(-1) / (self.width * math.sqrt(2 * math.pi)))

    def cdf(self, x: ArrayLike) -> Array:
        """Probability of a smaller value; shape of x."""
        z = (np.asarray(x, dtype=float)[..., None] - self.data) / self.width
        return np.asarray(special.ndtr(z).mean(-1))

    def sf(self, x: ArrayLike) -> Array:
        """Probability of a larger value; shape of x."""
        z = (self.data - np.asarray(x, dtype=float)[..., None]) / self.width
        return np.asarray(special.ndtr(z).mean(-1))

    def ppf(self, u: ArrayLike) -> Array:
        """Value below which the probability is u; shape of u. By bisection, to rounding."""
        return _bisected(self.cdf, u, self.support(), rising=True)

    def isf(self, u: ArrayLike) -> Array:
        """Value above which the probability is u; shape of u."""
        return _bisected(self.sf, u, self.support(), rising=False)


def _bisected(
    function: Callable[[Array], Array], u: ArrayLike, ends: tuple[float, float], rising: bool
) -> Array:
    """Where a monotone function is u, within `ends`; 60 halvings leave rounding only."""
    target = np.asarray(u, dtype=float)
    low, high = np.full(target.shape, ends[0]), np.full(target.shape, ends[1])
    for _ in range(60):
        middle = 0.5 * (low + high)
        right = (function(middle) < target) == rising
        low, high = np.where(right, middle, low), np.where(right, high, middle)
    return np.asarray(0.5 * (low + high))


def data_law(values: ArrayLike) -> Distribution:
    """The empirical law of values (n,), smoothed; cut off at its own ends."""
    law = KernelSmoothed.of(values)
    digest = float(np.dot(law.data, np.cos(np.arange(len(law.data)))))
    words = (
        ("distribution", "data"),
        ("values", float(len(law.data))),
        ("mean", float(law.data.mean())),
        ("std", float(law.data.std(ddof=1))),
        ("digest", digest),
    )
    return Distribution(law, law.support(), words)


#: What a study writes for a law that comes from its data.
FROM_DATA = ("fit", "data")


def law_of(kind: str, values: ArrayLike, range: Range = UNBOUNDED) -> tuple[Distribution, str]:
    """The law `kind` of values (n,) within `range`, which cuts it off, and a sentence about it.

    kind: `fit` for the likeliest law, `data` for the values' own.
    """
    x = np.asarray(values, dtype=float)
    x = x[(x >= range[0]) & (x <= range[1])]
    if kind == "data":
        own = data_law(x)
        support = (max(own.support[0], range[0]), min(own.support[1], range[1]))
        words = own.words if range == UNBOUNDED else (*own.words, ("range", range))
        return Distribution(own.base, support, words), f"{len(x)} values, smoothed"
    best, *others = fitted_laws(x)
    law = best.distribution
    if range != UNBOUNDED:
        given = {key: v for key, v in law.words if key not in ("distribution", "range")}
        law = distribution(best.name, range=range, **given)
    next_best = f"; {others[0].name} has {others[0].aicc - best.aicc:.1f} more" if others else ""
    return law, f"{law} fits best by AICc{next_best}; Kolmogorov-Smirnov distance {best.ks:.2g}"
