"""Synthetic measurements: the finite element model with a fabric of known law, plus noise.

    python studies/bandage_calibration/measure.py

writes `pressures.csv` beside this file. Ten bandages are laid on the mean leg, at five stretches
and two overlaps; two sensors read the pressure. Law and friction are `TRUTH`, which
`bandage_calibration.yaml` is to find again. Noise is normal, with standard deviation `ERROR`.
"""

from __future__ import annotations

import csv
from itertools import product
from pathlib import Path

import numpy as np

from surrogate_solvers.leg_bandage.plugin import LegBandage

TRUTH = {"tension": 0.112, "exponent": 0.68, "mu_skin": 0.22}
#: mmHg
ERROR = 2.0
SENSORS = ("pressure_ankle", "pressure_b1")
CASES = [
    {"stretch": stretch, "overlap": overlap}
    for overlap, stretch in product((0.45, 0.60), (1.15, 1.22, 1.30, 1.38, 1.45))
]
FILE = Path(__file__).with_name("pressures.csv")


def exact(case: dict[str, float]) -> dict[str, float]:
    """Pressures (mmHg) under the sensors, without noise."""
    found = LegBandage(mesh="coarse", law="power")(**case, **TRUTH)
    return {name: float(found[name]) for name in SENSORS}


def noise() -> np.ndarray:
    """(case, sensor) in mmHg."""
    return ERROR * np.random.default_rng(2018).standard_normal((len(CASES), len(SENSORS)))


def main() -> None:
    """Solve all cases and write the table."""
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("case", *CASES[0], *SENSORS))
        for k, (case, error) in enumerate(zip(CASES, noise(), strict=True)):
            told = np.array(list(exact(case).values())) + error
            writer.writerow((f"bandage {k + 1}", *case.values(), *np.round(told, 1)))
            file.flush()


if __name__ == "__main__":
    main()
