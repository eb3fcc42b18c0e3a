"""Build solvers/leg_bandage/data/bones.json from the tibia and fibula of the wheel `myo-sim`.

    python tools/build_bones.py [--wheel myo_sim-0.2.4-py3-none-any.whl] [--output bones.json]

The meshes are those of the Rajagopal et al. 2016 model (a person of 1.70 m), in metres:
x anterior, y up, z lateral. They are scaled to the mean stature of the shipped legs and
moved as one rigid body into the mean leg until, at all heights, the tibia lies 6 mm
under the skin (it comes to 4.6 to 7.8 mm), and the fibula 8 mm at the ankle cut. The
envelope is the convex hull of both bones at 21 heights, as a Fourier series about its own
centroid; series and centroid are stored as fractions of the leg's local r0.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial import ConvexHull
from slicing import cut
from wheel import open_wheel

from surrogate_solvers.leg_bandage.geometry import section
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import DATA, load_cohort
from surrogate_solvers.leg_bandage.geometry.leg import Leg

REQUIREMENT = "myo-sim==0.2.4"
MODEL_STATURE = 1700.0
COVER = 6.0
FIBULA_COVER = 8.0
"""mm of tissue over the shin (5 to 7 mm are usual) and over the fibula at the ankle cut."""
ANKLE_ABOVE_TIP = 57.0
"""mm from the tip of the fibula up to the narrowest girth: that is 45 mm above the most
lateral point of the malleolus (63 mm above the floor in ANSUR II, women), whose tip is
12 mm lower."""
HEIGHTS = np.linspace(0, 1, 21)


def read_stl(data: bytes) -> np.ndarray:
    """Triangles (n, 3 corners, 3) of a binary STL file."""
    count = int(np.frombuffer(data, "<u4", 1, 80)[0])
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    return np.frombuffer(data, record, count, 84)["corners"].astype(float)


def read_bone(wheel: ZipFile, name: str) -> np.ndarray:
    """Triangles in mm: x lateral, y anterior, z up from the knee."""
    triangles = read_stl(wheel.read(f"myo_sim/models/meshes/{name}.stl"))
    return 1000 * triangles[..., [2, 0, 1]]


@dataclass(frozen=True)
class Place:
    """Shift of the bones in the leg, mm, and their lean forwards (mm a mm of height).

    The axes of both models are the anatomical ones, so the bones are not turned, and they
    stay parallel to the vertical seen from the front.
    """

    x: float
    y: float
    lean: float

    def __call__(self, triangles: np.ndarray, foot: float) -> np.ndarray:
        """Triangles in the axes of the leg; the height `foot` becomes z = 0."""
        x, y, z = np.moveaxis(triangles, -1, 0)
        z = z - foot
        return np.stack([x + self.x, y + self.y + self.lean * z, z], axis=-1)


def cover(leg: Leg, bone: np.ndarray, z: float) -> float:
    """Smallest distance from the cut of a bone at z to the skin, along the skin's normal, mm."""
    points = cut(bone, z)
    away = points - leg.centre_line(z)
    theta = np.arctan2(away[:, 1], away[:, 0])
    tangent = leg.surface(theta, z, d_theta=1)[:, :2]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return float(np.sum((leg.surface(theta, z)[:, :2] - points) * normal, axis=1).min())


def register(leg: Leg, tibia: np.ndarray, fibula: np.ndarray, foot: float) -> Place:
    """The place with COVER mm over the tibia at every height and FIBULA_COVER at the ankle."""

    def misfit(parameters):
        place = Place(*parameters)
        shin, outside = place(tibia, foot), place(fibula, foot)
        covers = [cover(leg, shin, h * leg.length) - COVER for h in HEIGHTS]
        return np.append(covers, cover(leg, outside, 0.0) - FIBULA_COVER)

    return Place(*least_squares(misfit, [0.0, 10.0, 0.0]).x)


def hull_series(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centroid (2,) of the convex hull of points (n, 2) and the series (11,) of its radius."""
    corners = points[ConvexHull(points).vertices]
    ahead = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * ahead[:, 1] - ahead[:, 0] * corners[:, 1]
    centroid = ((corners + ahead) * cross[:, None]).sum(axis=0) / (3 * cross.sum())
    theta = 2 * np.pi * np.arange(360) / 360
    return centroid, section.fit_series(theta, ray_lengths(corners - centroid, theta))


def ray_lengths(corners: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Distance from the origin to a convex polygon around it, along each theta."""
    edge = np.roll(corners, -1, axis=0) - corners
    outward = np.column_stack([edge[:, 1], -edge[:, 0]])
    support = np.sum(corners * outward, axis=1)
    facing = np.column_stack([np.cos(theta), np.sin(theta)]) @ outward.T
    return np.where(facing > 0, support / np.where(facing > 0, facing, 1.0), np.inf).min(axis=1)


def build(wheel: ZipFile) -> dict:
    """The content of bones.json."""
    cohort = load_cohort()
    leg = Leg.from_alphas(cohort.length.mean(), shipped_basis().mean)
    scale = cohort.facts["stature"].mean() / MODEL_STATURE
    tibia, fibula = (scale * read_bone(wheel, name) for name in ("r_tibia", "r_fibula"))
    foot = fibula[..., 2].min() + ANKLE_ABOVE_TIP
    place = register(leg, tibia, fibula, foot)
    tibia, fibula = (place(bone, foot) for bone in (tibia, fibula))
    rows = []
    for h in HEIGHTS:
        z = h * leg.length
        centroid, series = hull_series(np.vstack([cut(tibia, z), cut(fibula, z)]))
        r0 = leg.numbers(z)[0]
        rows.append(
            {
                "h": round(float(h), 3),
                "offset": np.round((centroid - leg.centre_line(z)) / r0, 5).tolist(),
                "coefficients": np.round(series / r0, 5).tolist(),
                "tibia_cover_mm": round(cover(leg, tibia, z), 2),
                "fibula_cover_mm": round(cover(leg, fibula, z), 2),
            }
        )
    return {
        "source": f"tibia and fibula of {REQUIREMENT} (PyPI, Apache-2.0), which are those of the "
        "OpenSim model of Rajagopal et al. 2016 (CC BY 3.0); tools/build_bones.py",
        "definition": "convex hull of tibia and fibula at height h = z / L: radius "
        "r0 (c0 + sum a_m cos m theta + b_m sin m theta) about the leg's centre + "
        "r0 offset, with r0 the leg's own at that height",
        "scale": round(float(scale), 4),
        "place": {name: round(float(value), 4) for name, value in vars(place).items()},
        "rows": rows,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheel", type=Path, help="a wheel already downloaded")
    parser.add_argument("--output", type=Path, default=Path(str(DATA)) / "bones.json")
    arguments = parser.parse_args()
    with open_wheel(REQUIREMENT, arguments.wheel) as wheel:
        bones = build(wheel)
    rows = ",\n  ".join(json.dumps(row) for row in bones.pop("rows"))
    head = json.dumps(bones, indent=1)[:-2]
    arguments.output.write_text(f'{head},\n "rows": [\n  {rows}\n ]\n}}\n')
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
