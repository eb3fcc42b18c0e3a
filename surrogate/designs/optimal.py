"""Optimal designs: the points from which a named polynomial is known best.

For odd run counts, irregular models, constraints, categorical parameters with many levels.
`d_optimal` is for telling which terms matter, `i_optimal` for predicting with them,
`a_optimal` for knowing each coefficient by itself. The criteria are in
`surrogate.designs.criteria`, the search in `surrogate.designs.exchange`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.designs.criteria import Determinant, MeanVariance
from surrogate.designs.design import searching
from surrogate.designs.exchange import best_of
from surrogate.designs.model import Model
from surrogate.designs.requirements import affordable, bounded, whole
from surrogate.errors import DesignError
from surrogate.space.space import Space

Array = NDArray[np.float64]


def checked(
    space: Space,
    *,
    runs: int,
    model: str | Sequence[str] = "linear",
    starts: int = 20,
    **_: object,
) -> int:
    """Number of points that these options of an optimal design give; raises `DesignError`."""
    runs, terms = _size(space, runs, model, starts)
    if runs < terms:
        raise DesignError(
            f"runs: {runs} cannot estimate the {terms} terms of {_named(model)} "
            f"in {space.size} parameters; give at least {terms}"
        )
    return runs


def checked_more(
    space: Space,
    coded: ArrayLike,
    *,
    runs: int,
    model: str | Sequence[str] = "linear",
    starts: int = 20,
    **_: object,
) -> int:
    """Number of points that are added to the points `coded`; raises `DesignError`."""
    runs, terms = _size(space, runs, model, starts)
    there = len(np.atleast_2d(np.asarray(coded)))
    if there + runs < terms:
        raise DesignError(
            f"runs: {runs} more than the {there} that are there cannot estimate the {terms} terms "
            f"of {_named(model)} in {space.size} parameters; give at least {terms - there}"
        )
    return runs


@searching(checked)
def d_optimal(
    space: Space,
    *,
    runs: int,
    model: str | Sequence[str] = "linear",
    starts: int = 20,
    seed: int | None = None,
) -> Array:
    """`runs` points, coded (run, parameter), with the smallest joint error of all coefficients.

    model: linear, interactions, quadratic, or a list of terms such as [a, b, a:b, a^2].
    Continuous parameters take -1 and 1, and in a model with squares also -0.5, 0, 0.5; integers
    and listed values take their allowed values; levels of categorical ones enter as
    effect-coded columns. The best of `starts` searches. Raises `DesignError` when
    there are fewer runs than terms.
    """
    checked(space, runs=runs, model=model, starts=starts)
    return best_of(Model(space, model), Determinant(), runs, starts, seed)


@searching(checked)
def i_optimal(
    space: Space,
    *,
    runs: int,
    model: str | Sequence[str] = "quadratic",
    starts: int = 20,
    seed: int | None = None,
) -> Array:
    """`runs` points with the smallest mean variance of predictions over the ranges.

    Options and values as in `d_optimal`.
    """
    checked(space, runs=runs, model=model, starts=starts)
    of = Model(space, model)
    return best_of(of, MeanVariance(of.moments()), runs, starts, seed)


@searching(checked)
def a_optimal(
    space: Space,
    *,
    runs: int,
    model: str | Sequence[str] = "linear",
    starts: int = 20,
    seed: int | None = None,
) -> Array:
    """`runs` points with the smallest mean variance of the coefficients (coded parameters).

    Options and values as in `d_optimal`.
    """
    checked(space, runs=runs, model=model, starts=starts)
    of = Model(space, model)
    return best_of(of, MeanVariance(np.eye(of.size)), runs, starts, seed)


@searching(checked_more)
def d_optimal_more(
    space: Space,
    coded: ArrayLike,
    *,
    runs: int,
    model: str | Sequence[str] = "quadratic",
    starts: int = 20,
    seed: int | None = None,
) -> Array:
    """`runs` rows to add to the points `coded`, from which together a model is estimated best.

    Options and values as in the design `d_optimal`.
    """
    checked_more(space, coded, runs=runs, model=model, starts=starts)
    there = np.atleast_2d(np.asarray(coded, dtype=float))
    return best_of(Model(space, model), Determinant(), runs, starts, seed, kept=there)


def _size(space: Space, runs: int, model: str | Sequence[str], starts: int) -> tuple[int, int]:
    """Checked number of runs, and of terms."""
    bounded(space, "an optimal design")
    runs = whole("runs", runs, 1)
    whole("starts", starts, 1)
    terms = Model(space, model).size
    affordable(runs * terms, "an optimal design", "lower runs, or use fractional_factorial")
    return runs, terms


def _named(model: str | Sequence[str]) -> str:
    return f"a {model} model" if isinstance(model, str) else "this model"
