"""A polynomial that a design is made for: its terms, and the values its parameters may take."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.requirements import choice
from surrogate.designs.vertices import feasible_candidates
from surrogate.errors import DesignError, nearest
from surrogate.space import quadrature
from surrogate.space.space import Parameter, Space

Array = NDArray[np.float64]

MODELS = ("linear", "interactions", "quadratic")
#: A product of powers of parameters: ((parameter number, power), ...); () is the constant.
Term = tuple[tuple[int, int], ...]
#: Of more allowed values than this, so many are candidates, evenly spaced.
MOST = 25
#: Highest power of a parameter in a term.
HIGHEST = 4


class Model:
    """Terms of a polynomial in coded values and the values its parameters may take.

    values  candidate coded values of each parameter
    candidates  points (candidate, parameter) to choose from where there are constraints
    size    number of terms; a categorical parameter of k levels counts k - 1 times

    Raises `DesignError` when a term names no parameter, or asks for a power that it has not.
    """

    def __init__(self, space: Space, model: str | Sequence[str]):
        self.parameters = space.parameters
        self.follows = space.region.dependent if space.region is not None else ()
        self.terms = _terms(space, model)
        highest = max((power for term in self.terms for _, power in term), default=1)
        count = 2 if highest == 1 else 2 * highest + 1
        self.values = [_candidates(p, count) for p in space.parameters]
        self.candidates, self.basis = None, None
        if space.region is not None:
            self.candidates = feasible_candidates(space, self.values)
            self.basis = _estimable(self.matrix(self.candidates))
        self.size = self.matrix(np.zeros((1, space.size))).shape[1]

    def matrix(self, coded: Array) -> Array:
        """Model matrix (run, term) of coded points (run, parameter).

        Where constraints make terms depend on each other, of combinations that do not.
        """
        full = self.full(coded)
        return full if self.basis is None else full @ self.basis

    def full(self, coded: Array) -> Array:
        """Values (run, column) of the terms themselves, whose columns `named` names."""
        mains = [_main_effects(p, coded[:, j]) for j, p in enumerate(self.parameters)]
        return np.hstack([_columns(term, mains, len(coded)) for term in self.terms])

    @property
    def named(self) -> list[tuple[str, int]]:
        """Name and order of each column of `full`: `1`, `a`, `a:b`, `a^2`, `bandage[biflex_16]`.

        The order is 0 for the constant, 1 for a main effect, 2 and more for the rest.
        """
        return [
            (":".join(factors) or "1", sum(power for _, power in term))
            for term, factors in self._column_terms()
        ]

    @property
    def independent(self) -> NDArray[np.bool_]:
        """Which columns of `full` hold no parameter that follows from others by an equality."""
        return np.array(
            [all(j not in self.follows for j, _ in term) for term, _ in self._column_terms()]
        )

    def _column_terms(self) -> Iterator[tuple[Term, tuple[str, ...]]]:
        """The term of each column of `full`, and the names of its factors."""
        for term in self.terms:
            for factors in itertools.product(*(self._factors(j, power) for j, power in term)):
                yield term, factors

    def _factors(self, j: int, power: int) -> list[str]:
        parameter = self.parameters[j]
        if parameter.categorical:
            return [f"{parameter.name}[{level}]" for level in parameter.levels[:-1]]
        return [parameter.name + (f"^{power}" if power > 1 else "")]

    def moments(self) -> Array:
        """Mean (term, term) of f f' over the ranges, f being the row of a point.

        Continuous parameters are even over their range, levels and allowed values equally
        likely; with constraints, the mean over the candidates.
        """
        if self.candidates is not None:
            rows = self.matrix(self.candidates)
            return np.asarray(rows.T @ rows / len(rows))
        found = np.ones((self.size, self.size))
        for j, parameter in enumerate(self.parameters):
            nodes, weights = _rule(parameter)
            points = np.zeros((len(nodes), len(self.parameters)))
            points[:, j] = nodes
            rows = np.hstack([self._share(term, j, points) for term in self.terms])
            found *= rows.T @ (weights[:, None] * rows)
        return found

    def _share(self, term: Term, j: int, points: Array) -> Array:
        """What parameter number j contributes to the columns of a term, (point, column)."""
        factors = []
        for i, power in term:
            columns = _main_effects(self.parameters[i], points[:, i]) ** power
            factors.append(columns if i == j else np.ones_like(columns))
        return _columns(tuple((k, 1) for k in range(len(factors))), factors, len(points))

    def start(self, runs: int, rng: np.random.Generator) -> Array:
        """A random design (run, parameter)."""
        if self.candidates is not None:
            return np.asarray(rng.choice(self.candidates, size=runs))
        return np.column_stack([rng.choice(values, size=runs) for values in self.values])

    def neighbours(self, point: Array) -> Array:
        """What a point may be exchanged for, (candidate, parameter)."""
        return _neighbours(point, self.values) if self.candidates is None else self.candidates


def _terms(space: Space, model: str | Sequence[str]) -> list[Term]:
    """The constant first; then those of a named model, or the terms that are listed."""
    if not isinstance(model, str):
        listed = [_term(space, text) for text in model]
        return list(dict.fromkeys([(), *listed]))
    choice("model", model, MODELS)
    count = range(space.size)
    terms: list[Term] = [(), *(((j, 1),) for j in count)]
    if model != "linear":
        terms += [((i, 1), (j, 1)) for i, j in itertools.combinations(count, 2)]
    if model == "quadratic":
        terms += [((j, 2),) for j, p in enumerate(space.parameters) if _bends(p, 2)]
    return terms


def _term(space: Space, text: str) -> Term:
    """Of `a`, `a:b`, `a^2:b`; `1` is the constant."""
    powers: dict[int, int] = {}
    for factor in text.split(":") if text.strip() != "1" else []:
        name, _, power = map(str.strip, factor.partition("^"))
        if name not in space.names:
            raise DesignError(
                f"model: '{name}' in term '{text}' is unknown; {nearest(name, space.names)}"
            )
        if power and not (power.isdecimal() and 1 <= int(power) <= HIGHEST):
            raise DesignError(
                f"model: power '{power}' in term '{text}' must be a whole number from 1 to "
                f"{HIGHEST}; write terms as a, a:b or a^2"
            )
        j = space.names.index(name)
        powers[j] = powers.get(j, 0) + int(power or 1)
        if powers[j] > 1 and not _bends(space.parameters[j], powers[j]):
            raise DesignError(
                f"model: '{text}': {name} has too few values for power {powers[j]}; leave it out"
            )
    return tuple(sorted(powers.items()))


def _bends(parameter: Parameter, power: int) -> bool:
    """Whether a parameter has values enough for this power."""
    if parameter.categorical:
        return False
    return parameter.allowed is None or len(parameter.allowed) > power


def _columns(term: Term, mains: Sequence[Array], runs: int) -> Array:
    """Columns (run, column) of a term: all products of its parameters' columns."""
    found = np.ones((runs, 1))
    for j, power in term:
        column = mains[j] if power == 1 else mains[j] ** power
        found = (found[:, :, None] * column[:, None, :]).reshape(runs, -1)
    return found


def _main_effects(parameter: Parameter, column: Array) -> Array:
    """The column itself, or for k levels k - 1 effect-coded columns (the last level is -1)."""
    if not parameter.categorical:
        return column[:, None]
    level = np.argmin(np.abs(column[:, None] - parameter.coded_levels), axis=1)
    k = len(parameter.levels)
    coded: Array = np.vstack([np.eye(k - 1), -np.ones(k - 1)])[level]
    return coded


def _rule(parameter: Parameter) -> tuple[Array, Array]:
    """Nodes and weights that sum to 1: even over a range, equal over levels and values."""
    nodes = parameter.coded_levels if parameter.categorical else parameter.allowed
    if nodes is None:
        nodes, weights = quadrature.legendre(HIGHEST + 1)
        return nodes, weights / 2.0
    return nodes, np.full(len(nodes), 1.0 / len(nodes))


def _candidates(parameter: Parameter, count: int) -> Array:
    """Coded values that a parameter may take: levels, allowed values, or `count` even ones."""
    if parameter.categorical:
        return parameter.coded_levels
    allowed = parameter.allowed
    if allowed is None:
        return np.linspace(-1.0, 1.0, count)
    return allowed if len(allowed) <= MOST else np.unique(parameter.snap(np.linspace(-1, 1, MOST)))


def _estimable(matrix: Array) -> Array:
    """Orthonormal combinations (term, rank) of the terms that candidates can tell apart.

    Equalities make terms depend on each other, as the components of a mixture and the constant
    do; the combinations span the same polynomials as Scheffe's (1958), with the same optimum.
    """
    _, singular, rows = np.linalg.svd(matrix, full_matrices=False)
    kept: Array = rows[singular > 1e-8 * singular[0]].T
    return kept


def _neighbours(point: Array, values: Sequence[Array]) -> Array:
    """The points that differ from `point` in one coordinate at most; (candidate, parameter)."""
    rows = np.repeat(point[None, :], sum(map(len, values)), axis=0)
    columns = np.repeat(np.arange(len(values)), [len(v) for v in values])
    rows[np.arange(len(rows)), columns] = np.concatenate(values)
    return rows
