"""Functions drawn from a Gaussian process given its runs.

Matheron's rule (Wilson et al. 2021, Pathwise conditioning of Gaussian processes, JMLR
22): a path of the unconditioned process plus the kriging of what it misses at the runs,

    f(x) = g(x) + kriging of (y - g(X) - noise) at x.

The path g is a Karhunen-Loeve sum, g = sum_m sqrt(lambda_m) xi_m phi_m(x). For a product
kernel the eigenfunctions are products of one-dimensional ones, found on the quadrature of
each input's law (Nystrom's method), and those with the largest eigenvalues are kept: the
expansion with the least mean square error for its length. What is cut off are ripples
that hardly move an integral. (Random Fourier features failed here: between the runs of a
smooth process their spread was wrong by factors.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.estimator import Groups
from surrogate.regressors import anova, expansion
from surrogate.regressors.matern import correlation, weighted_sum
from surrogate.regressors.process import Process

Array = NDArray[np.float64]

#: Terms of the expansion.
TERMS = 1000
#: Nodes for each input, and the smallest eigenvalue that they resolve.
QUADRATURE = 48
RESOLVED = 1e-11
#: Points whose eigenfunctions are evaluated at once: their products stay in the cache.
STEP = 64


@dataclass(frozen=True, eq=False)
class Eigenfunctions:
    """Eigenfunctions of the kernel in one input: phi = kernel(x, nodes) @ extension.

    columns (own) column numbers, nodes (m, own) their values, extension (m, r), eigenvalues (r,)
    """

    columns: list[int]
    nodes: Array
    lengths: Array
    extension: Array
    eigenvalues: Array

    def values(self, points: Array) -> Array:
        """All r eigenfunctions at points (k, own), shape (k, r)."""
        return correlation(points, self.nodes, self.lengths) @ self.extension


@dataclass(frozen=True, eq=False)
class Paths:
    """Drawn functions of one fitted process, which share their terms.

    process         the `GaussianProcess`
    eigenfunctions  of each input; numbers (terms, d) which of them each term multiplies
    waves (terms, size), weights (n, size), trend (q, size)  coefficients of each path
    found           indices of all paths, by the groups that they were asked for
    """

    process: Process
    eigenfunctions: list[Eigenfunctions]
    numbers: NDArray[np.intp]
    waves: Array
    weights: Array
    trend: Array
    found: dict[Any, list[anova.SobolIndices]] = field(default_factory=dict, repr=False)

    def predict(self, X: ArrayLike, which: int | slice) -> Array:
        """Values (m,) of path number `which`, or (m, k) of a slice of them, at coded X (m, d)."""
        one = self.process
        points = one.expanded(X)
        values = one.trend_columns(points) @ self.trend[:, which]
        values += weighted_sum(points, one.points_, one.lengths_, self.weights[:, which])
        for start in range(0, len(points), STEP):
            part = slice(start, start + STEP)
            values[part] += (
                _terms(self.eigenfunctions, self.numbers, points[part]) @ self.waves[:, which]
            )
        return np.asarray(one.offset_ + one.scale_ * values)

    def indices(self, groups: Groups | None = None) -> list[anova.SobolIndices]:
        """Exact Sobol' indices of every path, of inputs or groups; computed once."""
        asked = None if groups is None else tuple(map(tuple, groups))
        if asked not in self.found:
            self.found[asked] = self._indices(asked)
        return self.found[asked]

    def _indices(self, groups: Groups | None) -> list[anova.SobolIndices]:
        """Those of the mean, exact, moved by what each path deviates from it.

        Deviations are projected on the terms; constants of the trend move means only.
        """
        one = self.process
        given = () if groups is None else (groups,)
        means, projections = self._projections()
        around = np.vstack([self.weights, self.trend[1:]])
        centre = np.append(one.weights_, one.trend_[1:])
        mean = projections.T @ centre
        deviations = self.waves + projections.T @ around - mean[:, None]
        moved = expansion.moved_indices(
            one.sobol_indices(*given),
            expansion.Products(self.numbers, means),
            one.scale_ * mean,
            one.scale_ * deviations,
            groups,
        )
        shifts = one.scale_ * (self.trend[0] - one.trend_[0])
        return [anova.shifted(*pair) for pair in zip(moved, shifts, strict=True)]

    def _projections(self) -> tuple[Array, Array]:
        """Means of each term's functions (terms, d), and <k(., x_i), term>, <trend, term>.

        The second is (n + q - 1, terms), the constant left out.
        """
        one = self.process
        rules = anova.quadratures(one.space, one.n_features_in_, QUADRATURE)
        means = np.empty(self.numbers.shape)
        projections: Array = np.ones((1, len(self.numbers)))
        for j, (of, (nodes, weights)) in enumerate(zip(self.eigenfunctions, rules, strict=True)):
            own = of.values(one.own_columns(j, nodes)[1]) * weights[:, None]
            means[:, j] = own.sum(axis=0)[self.numbers[:, j]]
            along = np.delete(one.factor(j, nodes), len(one.points_), 0) @ own
            projections = projections * along[:, self.numbers[:, j]]
        return means, projections


@dataclass(frozen=True)
class Together:
    """Functions drawn from several processes, the paths of one after those of another."""

    parts: tuple[Paths, ...]

    def predict(self, X: ArrayLike, which: slice) -> Array:
        """Values (m, k) of a slice of all paths at coded X (m, d)."""
        return np.hstack([part.predict(X, slice(None)) for part in self.parts])[:, which]


@dataclass(frozen=True)
class Draw:
    """One drawn function, with what a regressor offers.

    paths  all functions drawn with it;  own, number  those of its process, and which one it is
    """

    paths: Together
    own: Paths
    number: int

    def predict(self, X: ArrayLike) -> Array:
        """Values (m,) at coded X (m, d)."""
        return self.own.predict(X, self.number)

    def sobol_indices(self, groups: Groups | None = None) -> anova.SobolIndices:
        """Exact Sobol' indices; those of all paths of a process are found together, once."""
        return self.own.indices(groups)[self.number]


def draws(processes: Sequence[Process], size: int, seed: Any) -> list[Draw]:
    """`size` functions, as nearly as many of each process as of another."""
    rng = np.random.default_rng(seed)
    sizes = [len(part) for part in np.array_split(np.arange(size), len(processes))]
    parts = tuple(draw(*pair, rng) for pair in zip(processes, sizes, strict=True))
    together = Together(parts)
    return [
        Draw(together, part, number)
        for part, count in zip(parts, sizes, strict=True)
        for number in range(count)
    ]


def draw(process: Process, size: int, seed: Any) -> Paths:
    """Draw `size` functions of a fitted `GaussianProcess`; seed as for `default_rng`.

    Trend coefficients and process variance are drawn too; lengths and nugget are the process's.
    """
    rng = np.random.default_rng(seed)
    factors, points = process.factors_, process.points_
    freedom = process.interval_freedom
    variance = factors.variance(process.standard_, process.weights_) * process.widening_**2
    spread = np.sqrt(variance * freedom / rng.chisquare(freedom, size))
    eigenfunctions = _eigenfunctions(process)
    numbers, eigenvalues = _largest([of.eigenvalues for of in eigenfunctions])
    waves = np.sqrt(eigenvalues)[:, None] * spread * rng.standard_normal((len(numbers), size))
    noise = np.sqrt(process.nugget_) * spread * rng.standard_normal((len(points), size))
    noise *= np.sqrt(process.noise_)[:, None]
    at_runs = _terms(eigenfunctions, numbers, points) @ waves
    missed = process.standard_[:, None] - at_runs - noise
    trend, weights = factors.trend(missed), factors.weights(missed)
    return Paths(process, eigenfunctions, numbers, waves, weights, trend)


def _eigenfunctions(process: Process) -> list[Eigenfunctions]:
    """Nystrom eigenfunctions of each input, largest eigenvalue first."""
    rules = anova.marginals(process.space, process.n_features_in_, QUADRATURE)
    return [_of_input(process, j, *rule) for j, rule in enumerate(rules)]


def _of_input(process: Process, parameter: int, nodes: Array, weights: Array) -> Eigenfunctions:
    own, values = process.own_columns(parameter, nodes)
    lengths, root = process.lengths_[own], np.sqrt(weights)
    eigenvalues, vectors = np.linalg.eigh(
        root[:, None] * correlation(values, values, lengths) * root
    )
    good = np.flatnonzero(eigenvalues > RESOLVED)[::-1]
    extension = root[:, None] * vectors[:, good] / eigenvalues[good]
    return Eigenfunctions(own, values, lengths, extension, eigenvalues[good])


def _largest(eigenvalues: list[Array]) -> tuple[NDArray[np.intp], Array]:
    """The `TERMS` largest products of one eigenvalue of each input: numbers (terms, d), values.

    Input by input: the first inputs' part of a largest product is itself among the largest.
    """
    numbers, values = np.empty((1, 0), dtype=np.intp), np.ones(1)
    for own in eigenvalues:
        products = np.multiply.outer(values, own).ravel()
        chosen = _order_of_largest(products)
        before, new = np.divmod(chosen, len(own))
        numbers, values = np.column_stack([numbers[before], new]), products[chosen]
    return numbers, values


def _order_of_largest(values: Array) -> NDArray[np.intp]:
    """Numbers of the `TERMS` largest values, largest first; of equal ones the first."""
    if len(values) <= TERMS:
        return np.argsort(-values, kind="stable")
    least = np.partition(values, len(values) - TERMS)[len(values) - TERMS]
    few = np.flatnonzero(values >= least)
    return few[np.argsort(-values[few], kind="stable")[:TERMS]]


def _terms(eigenfunctions: list[Eigenfunctions], numbers: NDArray[np.intp], points: Array) -> Array:
    """Products (k, terms) of eigenfunctions at column values (k, c)."""
    result = np.ones((len(points), len(numbers)))
    for j, of in enumerate(eigenfunctions):
        result *= of.values(points[:, of.columns])[:, numbers[:, j]]
    return result
