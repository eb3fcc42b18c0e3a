"""Distributions of one physical quantity, from the words of a study file.

Names: `uniform` (range), `normal` (mean, std), `lognormal` (mean, std of the
quantity itself), `triangular` (mode, range), or any continuous `scipy.stats`
name with its own shape words plus `loc` and `scale`. A `range` truncates any of
them: F(x) = (F0(x) - F0(a)) / (F0(b) - F0(a)) on [a, b].
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from surrogate.errors import StudyError, nearest

Range = tuple[float, float]
UNBOUNDED: Range = (-math.inf, math.inf)

#: Words whose values move with the origin of the unit, and words that only scale with it.
LOCATION_WORDS = ("mean", "mode", "loc")
SCALE_WORDS = ("std", "scale")


@dataclass(frozen=True)
class Distribution:
    """A continuous distribution, truncated to `support` = (lower, upper).

    base   frozen scipy distribution before truncation
    words  what it was built from, for printing and comparing
    """

    base: Any
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

    def _ends(self, function) -> tuple[float, float]:
        return float(function(self.support[0])), float(function(self.support[1]))

    def cdf(self, x) -> np.ndarray:
        """Probability of a value below x, for the truncated distribution; same shape as x."""
        low, high = self._ends(self.base.cdf)
        return np.clip((self.base.cdf(x) - low) / (high - low), 0.0, 1.0)

    def sf(self, x) -> np.ndarray:
        """1 - cdf(x) without cancellation in the upper tail."""
        low, high = self._ends(self.base.sf)
        return np.clip((self.base.sf(x) - high) / (low - high), 0.0, 1.0)

    def ppf(self, u) -> np.ndarray:
        """Value below which the probability is u."""
        low, high = self._ends(self.base.cdf)
        return np.clip(self.base.ppf(low + np.asarray(u) * (high - low)), *self.support)

    def isf(self, u) -> np.ndarray:
        """Value above which the probability is u, accurate for small u."""
        low, high = self._ends(self.base.sf)
        return np.clip(self.base.isf(high + np.asarray(u) * (low - high)), *self.support)

    def pdf(self, x) -> np.ndarray:
        """Density at x; zero outside the support."""
        low, high = self._ends(self.base.cdf)
        x = np.asarray(x, dtype=float)
        inside = (x >= self.support[0]) & (x <= self.support[1])
        return np.where(inside, self.base.pdf(x) / (high - low), 0.0)

    @property
    def is_uniform(self) -> bool:
        """True when every value of a bounded support is equally likely."""
        return dict(self.words)["distribution"] == "uniform"

    def __str__(self) -> str:
        words = dict(self.words)
        name = words.pop("distribution")
        return f"{name}({', '.join(f'{key}={_short(value)}' for key, value in words.items())})"


def _short(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(f'{v:g}' for v in value)}]"
    return f"{value:g}"


def uniform(lower: float, upper: float) -> Distribution:
    """Uniform distribution on [lower, upper]."""
    return distribution("uniform", range=(lower, upper))


def distribution(name: str, *, range: Range = UNBOUNDED, **words: float) -> Distribution:
    """The distribution called `name`, truncated to `range`.

    Raises `StudyError` with a sentence per mistake: an unknown name, a word that
    the distribution does not take or lacks, a spread that is not positive, a
    range that is upside down or holds no probability.
    """
    lower, upper = map(float, range)
    if not lower < upper:
        raise StudyError(
            f"range [{lower:g}, {upper:g}] is upside down or empty; write [smallest, largest]"
        )
    base, named = _base(name, (lower, upper), words)
    support = (lower, upper)
    if name not in ("uniform", "triangular"):  # scipy rounds the ends of these
        support = (max(lower, float(base.support()[0])), min(upper, float(base.support()[1])))
    if not support[0] < support[1] or not base.cdf(support[1]) - base.cdf(support[0]) > 1e-12:
        raise StudyError(
            f"range [{lower:g}, {upper:g}] holds no probability of this "
            f"{name} distribution; move the range or the distribution"
        )
    described = {"distribution": name, **named}
    if (lower, upper) != UNBOUNDED:
        described["range"] = (lower, upper)
    return Distribution(base, support, tuple(described.items()))


def option_names(name: str) -> tuple[list[str], list[str]]:
    """Words that distribution `name` takes (besides `range`), and those that it needs."""
    if name in _NAMED:
        words = [key for key in inspect.signature(_NAMED[name]).parameters if key != "range"]
        return words, words
    family = getattr(stats, name, None)
    if not isinstance(family, stats.rv_continuous):
        continuous = [
            key for key in dir(stats) if isinstance(getattr(stats, key), stats.rv_continuous)
        ]
        close = nearest(name, [*_NAMED, *continuous]).split("?")[0]
        hint = f"{close}? " if close.startswith("did") else ""
        raise StudyError(
            f"distribution '{name}' is unknown; {hint}"
            f"Use {', '.join(_NAMED)} or a continuous scipy.stats name"
        )
    shapes = [shape.strip() for shape in (family.shapes or "").split(",") if shape.strip()]
    return [*shapes, "loc", "scale"], shapes


def _base(name: str, range: Range, words: Mapping[str, float]) -> tuple[Any, dict[str, float]]:
    """Frozen scipy distribution before truncation, and its words."""
    accepted, required = option_names(name)
    mistakes = [
        f"distribution {name} does not take '{word}'; {nearest(word, accepted)}"
        for word in words
        if word not in accepted
    ]
    mistakes += [f"distribution {name} needs '{word}'" for word in required if word not in words]
    mistakes += [
        f"{word}: {words[word]:g} must be above 0"
        for word in SCALE_WORDS
        if word in words and not words[word] > 0
    ]
    if mistakes:
        raise StudyError(*mistakes)
    if name in _NAMED:
        return _NAMED[name](range, **words), dict(words)
    frozen = getattr(stats, name)(**words)
    if not np.isfinite(frozen.ppf(0.5)):
        raise StudyError(f"{name}({words}) is not a distribution; check its shape words")
    return frozen, dict(words)


def _finite(name: str, range: Range) -> Range:
    if not all(map(math.isfinite, range)):
        raise StudyError(f"distribution {name} needs a range: [smallest, largest]")
    return range


def _uniform(range):
    lower, upper = _finite("uniform", range)
    return stats.uniform(lower, upper - lower)


def _normal(range, mean, std):
    return stats.norm(mean, std)


def _lognormal(range, mean, std):
    """Mean m and standard deviation s of the quantity: sigma^2 = ln(1 + (s/m)^2)."""
    if not mean > 0:
        raise StudyError(f"mean: {mean:g} of a lognormal quantity must be above 0")
    sigma = math.sqrt(math.log1p((std / mean) ** 2))
    return stats.lognorm(sigma, scale=mean * math.exp(-0.5 * sigma**2))


def _triangular(range, mode):
    lower, upper = _finite("triangular", range)
    if not lower <= mode <= upper:
        raise StudyError(f"mode: {mode:g} lies outside range [{lower:g}, {upper:g}]")
    return stats.triang((mode - lower) / (upper - lower), lower, upper - lower)


_NAMED = {
    "uniform": _uniform,
    "normal": _normal,
    "lognormal": _lognormal,
    "triangular": _triangular,
}
