"""Distributions of one physical quantity, from the words of a study file.

`laws` says which names and words there are. A `range` sets the ends of a law that
has ends and truncates any other: F(x) = (F0(x) - F0(a)) / (F0(b) - F0(a)) on [a, b].
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import StudyError
from surrogate.space.laws import Range, law

UNBOUNDED: Range = (-math.inf, math.inf)


@dataclass(frozen=True)
class Distribution:
    """A continuous distribution, truncated to `support` = (lower, upper).

    base   frozen scipy distribution before truncation
    words  what it was built from, for printing and comparing
    """

    base: Any = field(repr=False)  # scipy's tells only where it lies in memory
    support: Range
    words: tuple[tuple[str, Any], ...]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Distribution) and self.words == other.words

    def __hash__(self) -> int:
        return hash(self.words)

    @property
    def bounded(self) -> bool:
        """True when both ends of the support are finite."""
        return all(map(math.isfinite, self.support))

    @cached_property
    def _below(self) -> tuple[float, float]:
        """Probabilities of the base below both ends."""
        return float(self.base.cdf(self.support[0])), float(self.base.cdf(self.support[1]))

    @cached_property
    def _above(self) -> tuple[float, float]:
        """Probabilities of the base above both ends."""
        return float(self.base.sf(self.support[0])), float(self.base.sf(self.support[1]))

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Probability of a value below x, for the truncated distribution; same shape as x."""
        low, high = self._below
        return _clipped((self.base.cdf(x) - low) / (high - low), (0.0, 1.0))

    def sf(self, x: ArrayLike) -> NDArray[np.float64]:
        """1 - cdf(x) without cancellation in the upper tail."""
        low, high = self._above
        return _clipped((self.base.sf(x) - high) / (low - high), (0.0, 1.0))

    def ppf(self, u: ArrayLike) -> NDArray[np.float64]:
        """Value below which the probability is u."""
        low, high = self._below
        return _clipped(self.base.ppf(low + np.asarray(u) * (high - low)), self.support)

    def isf(self, u: ArrayLike) -> NDArray[np.float64]:
        """Value above which the probability is u, accurate for small u."""
        low, high = self._above
        return _clipped(self.base.isf(high + np.asarray(u) * (low - high)), self.support)

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x; zero outside the support."""
        low, high = self._below
        x = np.asarray(x, dtype=float)
        inside = (x >= self.support[0]) & (x <= self.support[1])
        return np.where(inside, self.base.pdf(x) / (high - low), 0.0)

    @property
    def is_uniform(self) -> bool:
        """True when every value of a bounded support is equally likely."""
        return bool(dict(self.words)["distribution"] == "uniform")

    def __str__(self) -> str:
        words = dict(self.words)
        name = words.pop("distribution")
        return f"{name}({', '.join(f'{key}={_short(value)}' for key, value in words.items())})"


def _clipped(values: Any, limits: Range) -> NDArray[np.float64]:
    clipped: NDArray[np.float64] = np.clip(values, *limits)
    return clipped


def _short(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(f'{v:g}' for v in value)}]"
    return f"{value:g}"


def uniform(lower: float, upper: float) -> Distribution:
    """Uniform distribution on [lower, upper]."""
    return distribution("uniform", range=(lower, upper))


def distribution(name: str, *, range: Range = UNBOUNDED, **words: float) -> Distribution:
    """The distribution called `name`, on `range`.

    Raises `StudyError` with a sentence per mistake: an unknown name, a word that
    the distribution does not take or lacks, a spread that is not positive, a
    range that is upside down or holds no probability.
    """
    lower, upper = map(float, range)
    if not lower < upper:
        raise StudyError(
            f"range [{lower:g}, {upper:g}] is upside down or empty; write [smallest, largest]"
        )
    base = law(name, (lower, upper), words)
    support = _support(base, (lower, upper))
    if not support[0] < support[1] or not base.cdf(support[1]) - base.cdf(support[0]) > 1e-12:
        raise StudyError(
            f"range [{lower:g}, {upper:g}] holds no probability of this "
            f"{name} distribution; move the range or the distribution"
        )
    described: dict[str, Any] = {"distribution": name, **words}
    if (lower, upper) != UNBOUNDED:
        described["range"] = (lower, upper)
    return Distribution(base, support, tuple(described.items()))


def _support(base: Any, range: Range) -> Range:
    """Where a law within `range` has probability; ends that scipy rounds are those of the range."""
    low, high = map(float, base.support())
    rounding = 1e-12 * (range[1] - range[0]) if all(map(math.isfinite, range)) else 0.0
    return (
        low if low > range[0] + rounding else range[0],
        high if high < range[1] - rounding else range[1],
    )
