"""Co-kriging of two levels of fidelity: solver seconds at equal RMSE, beside SMT's MFK.

    python benchmarks/fidelity.py [forrester park borehole currin bandage]

Pairs: Forrester, Sobester and Keane 2007; Park 1991, borehole and Currin et al. 1988 with the
cheap versions of Xiong, Qian and Wu 2013 (Surjanovic and Bingham, Virtual Library of Simulation
Experiments). A cheap run is taken to cost a tenth of a true one. The bandage: the runs that ship
with studies/bandage_fidelity.yaml, with the measured medians of their seconds; its held-out runs
are the test design, and the medium points that a size leaves out.

Designs of n true runs are nested in 5 n cheap ones (bandage: as many coarse ones as said). A
Gaussian process alone gets maximin Latin hypercubes of more and more true runs, and its seconds
at the RMSE of co-kriging are interpolated in the logarithms. Medians over seeds.

    pair (true + cheap runs)   seconds   RMSE ours, SMT   one level needs   saved
    forrester  4 + 20               60   0.136, 0.141               163 s    63 %
    currin     6 + 30               90   0.307, 0.257               222 s    60 %
    currin    12 + 60              180   0.100, 0.139               394 s    54 %
    park       8 + 40              120   0.137, 0.173               144 s    17 %
    park      16 + 80              240   0.056, 0.060               178 s   -35 %
    borehole  12 + 60              180   1.27, 0.92                 505 s    64 %
    borehole  20 + 100             300   0.50, 0.34                 918 s    67 %
    bandage    8 + 32              685   1.31, 1.35 mmHg            950 s    28 %
    bandage   12 + 60             1145   1.07, 1.08 mmHg           1110 s    -3 %
    bandage   24 + 152            2603   0.33, 0.27 mmHg        over 1117 s (24 medium runs: 1.06)

Co-kriging pays where true runs are too few to see the shape, and costs where the truth alone is
smooth (Park). A coarse run of the bandage costs a fifth of a medium one: twice the share.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from surrogate import Study
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.nested import nested
from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.level_process import LevelRuns
from surrogate.runs import dataset as rundata
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

Array = np.ndarray
Function = Callable[[Array], Array]
RATIO, CHEAP, SEEDS = 10.0, 5, 3


def forrester(u: Array) -> Array:
    x = u[:, 0]
    return (6 * x - 2) ** 2 * np.sin(12 * x - 4)


def forrester_cheap(u: Array) -> Array:
    return 0.5 * forrester(u) + 10 * (u[:, 0] - 0.5) - 5


def park(u: Array) -> Array:
    a, b, c, d = np.clip(u, 1e-9, 1).T
    return a / 2 * (np.sqrt(1 + (b + c**2) * d / a**2) - 1) + (a + 3 * d) * np.exp(1 + np.sin(c))


def park_cheap(u: Array) -> Array:
    a, b, c, _ = u.T
    return (1 + np.sin(a) / 10) * park(u) - 2 * a + b**2 + c**2 + 0.5


def currin(u: Array) -> Array:
    a, b = u[:, 0], np.maximum(u[:, 1], 1e-9)
    top = 2300 * a**3 + 1900 * a**2 + 2092 * a + 60
    return (1 - np.exp(-1 / (2 * b))) * top / (100 * a**3 + 500 * a**2 + 4 * a + 20)


def currin_cheap(u: Array) -> Array:
    corners = [
        currin(np.column_stack([u[:, 0] + i, np.maximum(u[:, 1] + j, 0.0)]))
        for i in (-0.05, 0.05)
        for j in (-0.05, 0.05)
    ]
    return np.mean(corners, axis=0)


def _well(u: Array, factor: float, one: float) -> Array:
    low = np.array([0.05, 100, 63070, 990, 63.1, 700, 1120, 9855])
    high = np.array([0.15, 50000, 115600, 1110, 116, 820, 1680, 12045])
    rw, r, tu, hu, tl, hl, length, kw = (low + u * (high - low)).T
    log = np.log(r / rw)
    return factor * tu * (hu - hl) / (log * (one + 2 * length * tu / (log * rw**2 * kw) + tu / tl))


def borehole(u: Array) -> Array:
    return _well(u, 2 * np.pi, 1.0)


def borehole_cheap(u: Array) -> Array:
    return _well(u, 5.0, 1.5)


PAIRS: dict[str, tuple[int, Function, Function, tuple[int, ...], tuple[int, ...]]] = {
    "forrester": (1, forrester_cheap, forrester, (4, 6), (4, 6, 8, 10, 14, 20)),
    "park": (4, park_cheap, park, (8, 16), (10, 20, 40, 80)),
    "borehole": (8, borehole_cheap, borehole, (12, 20), (15, 30, 60, 120)),
    "currin": (2, currin_cheap, currin, (6, 12), (8, 16, 32, 64)),
}


def rmse(predicted: Array, values: Array) -> float:
    return float(np.sqrt(np.mean((predicted - values) ** 2)))


def smt(x: Array, low: Array, t: Array, high: Array, new: Array) -> Array:
    from smt.applications import MFK

    model = MFK(theta0=[0.1] * x.shape[1], corr="matern52", n_start=1, print_global=False)
    model.set_training_values(x, low[:, None], name=0)
    model.set_training_values(t, high[:, None])
    model.train()
    return model.predict_values(new)[:, 0]


def both(x: Array, low: Array, t: Array, high: Array, new: Array, truth: Array) -> list[float]:
    """RMSE of our co-kriging and of SMT's."""
    ours = CoKriging(lower=[LevelRuns(x, low)]).fit(t, high).predict(new)
    return [rmse(ours, truth), rmse(smt(x, low, t, high, new), truth)]


def seconds_at(error: float, seconds: Array, errors: Array) -> float:
    """Seconds at which falling errors reach `error`; infinity when they do not."""
    falling = np.minimum.accumulate(errors)
    if error < falling[-1]:
        return np.inf
    order = np.argsort(falling)
    return float(np.exp(np.interp(np.log(error), np.log(falling)[order], np.log(seconds)[order])))


Sizes = list[tuple[str, float, list[float]]]


def told(name: str, sizes: Sizes, alone: list[tuple[float, float]]) -> None:
    """Print what each size costs, reaches, and saves."""
    alone = sorted(dict(alone).items())
    seconds, errors = np.array(alone).T
    print(f"\n{name}\n  one level: " + ", ".join(f"{s:.0f} s {e:.3g}" for s, e in alone))
    for label, cost, (ours, theirs) in sizes:
        equal = seconds_at(ours, seconds, errors)
        saved = "more than any here" if np.isinf(equal) else f"{1 - cost / equal:.0%} saved"
        limit = f"{seconds[-1]:.0f} s or more" if np.isinf(equal) else f"{equal:.0f} s"
        print(
            f"  {label}, {cost:.0f} s: RMSE {ours:.3g}, SMT {theirs:.3g}; one level needs {limit}"
            f" ({saved})"
        )


def public(name: str) -> None:
    size, cheap, truth, few, many = PAIRS[name]
    space = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(size)))
    new = space.sample(1000, seed=99)

    def u(coded: Array) -> Array:
        return (coded + 1) / 2

    target, sizes, alone = truth(u(new)), [], []
    for n in few:
        errors = []
        for seed in range(SEEDS):
            rows = nested(space, runs={"cheap": CHEAP * n, "true": n}, seed=seed)
            x, t = rows[: CHEAP * n], rows[CHEAP * n :]
            errors.append(both(x, cheap(u(x)), t, truth(u(t)), new, target))
        cost = n * RATIO + CHEAP * n
        sizes.append((f"{n} + {CHEAP * n} runs", cost, np.median(errors, axis=0).tolist()))
    for n in many:
        errors = []
        for seed in range(SEEDS):
            t = latin_hypercube(space, runs=n, seed=seed)
            errors.append(rmse(GaussianProcess().fit(t, truth(u(t))).predict(new), target))
        alone.append((n * RATIO, float(np.median(errors))))
    told(name, sizes, alone)


def bandage() -> None:
    root = Path(__file__).parents[1]
    study = Study.from_yaml(root / "studies/bandage_fidelity.yaml")
    runs, output = study.stored(), "pressure_b1"
    x, low = rundata.training(runs, output, ["pairs"], "coarse")
    t, high = rundata.training(runs, output, ["pairs"])
    new, target = rundata.training(runs, output, ["test"])
    each = [
        float(np.nanmedian(rundata.at_level(runs, name)["seconds"].values))
        for name in ("coarse", "medium")
    ]
    sizes, alone = [], []
    for n, fill in ((8, 24), (8, 56), (12, 48), (16, 48), (24, 128)):
        ours, single = [], []
        for seed in range(SEEDS):
            order = np.random.default_rng(seed).permutation(len(t))
            own, rest = order[:n], order[n:]
            points, values = np.vstack([new, t[rest]]), np.concatenate([target, high[rest]])
            # the coarse runs at the medium points and the first of the Sobol' sequence; none at
            # left-out medium points
            apart = np.abs(x[:, None] - t).max(axis=2) < 1e-9
            kept = apart[:, own].any(axis=1)
            kept[np.flatnonzero(~apart.any(axis=1))[:fill]] = True
            ours.append(both(x[kept], low[kept], t[own], high[own], points, values))
            alone_fit = GaussianProcess().fit(t[own], high[own])
            single.append(rmse(alone_fit.predict(points), values))
        cost = n * each[1] + (fill + n) * each[0]
        sizes.append((f"{n} + {fill + n} runs", cost, np.median(ours, axis=0).tolist()))
        alone.append((n * each[1], float(np.median(single))))
    told(f"bandage (a coarse run {each[0]:.1f} s, a medium one {each[1]:.1f} s)", sizes, alone)


if __name__ == "__main__":
    for wanted in sys.argv[1:] or [*PAIRS, "bandage"]:
        bandage() if wanted == "bandage" else public(wanted)
