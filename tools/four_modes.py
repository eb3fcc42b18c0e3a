"""Solve validation legs on their own sections and as four shape modes: data/four_modes.json.

    python tools/four_modes.py [--mesh coarse] [--legs 38]

Two runs a leg, some ten seconds each at `coarse`; what an earlier call of the same solver
solved is kept, so that it may be stopped and called again. A leg that the model cannot
compute is left out, with a word.
"""

import argparse
import json
from pathlib import Path

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort
from surrogate_solvers.leg_bandage.plugin import LegBandage
from surrogate_solvers.leg_bandage.prediction.shape_correction import both_ways

PATH = Path(__file__).parent.parent / "solvers" / "leg_bandage" / "data" / "four_modes.json"
TENSION, MU_SKIN = 0.0785, 0.2  # biflex_16


def main() -> None:
    """Solve the legs that are missing, one after the other, and write after each."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--mesh", default="coarse")
    options.add_argument("--legs", type=int, default=len(load_cohort("val")))
    chosen = options.parse_args()
    solver = LegBandage(mesh=chosen.mesh)
    told = {
        "about": "pressure at B1, mmHg, of validation legs on their own sections and as the "
        "legs of four shape modes, by finite elements; tools/four_modes.py",
        "solver": f"leg_bandage {solver.version}, mesh {chosen.mesh}",
        "tension": TENSION,
        "mu_skin": MU_SKIN,
    }
    found = {**told, "leg": [], "own": [], "modes": []}
    if PATH.is_file():
        before = json.loads(PATH.read_text(encoding="utf-8"))
        if {name: before[name] for name in told} == told:
            found = before
    for number in range(chosen.legs):
        if number in found["leg"]:
            continue
        try:
            own, modes = (
                solver.run(leg=leg, tension=TENSION, mu_skin=MU_SKIN).values
                for leg in both_ways(number)
            )
        except SolverError as error:
            print(f"leg {number} left out: {error}")
            continue
        found["leg"].append(number)
        found["own"].append(round(own["pressure_b1"], 4))
        found["modes"].append(round(modes["pressure_b1"], 4))
        PATH.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        print(f"leg {number}: {own['pressure_b1']:.2f} and {modes['pressure_b1']:.2f} mmHg")


if __name__ == "__main__":
    main()
