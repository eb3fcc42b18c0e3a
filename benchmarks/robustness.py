"""How often the bandage model finds equilibrium, and what it takes.

    python benchmarks/robustness.py lhs corners conical table1 [--mesh coarse] [--points 200]
                                    [--workers 2] [--csv runs.csv]

lhs      random Latin hypercube of --points over Table II of Chassagne et al. 2018, with the
         shipped legs' length and alphas
corners  all 128 corners of the same box (the first --points of a random order)
conical  legs of largest mean slope between the girths of ankle and calf at mu_skin 0.10, half
         of --points of them corners of the shapes, half validation legs with their own sections
table1   16 corners of Table I (mu_skin, mu_bandage, tension, c10) on the mean leg, and the ends
         of c10 and tension at mu_skin 0.10 on a thin, a thick and a conical leg

A failed run is printed with its inputs and its sentence.
"""

from __future__ import annotations

import argparse
from itertools import product
from pathlib import Path

import numpy as np

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.leg_bandage.verification.legs import most_conical, named, shape_ranges
from surrogate_solvers.leg_bandage.verification.sweeps import Case, solve_all

TABLE_2 = {"mu_skin": (0.1, 0.3), "tension": (0.059, 0.137), **shape_ranges()}
TABLE_1 = {
    "mu_skin": (0.1, 0.3),
    "mu_bandage": (0.5, 0.7),
    "tension": (0.059, 0.137),
    "c10": (2.0, 8.0),
}
SEED = 1


def lhs(points: int) -> list[Case]:
    """Random Latin hypercube of Table II."""
    space = Space(tuple(Parameter(name, uniform(*ends)) for name, ends in TABLE_2.items()))
    coded = latin_hypercube(space, runs=points, criterion="random", seed=SEED)
    columns = space.decode(coded)
    return [
        Case(f"lhs {i + 1}", {name: float(columns[name][i]) for name in TABLE_2})
        for i in range(points)
    ]


def corners(points: int) -> list[Case]:
    """Corners of Table II in a random order, so that a part of them is a sample."""
    every = [Case(f"corner {i + 1}", inputs) for i, inputs in enumerate(_corners(TABLE_2))]
    order = np.random.default_rng(SEED).permutation(len(every))
    return [every[i] for i in order[:points]]


def conical(points: int) -> list[Case]:
    """The steepest legs at the least friction, nominal tension."""
    shapes, legs = most_conical((points + 1) // 2)
    slide = {"mu_skin": TABLE_2["mu_skin"][0]}
    return [
        *(Case(f"conical corner {i + 1}", {**slide, **shape}) for i, shape in enumerate(shapes)),
        *(Case(f"conical leg {leg + 1}", slide, leg) for leg in legs),
    ][:points]


def table1(points: int) -> list[Case]:
    """Corners of Table I on the mean leg, softest and stiffest tissue on extreme legs."""
    mean = [Case(f"table1 {i + 1}", inputs) for i, inputs in enumerate(_corners(TABLE_1))]
    ends = _corners({name: TABLE_1[name] for name in ("tension", "c10")})
    extreme = [
        Case(f"{leg} {i + 1}", {**named(leg), "mu_skin": 0.1, **inputs})
        for leg in ("thin", "thick", "conical")
        for i, inputs in enumerate(ends)
    ]
    return [*mean, *extreme][:points]


SETS = {
    "lhs": (lhs, 200),
    "corners": (corners, 128),
    "conical": (conical, 10),
    "table1": (table1, 28),
}


def _corners(ranges):
    return [dict(zip(ranges, ends, strict=True)) for ends in product(*ranges.values())]


def run(name: str, given: argparse.Namespace) -> None:
    """Solve one set and print its failures and its summary."""
    make, usual = SETS[name]
    cases = make(given.points or usual)
    rows = []
    for row in solve_all(cases, given.mesh, given.workers, given.csv):
        rows.append(row)
        if row["message"]:
            print(f"{row['case']} {row['inputs']}: {row['message']}", flush=True)
    good = [row for row in rows if not row["message"]]
    print(f"{name} on {given.mesh}: {len(good)} of {len(rows)} converged{_cost(good)}", flush=True)


def _cost(rows) -> str:
    """What converged runs took and how far they slid, as the end of a sentence."""
    if not rows:
        return ""
    iterations, undone, slip, seconds, pressure = (
        np.array([row[key] for row in rows], float)
        for key in ("iterations", "cut_backs", "slip_max", "seconds", "pressure_b1")
    )
    return (
        f"; Newton iterations {np.median(iterations):.0f} median, {iterations.max():.0f} "
        f"largest; {undone.sum():.0f} cut-backs in {(undone > 0).sum()} runs; largest slip "
        f"{slip.max():.1f} mm; pressure_b1 {pressure.min():.1f} .. {pressure.max():.1f} mmHg; "
        f"{np.median(seconds):.1f} s median"
    )


def main() -> None:
    """Run the sets that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "sets", nargs="*", default=list(SETS), help="of lhs, corners, conical, table1; default: all"
    )
    parser.add_argument("--mesh", default="coarse", help="coarse, medium, fine or a number")
    parser.add_argument(
        "--points",
        type=int,
        help="as many of each set; default: "
        + ", ".join(f"{name} {usual}" for name, (_, usual) in SETS.items()),
    )
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--csv", type=Path, help="keep runs here; those it holds are not repeated")
    given = parser.parse_args()
    wrong = [name for name in given.sets if name not in SETS]
    if wrong:
        parser.error(f"{wrong[0]}: no such set; choose of {', '.join(SETS)}")
    for name in given.sets:
        run(name, given)


if __name__ == "__main__":
    main()
