"""What a run of the bandage model costs: `python benchmarks/contact_model.py [MESH ...]`.

Mean leg, nominal inputs, every mesh with every linear solver that is installed, each in a
process of its own so that the peak memory is its own. Add --csv PATH to keep the table.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import resource
import subprocess
import sys
from pathlib import Path

COLUMNS = (
    "mesh",
    "linear_solver",
    "unknowns",
    "steps",
    "iterations",
    "cut_backs",
    "analyses",
    "analyse_s",
    "assemble_s",
    "solve_s",
    "total_s",
    "peak_MB",
    "pressure_b1_mmHg",
)


def measure(mesh: str, solver: str, inputs: dict[str, float]) -> dict[str, float | str]:
    """One run in this process: a row of the table."""
    from surrogate_solvers.leg_bandage.plugin import LegBandage

    result = LegBandage(mesh=mesh, linear_solver=solver).run(**inputs)
    problem, values = result.model.problem, result.values
    stages = problem.cost.seconds
    return {
        "mesh": mesh,
        "linear_solver": solver,
        "unknowns": problem.ndof - len(set(problem.fixed.tolist())),
        "steps": problem.cost.steps,
        "iterations": problem.cost.iterations,
        "cut_backs": problem.cost.cut_backs,
        "analyses": problem.cost.analyses,
        **{
            f"{stage}_s": round(stages.get(stage, 0.0), 1)
            for stage in ("analyse", "assemble", "solve")
        },
        "total_s": round(result.seconds, 1),
        "peak_MB": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
        "pressure_b1_mmHg": round(values["pressure_b1"], 3),
    }


def main() -> None:
    """Run the table and print it row by row."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", nargs="*", default=["coarse", "medium", "fine"])
    parser.add_argument("--solvers", nargs="+", default=_solvers())
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE")
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--one", nargs=2, metavar=("MESH", "SOLVER"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    inputs = {name: float(value) for name, value in (pair.split("=") for pair in given.set)}
    if given.one:
        print(json.dumps(measure(*given.one, inputs)))
        return
    rows = [",".join(COLUMNS)]
    print(rows[0])
    for mesh in given.meshes:
        for solver in given.solvers:
            command = [sys.executable, __file__, "--one", mesh, solver, "--set", *given.set]
            done = subprocess.run(command, capture_output=True, text=True, check=True)
            row = json.loads(done.stdout)
            rows.append(",".join(str(row[name]) for name in COLUMNS))
            print(rows[-1], flush=True)
    if given.csv:
        given.csv.write_text("\n".join(rows) + "\n")


def _solvers() -> list[str]:
    return ["superlu", *(["pardiso"] if importlib.util.find_spec("pypardiso") else [])]


if __name__ == "__main__":
    main()
