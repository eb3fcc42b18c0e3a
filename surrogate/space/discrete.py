"""Laws of an ordered quantity that takes some values only: integers, sizes in a catalogue.

Every allowed value is equally likely. With a continuous law F, a value has the probability
of what is rounded to it, F((v_i + v_i+1) / 2) - F((v_i-1 + v_i) / 2); the cells of the first
and last value reach as far beyond them as towards their neighbour, but not past zero.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import StudyError
from surrogate.space.distributions import distribution
from surrogate.space.laws import Range
from surrogate.space.units import IDENTITY, Conversion

Numbers = NDArray[np.float64]

#: More values than this are a continuous quantity.
MOST = 10_000


@dataclass(frozen=True, eq=False)
class DiscreteLaw:
    """Probabilities of the allowed values; build one by `integers` or `listed`.

    values         allowed values, rising, (k,)
    probabilities  of each, (k,), sum 1
    words          what it was built from, for printing and comparing
    """

    values: Numbers
    probabilities: Numbers
    words: tuple[tuple[str, Any], ...]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, DiscreteLaw) and self.words == other.words

    def __hash__(self) -> int:
        return hash(self.words)

    bounded = True
    is_uniform = False

    @property
    def support(self) -> Range:
        """Smallest and largest value."""
        return float(self.values[0]), float(self.values[-1])

    def nearest(self, x: ArrayLike) -> NDArray[np.intp]:
        """Number of the allowed value nearest to x, the lower of two; same shape."""
        middles = 0.5 * (self.values[:-1] + self.values[1:])
        return np.asarray(np.searchsorted(middles, np.asarray(x, dtype=float), side="left"))

    def allows(self, x: ArrayLike) -> NDArray[np.bool_]:
        """Whether x is an allowed value, up to the last digits of a printed one."""
        x = np.asarray(x, dtype=float)
        gap = np.abs(x - self.values[self.nearest(x)])
        return np.asarray(gap <= 1e-9 * (self.values[-1] - self.values[0]))

    def cdf(self, x: ArrayLike) -> Numbers:
        """Probability of a value of at most x; same shape."""
        below = np.append(0.0, np.cumsum(self.probabilities))
        return np.asarray(below[np.searchsorted(self.values, x, side="right")])

    def ppf(self, u: ArrayLike) -> Numbers:
        """The value up to which the probability reaches u."""
        index = np.searchsorted(np.cumsum(self.probabilities), np.asarray(u), side="right")
        return np.asarray(self.values[np.minimum(index, len(self.values) - 1)])

    def __str__(self) -> str:
        words = dict(self.words)
        low, high = self.support
        shown = [f"{value:g}" for value in self.values]
        if words.pop("integer", False):
            said = f"whole numbers {low:g} to {high:g}"
        elif len(shown) > 10:
            said = f"one of {', '.join(shown[:4])}, ... {shown[-1]} ({len(shown)} values)"
        else:
            said = f"one of {', '.join(shown)}"
        name = words.pop("distribution", "uniform")
        if name == "uniform":
            return said
        law = [f"{key}={words[key]:g}" for key in words if key not in ("range", "values")]
        return f"{said}, by {name}({', '.join(law)})"


def integers(
    range: Range, name: str = "uniform", *, convert: Conversion = IDENTITY, **words: float
) -> DiscreteLaw:
    """Whole numbers from range[0] to range[1], brought to the solver's unit by `convert`.

    name, words: a continuous law, in the solver's unit, that is rounded. Raises `StudyError`
    for ends that are no whole numbers, or more than `MOST` of them.
    """
    lower, upper = range
    if not lower < upper:
        raise StudyError(
            f"range [{lower:g}, {upper:g}] is upside down or empty; write [smallest, largest]"
        )
    broken = [end for end in range if end != np.rint(end)]
    if broken:
        raise StudyError(
            f"range: {broken[0]:g} is no whole number, but integer: true asks for whole "
            "numbers; round the ends, or write values: [..]"
        )
    if upper - lower >= MOST:
        raise StudyError(
            f"range [{lower:g}, {upper:g}] holds more than {MOST} whole numbers; leave out "
            "integer: true and let the solver round"
        )
    numbers = [convert.place(number) for number in np.arange(lower, upper + 1.0).tolist()]
    if convert != IDENTITY:
        return listed(numbers, name, **words)
    said = {"range": (float(lower), float(upper)), "integer": True}
    return _law(np.array(numbers), name, words, said)


def listed(values: Iterable[float], name: str = "uniform", **words: float) -> DiscreteLaw:
    """The given values, in any order; name, words: a continuous law that is rounded to them.

    Raises `StudyError` for fewer than two values, values that stand twice, and too many.
    """
    given = [float(value) for value in values]
    rising = np.array(sorted(set(given)))
    if len(rising) < len(given) or len(rising) < 2:
        raise StudyError(
            f"values [{', '.join(f'{value:g}' for value in given)}] must be two or more "
            "different numbers; a single value goes to constants:"
        )
    if len(rising) > MOST:
        raise StudyError(f"values: {len(rising)} are too many; give a range")
    return _law(rising, name, words, {"values": tuple(rising.tolist())})


def _law(values: Numbers, name: str, words: dict[str, float], said: dict[str, Any]) -> DiscreteLaw:
    for array in (values, probabilities := _probabilities(values, name, words)):
        array.setflags(write=False)
    return DiscreteLaw(
        values, probabilities, tuple({"distribution": name, **words, **said}.items())
    )


def _probabilities(values: Numbers, name: str, words: dict[str, float]) -> Numbers:
    """Probability of what is rounded to each value, (k,)."""
    step = np.diff(values)
    low, high = values[0] - 0.5 * step[0], values[-1] + 0.5 * step[-1]
    if values[0] > 0.0:
        low = max(low, 0.5 * values[0])
    law = distribution(name, range=(float(low), float(high)), **words)
    if law.is_uniform:
        return np.full(len(values), 1.0 / len(values))
    below = law.cdf(np.concatenate([[low], 0.5 * (values[:-1] + values[1:]), [high]]))
    found = np.diff(below)
    if not (found > 0.0).all():
        lost = values[int(np.argmin(found))]
        raise StudyError(
            f"the {name} distribution gives {lost:g} no probability; leave it out, or move the "
            "distribution"
        )
    return np.asarray(found / found.sum())
