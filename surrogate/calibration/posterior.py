"""What was found: draws of all unknowns, how good they are, and what they say."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.calibration.priors import Unknown
from surrogate.calibration.problem import Problem
from surrogate.calibration.tested import Tested

Array = NDArray[np.float64]

#: Ends of the intervals that are told.
TAILS = (0.025, 0.975)
ENDS = ("mean", "low", "high")
#: Measurements say almost nothing about an input where they reduce the prior's variance by less.
TAUGHT = 0.1
#: A posterior piles up at an end when more than this share of it lies in the outermost `EDGE` of
#: the prior's range, and `TIMES` the share that the prior has there.
PILED, EDGE, TIMES = 0.1, 0.02, 4.0


@dataclass(frozen=True, eq=False)
class Posterior:
    """Draws of all unknowns.

    tree        groups as ArviZ has them: posterior, prior, sample_stats, log_likelihood,
                posterior_predictive, observed_data, constant_data
    figures     dataset over `unknown`: moments, intervals, shrinkage, R-hat, effective sizes
    surrogates  output -> surrogate that predicts it
    notes       sentences that a reader should know
    tested      what the solver says at draws, an entry an output; empty where it was not asked
    """

    problem: Problem
    unknowns: tuple[Unknown, ...]
    tree: xr.DataTree
    figures: xr.Dataset
    surrogates: Mapping[str, str]
    notes: tuple[str, ...] = ()
    tested: tuple[Tested, ...] = ()

    def draws(self, name: str, group: str = "posterior") -> Array:
        """All draws (draw,) of an unknown."""
        return np.asarray(self.tree[group][name].values).ravel()

    @property
    def convergence(self) -> str:
        """R-hat and effective sample size of the worst unknown, in a sentence."""
        found = self.figures
        size = float(np.minimum(found["ess_bulk"], found["ess_tail"]).min())
        state = "converged" if found.attrs["converged"] else "did not converge"
        return (
            f"Sampling {state}: R-hat is {float(found['r_hat'].max()):.3f} at most and the "
            f"effective sample size {size:.0f} at least "
            f"({found.attrs['walkers']} walkers of {found.attrs['steps']} steps)."
        )

    def __str__(self) -> str:
        """The result in a sentence."""
        told = []
        for name in self.problem.free:
            at = self.figures.sel(unknown=name)
            unit = f" {self.problem.space[name].unit}".rstrip()
            mean, low, high = rounded(float(at["sd"]), *(float(at[key]) for key in ENDS))
            told.append(f"{name} = {mean}{unit} [{low}, {high}]")
        return (
            f"Posterior mean and 95 % interval from {len(self.problem.labels)} cases: "
            f"{'; '.join(told)}."
        )


def rounded(sd: float, *values: float) -> list[str]:
    """Values with so many decimals that a standard deviation has two significant digits."""
    decimals = 1 - math.floor(math.log10(sd)) if sd > 0.0 else 6
    return [f"{round(value, decimals):.{max(decimals, 0)}f}" for value in values]


def figures_of(
    unknowns: tuple[Unknown, ...],
    drawn: Mapping[str, Array],
    prior: Mapping[str, Array],
    r_hat: Array,
    bulk: Array,
    tail: Array,
) -> xr.Dataset:
    """The figures of draws (draw,) of each unknown, beside draws of its prior.

    shrinkage: 1 - variance of the posterior / variance of the prior.
    """
    rows = [_row(drawn[one.name], prior[one.name]) for one in unknowns]
    columns = {key: ("unknown", np.array([row[key] for row in rows])) for key in rows[0]}
    columns |= {
        "r_hat": ("unknown", r_hat),
        "ess_bulk": ("unknown", bulk),
        "ess_tail": ("unknown", tail),
        "units": ("unknown", np.array([one.unit for one in unknowns], dtype=str)),
        "prior": ("unknown", np.array([str(one.prior) for one in unknowns], dtype=str)),
        "about": ("unknown", np.array([one.about for one in unknowns], dtype=str)),
    }
    return xr.Dataset(columns, {"unknown": [one.name for one in unknowns]})


def _row(drawn: Array, prior: Array) -> dict[str, float]:
    low, median, high = np.quantile(drawn, (TAILS[0], 0.5, TAILS[1])).tolist()
    before = np.quantile(prior, TAILS).tolist()
    return {
        "mean": float(drawn.mean()),
        "sd": float(drawn.std(ddof=1)),
        "low": low,
        "median": median,
        "high": high,
        "prior_mean": float(prior.mean()),
        "prior_sd": float(prior.std(ddof=1)),
        "prior_low": before[0],
        "prior_high": before[1],
        "shrinkage": 1.0 - float(drawn.var(ddof=1) / prior.var(ddof=1)),
    }


def untaught(problem: Problem, figures: xr.Dataset) -> list[str]:
    """A sentence for each free input of which the measurements say almost nothing."""
    shares = {name: float(figures["shrinkage"].sel(unknown=name)) for name in problem.free}
    return [
        f"{name}: the measurements say almost nothing about it (they reduced the prior's variance "
        f"by {100.0 * max(share, 0.0):.0f} %); its interval is nearly that of its prior. Add "
        "measurements of outputs that it changes, or leave it at its nominal value."
        for name, share in shares.items()
        if share < TAUGHT
    ]


def piled_up(problem: Problem, drawn: Mapping[str, Array], prior: Mapping[str, Array]) -> list[str]:
    """A sentence for each free input whose posterior piles up at an end of its range."""
    said = []
    for name in problem.free:
        law, unit = problem.priors[name], problem.space[name].unit
        if not law.bounded:
            continue
        low, high = law.support
        for end, sign, word in ((low, 1.0, "lower"), (high, -1.0, "upper")):
            near = [
                float((sign * (values - end) <= EDGE * (high - low)).mean())
                for values in (drawn[name], prior[name])
            ]
            if near[0] > PILED and near[0] > TIMES * near[1]:
                said.append(
                    f"{name}: {100 * near[0]:.0f} % of the posterior lies at the {word} end of its "
                    f"range ({end:.4g} {unit}".rstrip()
                    + "). The measurements ask for values beyond it: widen the range, or ask what "
                    "the model lacks (discrepancy: true)."
                )
    return said
