"""From measurements to the posterior of the free inputs."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import special
from scipy.stats import qmc

from surrogate.calibration import sampling
from surrogate.calibration.emulator import check
from surrogate.calibration.likelihood import Likelihood
from surrogate.calibration.posterior import Posterior, figures_of, piled_up, untaught
from surrogate.calibration.predictive import Told, told
from surrogate.calibration.priors import Coordinates, unknowns
from surrogate.calibration.problem import Problem
from surrogate.calibration.sampling import Chains
from surrogate.errors import StudyError
from surrogate.fitting.comparison import chosen
from surrogate.fitting.fit import Fit

Array = NDArray[np.float64]

#: Draws of the prior, a power of two.
PRIOR_DRAWS = 2**13


def calibrate(
    problem: Problem,
    fits: Mapping[str, Fit],
    *,
    effective: int = sampling.EFFECTIVE,
    longest: int = sampling.LONGEST,
) -> Posterior:
    """The posterior of all unknowns, by fits (output -> fit) of single numbers.

    effective: draws that each unknown is to be worth. longest: steps of a walker at most.
    Raises `StudyError` where emcee or ArviZ is missing, a surrogate does not know its error, or
    the prior breaks the constraints.
    """
    sampling.check_installed()
    for fit in fits.values():
        check(fit)
    likelihood = likelihood_of(problem, fits)
    chains = sample(likelihood, effective=effective, longest=longest)
    return _posterior(likelihood, chains)


def likelihood_of(problem: Problem, fits: Mapping[str, Fit]) -> Likelihood:
    """The likelihood of the problem's measurements."""
    return Likelihood(problem, fits, Coordinates(problem, unknowns(problem, fits)))


def sample(
    likelihood: Likelihood,
    *,
    effective: int = sampling.EFFECTIVE,
    longest: int = sampling.LONGEST,
) -> Chains:
    """Draws of the coordinates of a likelihood."""
    return sampling.sample(
        likelihood.log_prior,
        likelihood.log_likelihood,
        len(likelihood.coordinates.unknowns),
        seed=likelihood.problem.seed,
        effective=effective,
        longest=longest,
    )


def _posterior(likelihood: Likelihood, chains: Chains) -> Posterior:
    problem, coordinates = likelihood.problem, likelihood.coordinates
    kept = _thinned(chains, problem.draws)
    z, shape = kept[0].reshape(-1, kept[0].shape[2]), kept[0].shape[:2]
    drawn, prior = coordinates.values(z), _prior(likelihood)
    cases = told(likelihood, z, problem.seed)
    own = tuple(coordinates.unknowns)
    figures = figures_of(own, drawn, prior, chains.r_hat, chains.bulk, chains.tail)
    figures = figures.assign_attrs(
        steps=chains.steps,
        walkers=shape[0],
        acceptance=chains.acceptance,
        converged=int(chains.converged),
    )
    notes = [*problem.notes, *_unconverged(figures, chains), *untaught(problem, figures)]
    notes += piled_up(problem, drawn, prior)
    surrogates = {name: fit.surrogate for name, fit in likelihood.fits.items()}
    tree = _tree(likelihood, drawn, kept[1], prior, cases, shape)
    return Posterior(problem, own, tree, figures, surrogates, tuple(notes))


def _thinned(chains: Chains, draws: int) -> tuple[Array, Array]:
    """Coordinates and log posterior of about `draws` draws, evenly along every chain."""
    each = min(max(-(-draws // chains.z.shape[0]), 4), chains.z.shape[1])
    kept = np.linspace(0, chains.z.shape[1] - 1, each).round().astype(int)
    return chains.z[:, kept], chains.log_posterior[:, kept]


def _prior(likelihood: Likelihood) -> dict[str, Array]:
    """Draws (draw,) of the prior, of a scrambled Sobol' sequence."""
    size = len(likelihood.coordinates.unknowns)
    u = qmc.Sobol(size, scramble=True, seed=likelihood.problem.seed).random(PRIOR_DRAWS)
    z = special.ndtri(np.clip(u, 1e-12, 1.0 - 1e-12))
    return likelihood.coordinates.values(z[np.isfinite(likelihood.log_prior(z))])


def _unconverged(figures: xr.Dataset, chains: Chains) -> list[str]:
    if chains.converged:
        return []
    small = np.minimum(chains.bulk, chains.tail)
    worst = int(np.argmin(small))
    return [
        f"The walk ended after {chains.steps} steps before it had converged: "
        f"{figures['unknown'].values[worst]} has an effective sample size of {small[worst]:.0f} "
        f"(asked: {chains.effective}) and the largest R-hat is {chains.r_hat.max():.3f} (asked: "
        f"below {sampling.R_HAT:g}). Take intervals as rough; free fewer inputs or give the error "
        "of measurement."
    ]


def _tree(
    likelihood: Likelihood,
    drawn: Mapping[str, Array],
    log_posterior: Array,
    prior: Mapping[str, Array],
    cases: Mapping[str, Told],
    shape: tuple[int, int],
) -> xr.DataTree:
    """Groups over (chain, draw) and (case) as ArviZ has them (InferenceData schema)."""
    problem, chain = likelihood.problem, ("chain", "draw")
    whole = (*chain, "case")
    labels = np.array(problem.labels, dtype=str)
    numbers = {"chain": np.arange(shape[0]), "draw": np.arange(shape[1])}
    here = numbers | {"case": labels}
    described = {
        one.name: {"units": one.unit, "long_name": one.about, "prior": str(one.prior)}
        for one in likelihood.coordinates.unknowns
    }
    units = {one.output: {"units": one.unit} for one in problem.measured}

    def over_cases(found: Mapping[str, Array]) -> dict[str, Any]:
        return {
            name: (whole, values.reshape(*shape, -1), units[name.removesuffix("_solver")])
            for name, values in found.items()
        }

    replicates = {name: one.replicate for name, one in cases.items()}
    replicates |= {f"{name}_solver": one.solver for name, one in cases.items()}
    inputs = problem.space.decode(problem.coded)
    constant: dict[str, Any] = {
        f"at_{name}": ("case", inputs[name], {"units": problem.space[name].unit})
        for name in problem.known
    }
    constant |= {f"{one.output}_error": ("case", one.errors) for one in problem.measured}
    groups = {
        "posterior": xr.Dataset(
            {name: (chain, drawn[name].reshape(shape), words) for name, words in described.items()},
            numbers,
        ),
        "prior": xr.Dataset(
            {name: (chain, prior[name][None], words) for name, words in described.items()},
            {"chain": [0], "draw": np.arange(len(next(iter(prior.values()))))},
        ),
        "sample_stats": xr.Dataset({"lp": (chain, log_posterior)}, numbers),
        "log_likelihood": xr.Dataset(
            {name: (whole, one.likelihood.reshape(*shape, -1)) for name, one in cases.items()},
            here,
        ),
        "posterior_predictive": xr.Dataset(over_cases(replicates), here),
        "observed_data": xr.Dataset(
            {one.output: ("case", one.values, units[one.output]) for one in problem.measured},
            {"case": labels},
        ),
        "constant_data": xr.Dataset(constant, {"case": labels}),
    }
    about = {"inference_library": "emcee", "inference_library_version": version("emcee")}
    groups["posterior"] = groups["posterior"].assign_attrs(about)
    return xr.DataTree.from_dict({f"/{name}": one for name, one in groups.items()})


def fits_for(
    problem: Problem, best: Mapping[str, str], fits: Mapping[str, Mapping[str, Fit]]
) -> dict[str, Fit]:
    """The fit of each measured output; raises `StudyError` where there is none."""
    found, outputs = chosen(problem.surrogate, best, fits), [one.output for one in problem.measured]
    lacking = [output for output in outputs if output not in found]
    if lacking:
        raise StudyError(f"calibration: no surrogate of {', '.join(lacking)}")
    return {output: found[output] for output in outputs}
