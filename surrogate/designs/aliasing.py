"""Aliasing: which effects a regular two-level fraction cannot tell apart.

Read off the coded matrix alone, whatever made it. Runs of a regular fraction form a coset
of a linear code over {0, 1}; the words of the dual code are the defining relation.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from surrogate.designs import regular_fraction
from surrogate.space.space import Space

#: Factors of an effect that is named as confounded with blocks.
HIGHEST = 6
#: With more generators than this, the defining words are too many to list.
LISTED_GENERATORS = 12


@dataclass(frozen=True)
class Aliasing:
    """The confounding of a regular two-level fraction, in parameter names.

    resolution           length of the shortest defining word; None for a full factorial
    word_length_pattern  number of defining words of length 3, 4, .., parameters
    defining_words       products that are constant, `a:b:c` or `-a:b:c`, shortest first: all
                         2^p - 1 of them, or p that generate them when p > 12
    table                (effect, aliases) of main effects and two-factor interactions; an
                         alias `-a:b` is estimated with its sign reversed
    blocks               (parameter of more than two levels, effects that are constant at each
                         of them): confounded with its differences
    """

    resolution: int | None
    word_length_pattern: tuple[int, ...]
    defining_words: tuple[str, ...]
    table: tuple[tuple[str, list[str]], ...]
    blocks: tuple[tuple[str, tuple[str, ...]], ...] = ()

    def __str__(self) -> str:
        return "\n".join([self._fraction, *self.confounded])

    @property
    def confounded(self) -> list[str]:
        """A sentence for each parameter of blocks."""
        return [
            f"differences between levels of {name} are confounded with {', '.join(effects)}"
            for name, effects in self.blocks
            if effects
        ]

    @property
    def _fraction(self) -> str:
        if self.resolution is None:
            return "full factorial: no effect is aliased"
        words = " = ".join(self.defining_words[:16])
        more = len(self.defining_words) - 16
        lines = [f"resolution {self.resolution}; I = {words}" + (f" = ({more} more)" * (more > 0))]
        return "\n".join([*lines, *map(" = ".join, self.chains)])

    @property
    def chains(self) -> list[list[str]]:
        """Each set of effects that are aliased with one another once, main effects first."""
        seen: set[str] = set()
        found = []
        for effect, aliases in self.table:
            if aliases and effect not in seen:
                found.append([effect, *aliases])
                seen.update(alias.lstrip("-") for alias in aliases)
        return found


def aliasing(space: Space, coded: ArrayLike) -> Aliasing | None:
    """Aliasing of the design `coded`, (run, parameter); None unless it is a regular fraction.

    Centre points are left aside. A regular fraction has levels -1 and 1 only, its distinct
    runs form a coset, and each is run equally often. Parameters with more than two named levels
    are taken as blocks.
    """
    points = np.atleast_2d(np.asarray(coded, dtype=float))
    many = [j for j, p in enumerate(space.parameters) if len(p.levels) > 2]
    if len(many) == space.size:
        return None
    kept = [j for j in range(space.size) if j not in many]
    blocked, space = space, Space(tuple(space.parameters[j] for j in kept))
    inner = _inner(space, points[:, kept])
    corners = _corners(space, points[:, kept])
    basis = None if corners is None else _basis(corners)
    if corners is None or basis is None:
        return None
    rows = np.unique(corners, axis=0)
    lengths = regular_fraction.word_lengths((rows != rows[0]).sum(axis=1), space.size)
    return Aliasing(
        regular_fraction.resolution(lengths),
        lengths[3:],
        _words(basis, rows[0], space.names),
        _table(rows, space.names),
        tuple((blocked.names[j], _constant(corners, points[inner, j], space.names)) for j in many),
    )


def _inner(space: Space, coded: np.ndarray) -> np.ndarray:
    """Which rows are no centre points, (run,)."""
    continuous = [j for j, p in enumerate(space.parameters) if not p.categorical]
    if not continuous:
        return np.ones(len(coded), dtype=bool)
    return np.asarray(np.abs(coded[:, continuous]).max(axis=1) > 1e-9)


def _constant(corners: np.ndarray, levels: np.ndarray, names: tuple[str, ...]) -> tuple[str, ...]:
    """Effects that do not vary at any of the levels (run,), the shortest of those aliased."""
    which = np.unique(levels, return_inverse=True)[1].ravel()
    count, seen, found = np.bincount(which), set(), []
    for order in range(1, min(len(names), HIGHEST) + 1):
        for term in itertools.combinations(range(len(names)), order):
            column = corners[:, term].prod(axis=1)
            within = np.abs(np.bincount(which, column)) == count
            key = (column * column[0]).tobytes()
            if within.all() and key not in seen and np.ptp(column) > 0.0:
                seen.add(key)
                found.append(":".join(names[j] for j in term))
    return tuple(found)


def _corners(space: Space, coded: np.ndarray) -> np.ndarray | None:
    """Rows without centre points; None unless all have levels -1 and 1 only."""
    coded = coded[_inner(space, coded)]
    if len(coded) == 0 or np.abs(np.abs(coded) - 1.0).max() > 1e-9:
        return None
    signs: np.ndarray = np.sign(coded)
    return signs


def _basis(corners: np.ndarray) -> list[int] | None:
    """Reduced basis of the differences between runs as bit masks; None if not a coset."""
    distinct, times = np.unique(corners, axis=0, return_counts=True)
    basis: list[int] = []
    for row in distinct != distinct[0]:
        value = sum(1 << int(j) for j in np.flatnonzero(row))
        for vector in basis:
            value = min(value, value ^ vector)
        if value:
            basis = [
                min(vector, vector ^ value) if vector >> value.bit_length() - 1 & 1 else vector
                for vector in basis
            ] + [value]
    regular = len(distinct) == 2 ** len(basis) and len(set(times)) == 1
    return basis if regular else None


def _words(basis: list[int], run: np.ndarray, names: tuple[str, ...]) -> tuple[str, ...]:
    """Defining words from the dual of the reduced basis; signs from any one run."""
    leading = {vector.bit_length() - 1: vector for vector in basis}
    generators = []
    for free in (j for j in range(len(names)) if j not in leading):
        # A word holds a leading parameter when that one's basis vector holds the free one.
        held = [lead for lead, vector in leading.items() if vector >> free & 1]
        generators.append(frozenset([free, *held]))
    if len(generators) > LISTED_GENERATORS:
        words = generators
    else:
        words = [frozenset()]
        for generator in generators:
            words += [word ^ generator for word in words]
    ordered = sorted((len(word), sorted(word)) for word in words if word)
    return tuple(
        _signed(np.prod(run[word]), ":".join(names[j] for j in word)) for _, word in ordered
    )


def _table(rows: np.ndarray, names: tuple[str, ...]) -> tuple[tuple[str, list[str]], ...]:
    """Aliases of every main effect and two-factor interaction, by comparing their columns."""
    terms = [(j,) for j in range(len(names))] + list(itertools.combinations(range(len(names)), 2))
    effects = [":".join(names[j] for j in term) for term in terms]
    values = np.column_stack([rows[:, term].prod(axis=1) for term in terms])
    agreement = np.rint(values.T @ values / len(rows)).astype(int)
    return tuple(
        (
            effect,
            [_signed(agreement[i, j], effects[j]) for j in np.flatnonzero(agreement[i]) if j != i],
        )
        for i, effect in enumerate(effects)
    )


def _signed(sign: float, word: str) -> str:
    return word if sign > 0 else f"-{word}"
