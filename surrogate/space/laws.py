"""Laws by name: which words each takes, and how a range sets its ends.

Names: `uniform` (range), `normal` (mean, std), `lognormal` (mean, std of the
quantity itself), `triangular` (mode, range), or any continuous `scipy.stats`
name with its own shape words plus `loc` and `scale`. A law with two ends whose
words do not set them (loguniform, beta, truncnorm, ...) gets them from the range.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy import stats

from surrogate.errors import StudyError, nearest

Range = tuple[float, float]

#: Words whose values move with the origin of the unit, and words that only scale with it.
LOCATION_WORDS = ("mean", "mode", "loc")
SCALE_WORDS = ("std", "scale")

#: Shape words of scipy laws that say where the law ends, in scales from its location.
_END_WORDS = {
    "loguniform": ("a", "b"),
    "reciprocal": ("a", "b"),
    "truncnorm": ("a", "b"),
    "truncweibull_min": ("a", "b"),
    "truncexpon": ("b",),
    "truncpareto": ("c",),
}
#: Of these, the laws of a quantity that is above zero.
_POSITIVE = ("loguniform", "reciprocal", "truncpareto")


def option_names(name: str) -> tuple[list[str], list[str]]:
    """Words that law `name` takes (besides `range`), and those of them that it needs.

    Words that a range may take the place of are not among the latter.
    """
    if name in _NAMED:
        words = [key for key in inspect.signature(_NAMED[name]).parameters if key != "range"]
        return words, words
    shapes = _shapes(name)
    ends = _END_WORDS.get(name, ())
    return [*shapes, "loc", "scale"], [shape for shape in shapes if shape not in ends]


def _shapes(name: str) -> list[str]:
    """Shape words of a scipy law; `StudyError` when there is none of that name."""
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
    return [shape.strip() for shape in (family.shapes or "").split(",") if shape.strip()]


def ends_from_range(name: str, words: Mapping[str, float]) -> bool:
    """True when a range sets the ends of this law, instead of cutting it off."""
    if name in _NAMED:
        return name in ("uniform", "triangular")
    if name in _END_WORDS:
        return not any(word in words for word in _END_WORDS[name])
    if "loc" in words or "scale" in words:
        return False
    return all(map(math.isfinite, _standard_ends(name, words)))


def _standard_ends(name: str, words: Mapping[str, float]) -> Range:
    """Ends of a scipy law with these shape words, at location 0 and scale 1."""
    low, high = getattr(stats, name)(**words).support()
    return float(low), float(high)


def law(name: str, range: Range, words: Mapping[str, float]) -> Any:
    """The frozen scipy law, with its ends at those of `range` where that sets them.

    Raises `StudyError` with a sentence for each word that is not taken, lacks or is wrong.
    """
    mistakes = _mistakes(name, range, words)
    if mistakes:
        raise StudyError(*mistakes)
    if name in _NAMED:
        return _NAMED[name](range, **words)
    if all(map(math.isfinite, range)) and ends_from_range(name, words):
        words = _placed(name, range, words)
    frozen = getattr(stats, name)(**words)
    if not np.isfinite(frozen.ppf(0.5)):
        raise StudyError(f"{name}({dict(words)}) is not a distribution; check its shape words")
    return frozen


def _mistakes(name: str, range: Range, words: Mapping[str, float]) -> list[str]:
    accepted, required = option_names(name)
    mistakes = [
        f"distribution {name} does not take '{word}'; {nearest(word, accepted)}"
        for word in words
        if word not in accepted
    ]
    ends = _END_WORDS.get(name, ())
    if any(word in words for word in ends):
        required = [*required, *ends]
    elif ends and not all(map(math.isfinite, range)):
        mistakes.append(f"distribution {name} needs a range; {_example(name, required)}")
    lacking = [f"'{word}'" for word in required if word not in words]
    if lacking:
        needed = f"distribution {name} needs {', '.join(lacking)}"
        mistakes.append(f"{needed}; {_example(name, required)}")
    mistakes += [
        f"{word}: {words[word]:g} must be above 0"
        for word in SCALE_WORDS
        if word in words and not words[word] > 0
    ]
    if name in _POSITIVE and not range[0] > 0 and ends_from_range(name, words):
        if math.isfinite(range[0]):
            mistakes.append(f"range [{range[0]:g}, {range[1]:g}] of {name} must be above 0")
    return mistakes


def _example(name: str, required: list[str]) -> str:
    """How to write this law in a study."""
    words = "".join(f"{word}: .., " for word in required)
    return f"write {{distribution: {name}, {words}range: [smallest, largest]}}"


def _placed(name: str, range: Range, words: Mapping[str, float]) -> dict[str, float]:
    """The words with those added that put the ends of a scipy law at `range`."""
    lower, upper = range
    if name in _END_WORDS:
        start = {"truncexpon": {"loc": lower}, "truncpareto": {"scale": lower}}.get(name, {})
        full: dict[str, float] = {"loc": 0.0, "scale": 1.0, **start, **words}
        ends = [(end - full["loc"]) / full["scale"] for end in range]
        names = _END_WORDS[name]
        return full | dict(zip(names, ends[-len(names) :], strict=True))
    low, high = _standard_ends(name, words)
    scale = (upper - lower) / (high - low)
    return {**words, "loc": lower - scale * low, "scale": scale}


def _finite(name: str, range: Range) -> Range:
    if not all(map(math.isfinite, range)):
        raise StudyError(f"distribution {name} needs a range: [smallest, largest]")
    return range


def _uniform(range: Range) -> Any:
    lower, upper = _finite("uniform", range)
    return stats.uniform(lower, upper - lower)


def _normal(range: Range, mean: float, std: float) -> Any:
    return stats.norm(mean, std)


def _lognormal(range: Range, mean: float, std: float) -> Any:
    """Mean m and standard deviation s of the quantity: sigma^2 = ln(1 + (s/m)^2)."""
    if not mean > 0:
        raise StudyError(f"mean: {mean:g} of a lognormal quantity must be above 0")
    sigma = math.sqrt(math.log1p((std / mean) ** 2))
    return stats.lognorm(sigma, scale=mean * math.exp(-0.5 * sigma**2))


def _triangular(range: Range, mode: float) -> Any:
    lower, upper = _finite("triangular", range)
    if not lower <= mode <= upper:
        raise StudyError(f"mode: {mode:g} lies outside range [{lower:g}, {upper:g}]")
    return stats.triang((mode - lower) / (upper - lower), lower, upper - lower)


_NAMED: dict[str, Callable[..., Any]] = {
    "uniform": _uniform,
    "normal": _normal,
    "lognormal": _lognormal,
    "triangular": _triangular,
}
