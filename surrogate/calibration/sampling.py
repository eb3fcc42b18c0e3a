"""Draws from the posterior: an ensemble of walkers, watched until it has converged.

Affine invariant stretch moves (Goodman and Weare 2010) and differential evolution moves (ter Braak
2006) of `emcee` (Foreman-Mackey et al. 2013), all walkers at once. The walk is doubled, its first
half dropped, until the effective sample sizes of every unknown, of the bulk and of the tails, reach
what is asked and its split R-hat is below 1.05: rank normalised, a chain a walker (Vehtari et al.
2021, by ArviZ). R-hat of many short chains is about 1 + 1 / (2 m), m effective draws a half chain,
so that 1.05 with 32 walkers stands for 640 effective draws; it shows walkers that are stuck.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.counting import counting
from surrogate.errors import StudyError

Array = NDArray[np.float64]
LogDensity = Callable[[Array], Array]

#: Effective draws of each unknown, and largest R-hat.
EFFECTIVE, R_HAT = 400, 1.05
#: Quantiles whose effective sample size is that of the tails.
TAILS = (0.05, 0.95)
#: Steps of the first walk, and of the longest one.
FIRST, LONGEST = 512, 32_768
#: Walkers: at least so many, and so many for each unknown.
WALKERS, EACH = 32, 6
#: Points of the prior from which a walker's start is chosen.
STARTS = 64

MISSING = (
    "calibration needs emcee and arviz; install them: pip install 'surrogate-studies[calibration]'"
)


@dataclass(frozen=True, eq=False)
class Chains:
    """Draws z (chain, draw, unknown) with their log posterior (chain, draw).

    r_hat, bulk, tail  (unknown,) split R-hat and effective sample sizes
    steps              of each walker, the dropped ones included
    acceptance         share of accepted moves
    """

    z: Array
    log_posterior: Array
    r_hat: Array
    bulk: Array
    tail: Array
    steps: int
    acceptance: float
    effective: int

    @property
    def converged(self) -> bool:
        """True when every unknown has the effective draws that were asked for."""
        return _enough(self.r_hat, np.minimum(self.bulk, self.tail), self.effective)


def check_installed() -> None:
    """Raise `StudyError` where emcee or ArviZ is not installed."""
    if find_spec("emcee") is None or find_spec("arviz") is None:
        raise StudyError(MISSING)


def arviz() -> ModuleType:
    """ArviZ, without the notice that it is being rewritten."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)
        import arviz

    return arviz


def sample(
    log_prior: LogDensity,
    log_likelihood: LogDensity,
    size: int,
    *,
    seed: int = 0,
    effective: int = EFFECTIVE,
    longest: int = LONGEST,
) -> Chains:
    """Draws of `size` coordinates that are standard normal a priori; densities take (w, size)."""
    import emcee

    def log_posterior(z: Array) -> Array:
        prior = log_prior(z)
        inside = np.flatnonzero(np.isfinite(prior))
        found = np.full(len(z), -np.inf)
        if len(inside):
            found[inside] = prior[inside] + log_likelihood(z[inside])
        return found

    walkers = max(WALKERS, EACH * size)
    rng = np.random.default_rng(seed)
    state: Any = starts(log_prior, log_likelihood, size, walkers, rng)
    sampler = emcee.EnsembleSampler(
        walkers,
        size,
        log_posterior,
        vectorize=True,
        moves=[(emcee.moves.StretchMove(), 0.5), (emcee.moves.DEMove(), 0.5)],
    )
    sampler.random_state = np.random.RandomState(seed).get_state()
    steps = min(FIRST, longest)
    with counting(int(np.log2(max(longest // steps, 1))) + 1) as begin:
        while True:
            begin(f"walk of {steps} steps")
            state = sampler.run_mcmc(
                state, steps - sampler.iteration, skip_initial_state_check=True
            )
            kept = sampler.get_chain(discard=steps // 2).swapaxes(0, 1)
            figures = diagnosed(kept)
            done = _enough(figures[0], np.minimum(figures[1], figures[2]), effective)
            if done or 2 * steps > longest:
                break
            steps *= 2
    return Chains(
        kept,
        sampler.get_log_prob(discard=steps // 2).T,
        *figures,
        steps,
        float(sampler.acceptance_fraction.mean()),
        effective,
    )


def _enough(r_hat: Array, ess: Array, effective: int) -> bool:
    return bool((r_hat < R_HAT).all() and (ess >= effective).all())


def diagnosed(z: Array) -> tuple[Array, Array, Array]:
    """Split R-hat and effective sample sizes of bulk and tails (unknown,) of z (chain, draw, k)."""
    az = arviz()
    columns = np.moveaxis(z, 2, 0)
    return (
        np.array([float(az.rhat(one)) for one in columns]),
        np.array([float(az.ess(one, method="bulk")) for one in columns]),
        np.array([float(az.ess(one, method="tail", prob=TAILS)) for one in columns]),
    )


def starts(
    log_prior: LogDensity,
    log_likelihood: LogDensity,
    size: int,
    walkers: int,
    rng: np.random.Generator,
) -> Array:
    """Coordinates (walkers, size) drawn from prior times a power of the likelihood.

    The power is the largest up to 1 with which draws of the prior still stand for four times the
    walkers: wider than the posterior, and no walker so far off that it never arrives.
    Raises `StudyError` when no draw of the prior keeps the constraints.
    """
    z = rng.standard_normal((STARTS * walkers, size))
    z = z[np.isfinite(log_prior(z))]
    logs = np.concatenate([log_likelihood(part) for part in np.array_split(z, STARTS)])
    z, logs = z[np.isfinite(logs)], logs[np.isfinite(logs)]
    if len(z) < walkers:
        raise StudyError(
            "calibration: hardly any draw of the prior keeps the constraints of the study at all "
            "cases; widen the prior or drop cases"
        )
    weights = _tempered(logs - logs.max(), min(4 * walkers, 0.5 * len(z)))
    chosen = rng.choice(len(z), walkers, replace=False, p=weights)
    return np.asarray(z[chosen])


def _tempered(logs: Array, effective: float) -> Array:
    """Weights exp(power * logs), normalised, that stand for `effective` draws (Kish 1965)."""

    def weights(power: float) -> Array:
        found = np.exp(power * logs) + 1e-12
        return np.asarray(found / found.sum())

    low, high = 0.0, 1.0
    if 1.0 / (weights(high) ** 2).sum() >= effective:
        return weights(high)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if 1.0 / (weights(middle) ** 2).sum() >= effective:
            low = middle
        else:
            high = middle
    return weights(low)
