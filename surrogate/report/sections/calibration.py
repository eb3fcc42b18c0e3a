"""Calibration: what measurements say about inputs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from surrogate.calibration.posterior import ENDS, Posterior
from surrogate.calibration.priors import Unknown
from surrogate.calibration.tested import Tested
from surrogate.report import digits
from surrogate.report.blocks import (
    Block,
    Cell,
    Figure,
    Figures,
    Fold,
    Head,
    Heading,
    Points,
    Section,
    Table,
    Text,
)
from surrogate.report.figures.posterior import marginal_plot, pair_plot, predictive_plot

TITLE = "What measurements say about inputs"
#: Figures of an unknown in the tables.
BEFORE_AND_AFTER = (*ENDS, "prior_mean", "prior_low", "prior_high", "shrinkage")
QUALITY = ("r_hat", "ess_bulk", "ess_tail")
#: Pairs of free inputs that are drawn at most.
PAIRS = 6
#: Correlation beyond which the report says that a combination of two inputs is known best.
TIED = 0.7
MEANING = (
    "Shrinkage: by which share the measurements reduced the prior's variance; near 0 they say "
    "nothing about this unknown, below 0 it is less certain than before. R-hat: near 1 when all "
    "walkers agree (split and rank normalised). Effective sample size: the smaller of bulk and "
    "tails (Vehtari et al. 2021). The surrogate's own error is part of the likelihood."
)


def section(found: Posterior) -> Section:
    """The answer, warnings, what the solver says to it, the free inputs, the measurements."""
    free, others = _split(found)
    blocks: list[Block] = [Text(answer(found), "lead"), Text(f"{_how(found)} {found.convergence}")]
    if found.notes:
        blocks.append(Points(found.notes, "warning"))
    blocks += [_table(found, free), Figures(tuple(_marginal(found, one) for one in free))]
    pairs = list(combinations(found.problem.free, 2))[:PAIRS]
    if pairs:
        blocks += [
            Heading("Pairs of free inputs", "calibration-pairs"),
            Figures(tuple(_pair(found, *pair) for pair in pairs)),
        ]
    blocks.append(Heading("Measurements and what the posterior expects", "calibration-cases"))
    if found.tested:
        blocks.append(_solver_table(found.tested))
    blocks.append(Figures(tuple(_predictive(found, k) for k in range(len(found.problem.measured)))))
    if others:
        title = "Error of measurement and discrepancy"
        shown = Figures(tuple(_marginal(found, one) for one in others))
        blocks.append(Fold(title, (_table(found, others), shown)))
    blocks.append(Fold("Sampling", (_sampling(found), Text(MEANING))))
    return Section("calibration", TITLE, tuple(blocks))


def answer(found: Posterior) -> str:
    """The free inputs in a sentence."""
    told = []
    for name in found.problem.free:
        mean, low, high = (float(found.figures[key].sel(unknown=name)) for key in ENDS)
        words = digits.with_interval(mean, low, high)
        unit = digits.unit(found.problem.space[name].unit)
        told.append(f"{name} {words} {unit}".rstrip())
    cases = digits.quantity(len(found.problem.labels), "case")
    return f"From measurements of {cases}: {'; '.join(told)} (posterior mean, 95 % interval)."


def _split(found: Posterior) -> tuple[list[Unknown], list[Unknown]]:
    """The free inputs, and the other unknowns."""
    free = [one for one in found.unknowns if one.name in found.problem.free]
    return free, [one for one in found.unknowns if one.name not in found.problem.free]


def _how(found: Posterior) -> str:
    problem = found.problem
    by = digits.listing(f"{name} by {one}" for name, one in found.surrogates.items())
    more = (
        "Reality may differ from the solver by a discrepancy, which is estimated too."
        if problem.discrepancy
        else "Reality is taken to be the solver plus error of measurement; discrepancy: true asks "
        "whether it is."
    )
    return f"Measurements: {problem.cases or 'given'}. Surrogates: {by}. {more}"


def _table(found: Posterior, unknowns: Sequence[Unknown]) -> Table:
    """What is known of these unknowns after and before the measurements."""
    rows = []
    for one in unknowns:
        at = {key: float(found.figures[key].sel(unknown=one.name)) for key in BEFORE_AND_AFTER}
        after = digits.with_interval(at["mean"], at["low"], at["high"])
        before = digits.with_interval(at["prior_mean"], at["prior_low"], at["prior_high"])
        rows.append(
            (
                Cell(digits.labelled(one.name, one.unit)),
                Cell(after, at["mean"], "strong"),
                Cell(before, at["prior_mean"]),
                Cell(digits.fixed(at["shrinkage"], 2), at["shrinkage"]),
            )
        )
    heads = (
        Head("unknown", numeric=False),
        Head("after the measurements", numeric=False),
        Head("before", numeric=False),
        Head("shrinkage"),
    )
    return Table("Mean and 95 % interval, posterior and prior.", heads, tuple(rows))


def _sampling(found: Posterior) -> Table:
    """How good the draws of each unknown are, and its prior."""
    rows = []
    for one in found.unknowns:
        at = {key: float(found.figures[key].sel(unknown=one.name)) for key in QUALITY}
        size = min(at["ess_bulk"], at["ess_tail"])
        rows.append(
            (
                Cell(digits.labelled(one.name, one.unit)),
                Cell(digits.fixed(at["r_hat"], 3), at["r_hat"]),
                Cell(f"{size:.0f}", size),
                Cell(str(one.prior)),
            )
        )
    heads = (
        Head("unknown", numeric=False),
        Head("R-hat"),
        Head("effective sample size"),
        Head("prior", numeric=False),
    )
    return Table("Draws of each unknown.", heads, tuple(rows))


def _solver_table(tested: tuple[Tested, ...]) -> Table:
    """What runs of the solver at draws of the posterior say."""
    rows = tuple(
        (
            Cell(digits.labelled(one.output, one.unit)),
            Cell(digits.figure(one.off, 2), one.off),
            Cell(f"{one.inside} of {len(one.solver)}", one.inside),
            Cell(digits.figure(one.away, 2), one.away),
            Cell(digits.figure(one.expected, 2), one.expected),
        )
        for one in tested
    )
    heads = (
        Head("output", numeric=False),
        Head("from the surrogate (RMS)"),
        Head("inside its 95 % interval", numeric=False),
        Head("from the measurements (RMS)"),
        Head("expected of the error of measurement" + " and discrepancy" * tested[0].discrepancy),
    )
    runs = digits.quantity(len(tested[0].solver), "draw")
    caption = f"The solver was run at {runs} of the posterior: how far it is"
    return Table(f"{caption} from the surrogate and from the measurements.", heads, rows)


def _marginal(found: Posterior, one: Unknown) -> Figure:
    drawn = found.draws(one.name), found.draws(one.name, "prior")
    about = "" if one.about == one.name else f", {one.about}"
    return Figure(
        marginal_plot(one.name, one.unit, *drawn),
        f"{one.name}{about}: posterior (filled) and prior (dashed).",
    )


def _pair(found: Posterior, first: str, second: str) -> Figure:
    units = tuple(found.problem.space[name].unit for name in (first, second))
    drawing = pair_plot(
        (first, second), (units[0], units[1]), (found.draws(first), found.draws(second))
    )
    r = float(np.corrcoef(found.draws(first), found.draws(second))[0, 1])
    more = "; a combination of them is known better than each of them" if abs(r) > TIED else ""
    return Figure(
        drawing, f"Draws of {first} and {second}: correlation {digits.fixed(r, 2)}{more}."
    )


def _predictive(found: Posterior, k: int) -> Figure:
    one = found.problem.measured[k]
    rows = np.flatnonzero(one.known)
    group = found.tree["posterior_predictive"]
    replicates, solver = (
        np.asarray(group[name].values).reshape(-1, len(one.values))[:, rows]
        for name in (one.output, f"{one.output}_solver")
    )
    labels = [found.problem.labels[row] for row in rows]
    ran = _ran(found.tested[k], rows) if found.tested else None
    more = "; hollow: runs of the solver at draws of the posterior" if found.tested else ""
    return Figure(
        predictive_plot(one.output, one.unit, labels, one.values[rows], replicates, solver, ran),
        f"{one.output}: measured (dots), 95 % interval of a new measurement (bars), solver at the "
        f"posterior of the inputs (crosses: mean){more}.",
    )


def _ran(one: Tested, rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Where among `rows` the solver was run, and its values, (pair,) each."""
    return np.searchsorted(rows, one.cases), one.solver[one.rows]
