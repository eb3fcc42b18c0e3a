"""Full and independent Sobol' indices of correlated inputs.

Correlated inputs are functions of independent ones (Rosenblatt 1952), in as many ways as the
inputs have orders. With x_i first its part is x_i itself: the full indices, of x_i with all that
goes with it. With x_i last it is what the others leave of x_i: the independent indices. Each are
the first-order and total Sobol' index of that part (Mara and Tarantola 2012, doi
10.1016/j.ress.2011.08.008; Mara, Tarantola and Annoni 2015, doi 10.1016/j.envsoft.2015.07.010).
The order of the other inputs plays no part.

With standard normal scores z of correlation R, and Q = R^-1, exchanging that part between two
points A and B moves the scores of A by

    R_.i (z_i^B - z_i^A)                  of the full indices,
    u_i ((Q z^B)_i - (Q z^A)_i) / Q_ii    of the independent ones, u_i the unit vector,

so all 4 d indices come from the 4 d + 2 sets of points of one pick-freeze scheme. For independent
inputs both pairs are the Sobol' indices.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr
from scipy import special

from surrogate.estimator import Array
from surrogate.sensitivity.draws import Measure, spread
from surrogate.sensitivity.independence import require_no_constraints, takes_correlated
from surrogate.sensitivity.model import Analysed, Seed, model
from surrogate.sensitivity.pick_freeze import Mixing, pick_freeze
from surrogate.sensitivity.table import Q2_NEEDED, Estimate, Variables, dataset
from surrogate.space.space import Space

KINDS = ("full", "independent")


@takes_correlated
def dependent_sobol(
    fit: Analysed,
    space: Space,
    *,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**14,
    scramblings: int = 8,
    draws: int = 50,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """Sobol' indices of correlated parameters: of each with, and without what goes with it.

    Arguments as for `sobol`. Variables `full_first_order`, `full_total` (the parameter with all
    that depends on it), `independent_first_order` and `independent_total` (what is its own),
    each with `_low`, `_high`, `_sampling`, `_surrogate`. They do not sum to 1; Shapley effects do.
    Raises `StudyError` for parameters that constraints join.
    """
    require_no_constraints(space, "dependent_sobol")
    one = model(fit, space, q2=q2)
    mixing = rosenblatt(space)
    found = pick_freeze(
        one.predict,
        space,
        mixing=mixing,
        samples=samples,
        scramblings=scramblings,
        confidence=confidence,
        seed=seed,
    )
    measure = Measure(space, seed=seed, mixing=mixing)
    spreads = spread(one, measure, draws=draws, confidence=confidence, seed=seed)
    variables: Variables = {}
    for k, kind in enumerate(KINDS):
        own = slice(k * space.size, (k + 1) * space.size)
        for name, part in zip(("first_order", "total"), spreads[:2], strict=True):
            value, half = getattr(found, name)[own], found.half[name][own]
            estimate = Estimate(value, half, part.below[own], part.above[own])
            variables |= estimate.columns(f"{kind}_{name}", ("parameter",), (0.0, 1.0))
    return dataset(
        one,
        variables,
        method="dependent_sobol",
        confidence=confidence,
        q2_needed=q2_needed,
        computed="sampling",
        surrogate_part=spreads[0].how,
    )


def rosenblatt(space: Space) -> Mixing:
    """Exchanges each input with all that goes with it, then what is each input's own."""
    d = space.size
    R = np.eye(d) if space.correlation is None else np.asarray(space.correlation, dtype=float)
    Q = np.linalg.inv(R)
    parts = np.vstack([np.eye(d), Q / Q.diagonal()[:, None]])  # z -> z_i, and what is i's own
    moves = np.vstack([R, np.eye(d)])

    def of(u: Array) -> Iterator[Array]:
        root = np.linalg.cholesky(R).T
        a, b = (special.ndtri(half) @ root for half in (u[:, :d], u[:, d:]))
        shifts = (b - a) @ parts.T
        yield from (_coded(space, z) for z in (a, b))
        for z, sign in ((a, 1.0), (b, -1.0)):
            for k, move in enumerate(moves):
                yield _coded(space, z + sign * np.outer(shifts[:, k], move))

    return Mixing(2 * d, of)


def _coded(space: Space, scores: Array) -> Array:
    """Coded points (run, parameter) of dependent standard normal scores."""
    u = np.clip(special.ndtr(scores), 1e-16, 1.0 - 1e-16)
    return Space(space.parameters).quantile(u)
