"""Co-kriging of two levels of fidelity: solver seconds at equal RMSE, beside SMT's MFK.

    python benchmarks/fidelity.py [forrester park borehole currin bandage fine]

Pairs: Forrester, Sobester and Keane 2007; Park 1991, borehole and Currin et al. 1988 with the
cheap versions of Xiong, Qian and Wu 2013 (Surjanovic and Bingham, Virtual Library of Simulation
Experiments). A cheap run is taken to cost a tenth of a true one. The bandage: the runs that ship
with studies/bandage_fidelity.yaml, with the measured medians of their seconds; its held-out runs
are the test design, and the medium points that a size leaves out.

Designs of n true runs are nested in 5 n cheap ones (bandage: as many coarse ones as said). The
same process alone, without a cheaper level, gets maximin Latin hypercubes of more and more true
runs, and its seconds at the RMSE of co-kriging are interpolated in the logarithms. Medians over
seeds. Beside it the ratio of our errors to SMT's, geometric mean over twelve other designs (random
Latin hypercubes; bandage: the same designs), because small maximin designs are alike whatever
their seed.

    pair (true + cheap runs)   seconds   RMSE ours, SMT   ratio   one level needs   saved
    forrester  4 + 20               60   0.139, 0.141      1.01             162 s    63 %
    forrester  6 + 30               90   0.014, 0.014      1.09             350 s    74 %
    currin     6 + 30               90   0.302, 0.268      0.93             225 s    60 %
    currin    12 + 60              180   0.101, 0.101      0.96             394 s    54 %
    park       8 + 40              120   0.146, 0.173      0.89             149 s    20 %
    park      16 + 80              240   0.056, 0.058      0.97             196 s   -22 %
    borehole  12 + 60              180   0.891, 0.906      1.06             518 s    65 %
    borehole  20 + 100             300   0.350, 0.349      0.99             918 s    67 %
    bandage    8 + 32              685   1.34, 1.35 mmHg   1.00             948 s    28 %
    bandage   12 + 60             1145   1.07, 1.08 mmHg   0.91    1117 s or more    (24 runs: 1.07)
    bandage   16 + 64             1370   0.76, 0.90 mmHg   0.88    1117 s or more
    bandage   24 + 152            2603   0.34, 0.27 mmHg   1.25    1117 s or more

With the fine mesh as truth (5 s coarse, 41 s fine on two cores): seven fine runs
(`bandage_fine.csv`) beside coarse ones, judged by the 24 medium runs, which are 0.08 mmHg (RMS)
from fine where both are known. For one level, runs of the coarse mesh stand in, which is as hard
to learn: 24, 40, 60, 100 runs reach 1.61, 0.88, 0.72, 0.57 mmHg.

    fine + coarse runs         seconds   RMSE        one level needs   saved
    7 + 32                         447   1.21 mmHg            1250 s    64 %
    7 + 60                         587   0.82 mmHg            1890 s    69 %
    7 + 100                        787   0.69 mmHg            2700 s    71 %
    7 + 152                       1047   0.51 mmHg    4100 s or more    74 % or more

Co-kriging pays where true runs are too few to see the shape, and costs where the truth alone is
smooth (Park). Of the bandage a coarse run costs a fifth of a medium one, an eighth of a fine one.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from fidelity_pairs import PAIRS, Array, Pair, scattered

from surrogate import Study
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.nested import nested
from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.level_process import LevelRuns
from surrogate.runs import dataset as rundata
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

RATIO, CHEAP, SEEDS, SCATTERED = 10.0, 5, 5, 12


#: Seconds of a coarse and a fine run of the bandage on two cores.
FINE_SECONDS = (5.0, 41.0)
#: Pair -> numbers of true runs beside cheap ones, and alone.
SIZES: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
    "forrester": ((4, 6), (4, 6, 8, 10, 14, 20, 30, 40)),
    "currin": ((6, 12), (8, 16, 32, 64)),
    "park": ((8, 16), (10, 20, 40, 80)),
    "borehole": ((12, 20), (15, 30, 60, 120)),
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


#: What a size is, its seconds, median RMSE of ours and SMT's, and geometric mean of their ratio.
Sizes = list[tuple[str, float, list[float], float]]


def told(name: str, sizes: Sizes, alone: list[tuple[float, float]]) -> None:
    """Print what each size costs, reaches, and saves."""
    alone = sorted(dict(alone).items())
    seconds, errors = np.array(alone).T
    print(f"\n{name}\n  one level: " + ", ".join(f"{s:.0f} s {e:.3g}" for s, e in alone))
    for label, cost, (ours, theirs), ratio in sizes:
        equal = seconds_at(ours, seconds, errors)
        saved = "more than any here" if np.isinf(equal) else f"{1 - cost / equal:.0%} saved"
        limit = f"{seconds[-1]:.0f} s or more" if np.isinf(equal) else f"{equal:.0f} s"
        print(
            f"  {label}, {cost:.0f} s: RMSE {ours:.3g}, SMT {theirs:.3g}, ratio {ratio:.2f}; "
            f"one level needs {limit} ({saved})"
        )


def public(name: str) -> None:
    pair, (few, many) = PAIRS[name], SIZES[name]
    space = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(pair.inputs)))
    new = space.sample(1000, seed=99)
    target, sizes, alone = pair.values(pair.true, new), [], []
    for n in few:
        errors = []
        for seed in range(SEEDS):
            rows = nested(space, runs={"cheap": CHEAP * n, "true": n}, seed=seed)
            x, t = rows[: CHEAP * n], rows[CHEAP * n :]
            low, high = pair.values(pair.cheap, x), pair.values(pair.true, t)
            errors.append(both(x, low, t, high, new, target))
        cost = n * RATIO + CHEAP * n
        medians = np.median(errors, axis=0).tolist()
        sizes.append((f"{n} + {CHEAP * n} runs", cost, medians, _ratio(pair, n, new, target)))
    for n in many:
        errors = []
        for seed in range(SEEDS):
            t = latin_hypercube(space, runs=n, seed=seed)
            fitted = CoKriging().fit(t, pair.values(pair.true, t))
            errors.append(rmse(fitted.predict(new), target))
        alone.append((n * RATIO, float(np.median(errors))))
    told(name, sizes, alone)


def _ratio(pair: Pair, n: int, new: Array, target: Array) -> float:
    """RMSE of ours over SMT's, geometric mean over scattered designs."""
    errors = []
    for seed in range(SCATTERED):
        x, t = scattered(pair.inputs, n, CHEAP * n, seed)
        low, high = pair.values(pair.cheap, x), pair.values(pair.true, t)
        errors.append(both(x, low, t, high, new, target))
    return _mean_ratio(errors)


def _mean_ratio(errors: list[list[float]]) -> float:
    ours, theirs = np.log(errors).T
    return float(np.exp(np.mean(ours - theirs)))


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
            fitted = CoKriging().fit(t[own], high[own])
            single.append(rmse(fitted.predict(points), values))
        cost = n * each[1] + (fill + n) * each[0]
        medians = np.median(ours, axis=0).tolist()
        sizes.append((f"{n} + {fill + n} runs", cost, medians, _mean_ratio(ours)))
        alone.append((n * each[1], float(np.median(single))))
    told(f"bandage (a coarse run {each[0]:.1f} s, a medium one {each[1]:.1f} s)", sizes, alone)


def fine() -> None:
    """Coarse and fine runs of the bandage, judged by the 24 medium runs, at `FINE_SECONDS`."""
    root = Path(__file__).parent
    study = Study.from_yaml(root.parent / "studies/bandage_fidelity.yaml")
    runs, output, names = study.stored(), "pressure_b1", study.space.names
    x, low = rundata.training(runs, output, ["pairs"], "coarse")
    new, target = rundata.training(runs, output, ["pairs"])
    table = np.genfromtxt(root / "bandage_fine.csv", delimiter=",", names=True)
    t, high = study.space.encode({name: table[name] for name in names}), table[output]
    held, medium = rundata.training(runs, output, ["test"])
    near = np.abs(held[:, None] - t).max(axis=2).argmin(axis=0)
    print(f"\nbandage, fine: medium is {rmse(medium[near], high):.2f} mmHg (RMS) from fine")
    cheap, true = FINE_SECONDS
    for n in (0, 32, 60, 100, 152):
        own = np.random.default_rng(0).permutation(len(x))[:n]
        lower = [LevelRuns(x[own], low[own])] if n else []
        error = rmse(CoKriging(lower=lower).fit(t, high).predict(new), target)
        print(f"  {len(t)} fine + {n} coarse, {len(t) * true + n * cheap:.0f} s: RMSE {error:.2f}")
    for n in (24, 40, 60, 100):  # the coarse mesh is as hard to learn
        single = []
        for seed in range(SEEDS):
            order = np.random.default_rng(seed).permutation(len(x))
            one = CoKriging().fit(x[order[:n]], low[order[:n]])
            single.append(rmse(one.predict(x[order[n:]]), low[order[n:]]))
        print(f"  {n} runs of one mesh, {n * true:.0f} s if fine: RMSE {np.median(single):.2f}")


if __name__ == "__main__":
    for wanted in sys.argv[1:] or [*SIZES, "bandage", "fine"]:
        if wanted in SIZES:
            public(wanted)
        else:
            {"bandage": bandage, "fine": fine}[wanted]()
