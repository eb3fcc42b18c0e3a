"""Mesh convergence of the bandage model (check V12).

    python benchmarks/convergence.py [--meshes 1 1.5 2 2.5] [--leg thin] [--csv runs.csv]

Mesh k is k times as fine as `coarse` in all directions; coarse, medium and fine are 1, 1.5
and 2. Prints the values on each mesh with the uncertainty that they tell of each other, the
limit and the observed order where there is one, and how far `medium` is from it:
`grid_refinement` says how. Four meshes or more are fitted by least squares. With pardiso on two
cores 2 takes a minute, 2.5 and 3 three minutes each.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from surrogate_solvers.leg_bandage.verification.grid_refinement import observed_order, refined
from surrogate_solvers.leg_bandage.verification.legs import named
from surrogate_solvers.leg_bandage.verification.sweeps import Case, solve_all

READ = {
    "pressure_b1": "mmHg",
    "pressure_ankle": "mmHg",
    "pressure_calf": "mmHg",
    "stretch_midline": "-",
}
MEDIUM = "1.5"


def values_on(meshes: list[str], case: Case, table: Path | None) -> dict[str, dict]:
    """Rows of the meshes that converged, coarse to fine."""
    rows = {}
    for mesh in sorted(meshes, key=float):
        for row in solve_all([case], mesh, table=table):
            if row["message"]:
                print(f"mesh {mesh}: {row['message']}", flush=True)
                continue
            rows[mesh] = row
            print(
                f"mesh {mesh}: {row['unknowns']:.0f} unknowns, {row['iterations']:.0f} Newton "
                f"iterations, {row['seconds']:.0f} s",
                flush=True,
            )
    return rows


def report(name: str, unit: str, rows: dict[str, dict]) -> None:
    """Print what the meshes say about one output."""
    sizes = [1 / float(mesh) for mesh in rows]
    values = [float(row[name]) for row in rows.values()]
    found = refined(sizes, values)
    print(f"\n{name}, {unit}: {found.how}")
    for mesh, value, off in zip(rows, values, found.uncertainty, strict=True):
        print(f"  mesh {mesh:>4}: {value:9.4f} +- {off:.4f} ({100 * off / abs(value):.2f} %)")
    order = observed_order(sizes[-3:], values[-3:]) if len(values) > 2 else np.nan
    print(
        "  observed order of the three finest: "
        + (f"{order:.2f}" if np.isfinite(order) else "none, no approach to a limit")
    )
    for terms, (limit, scatter) in found.limits.items():
        print(f"  limit by terms in {terms}: {limit:.4f}, standard deviation {scatter:.4f}")
    spread = 100 * np.ptp(values) / abs(values[-1])
    print(f"  largest difference between two meshes: {spread:.2f} %")
    if MEDIUM in rows:
        i = list(rows).index(MEDIUM)
        off, doubt = abs(values[i] / found.limit - 1), found.uncertainty[i] / abs(values[i])
        if np.isfinite(off):
            print(
                f"  medium is within {100 * off:.2f} % of the limit {found.limit:.4f} "
                f"(order {found.order:.2f})"
            )
        print(f"  medium is within {100 * doubt:.2f} % of the limit by the uncertainty above")


def main() -> None:
    """Run the family on one leg."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--meshes", nargs="+", default=["1", "1.5", "2"], metavar="K")
    parser.add_argument("--leg", default="mean", choices=("mean", "thin", "thick", "conical"))
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE", help="other inputs")
    parser.add_argument("--csv", type=Path, help="keep runs here; those it holds are not repeated")
    given = parser.parse_args()
    inputs = {name: float(value) for name, value in (pair.split("=") for pair in given.set)}
    case = Case(given.leg, {**named(given.leg), **inputs})
    rows = values_on(given.meshes, case, given.csv)
    if len(rows) > 1:
        for name, unit in READ.items():
            report(name, unit, rows)


if __name__ == "__main__":
    main()
