"""Calibration: what measurements say about inputs."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from surrogate.calibration.posterior import Posterior
from surrogate.calibration.tested import Tested, sentence
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

#: Pairs of free inputs that are drawn at most.
PAIRS = 6
HEADS = (
    "posterior mean (95 % interval)",
    "standard deviation",
    "prior standard deviation",
    "shrinkage",
    "R-hat",
    "effective sample size",
)
MEANING = (
    "Shrinkage: share of the prior's variance that the measurements took away; near 0 they say "
    "nothing about this unknown, below 0 it is wider than before. R-hat: near 1 when all walkers "
    "agree (split and rank normalised). Effective sample size: the smaller of bulk and tails "
    "(Vehtari et al. 2021). The surrogate's own error is part of the likelihood."
)


def section(found: Posterior) -> Section:
    """The answer, warnings, the unknowns, their posteriors, and the measurements."""
    blocks: list[Block] = [Text(str(found), "lead"), Text(f"{_how(found)} {found.convergence}")]
    if found.tested:
        blocks.append(Text(sentence(found.tested)))
    if found.notes:
        blocks.append(Points(found.notes, "warning"))
    blocks += [
        _table(found),
        Figures(tuple(_marginal(found, one.name, one.unit) for one in found.unknowns)),
    ]
    pairs = list(combinations(found.problem.free, 2))[:PAIRS]
    if pairs:
        blocks += [
            Heading("Pairs of free inputs", "calibration-pairs"),
            Figures(tuple(_pair(found, *pair) for pair in pairs)),
        ]
    blocks += [
        Heading("Measurements and what the posterior expects", "calibration-cases"),
        Figures(tuple(_predictive(found, k) for k in range(len(found.problem.measured)))),
        Fold("Definitions", (Text(MEANING),)),
    ]
    return Section("calibration", "What measurements say about inputs", tuple(blocks))


def _how(found: Posterior) -> str:
    problem = found.problem
    cases = digits.quantity(len(problem.labels), "case")
    by = digits.listing(f"{name} by {one}" for name, one in found.surrogates.items())
    more = (
        "Reality may differ from the solver by a discrepancy, which is estimated too."
        if problem.discrepancy
        else "Reality is taken to be the solver plus error of measurement; discrepancy: true asks "
        "whether it is."
    )
    return f"{cases} from {problem.cases or 'the measurements'}; {by}. {more}"


def _table(found: Posterior) -> Table:
    rows = []
    for one in found.unknowns:
        at = {key: float(found.figures[key].sel(unknown=one.name)) for key in _NUMBERS}
        size = min(at["ess_bulk"], at["ess_tail"])
        rows.append(
            (
                Cell(digits.labelled(one.name, one.unit)),
                Cell(digits.with_interval(at["mean"], at["low"], at["high"]), at["mean"], "strong"),
                Cell(digits.number(at["sd"], 3), at["sd"]),
                Cell(digits.number(at["prior_sd"], 3), at["prior_sd"]),
                Cell(digits.fixed(at["shrinkage"], 2), at["shrinkage"]),
                Cell(digits.fixed(at["r_hat"], 3), at["r_hat"]),
                Cell(f"{size:.0f}", size),
                Cell(str(one.prior)),
            )
        )
    heads = (Head("unknown", numeric=False), *map(Head, HEADS), Head("prior", numeric=False))
    return Table("All unknowns, the free inputs first.", heads, tuple(rows), wide=True)


_NUMBERS = ("mean", "low", "high", "sd", "prior_sd", "shrinkage", "r_hat", "ess_bulk", "ess_tail")


def _marginal(found: Posterior, name: str, unit: str) -> Figure:
    drawing = marginal_plot(name, unit, found.draws(name), found.draws(name, "prior"))
    return Figure(drawing, f"{name}: posterior (filled) and prior (dashed).")


def _pair(found: Posterior, first: str, second: str) -> Figure:
    units = tuple(found.problem.space[name].unit for name in (first, second))
    drawing = pair_plot(
        (first, second), (units[0], units[1]), (found.draws(first), found.draws(second))
    )
    return Figure(drawing, f"Draws of the posterior of {first} and {second}.")


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
