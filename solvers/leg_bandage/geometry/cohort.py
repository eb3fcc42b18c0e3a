"""The virtual legs that ship: 35 to learn the shape basis from, 38 to validate it.

No leg is a scan of a person. Body shapes come from the MakeHuman / MPFB2 assets
(CC0 1.0), girths and lengths from ANSUR II statistics; `data/README.md` says more.
Axes: z up from the ankle, x lateral (right leg), y anterior; millimetres.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

SECTIONS = 100
"""Sections a leg, at z = L i / 99 (Chassagne et al. 2018)."""

DATA = Path(__file__).parents[1] / "data"


@dataclass(frozen=True)
class Cohort:
    """A set of legs, each cut into 100 sections.

    coefficients  (leg, section, 11) Fourier series r0, a1..a5, b1..b5 of each section, mm
    centre        (leg, section, 2) centre of each section, lateral and anterior, mm
    length        (leg,) distance from the lowest to the highest section, mm
    facts         name -> (leg,) what else is known: sex, age, bmi, stature (mm), girths (mm) ...
    """

    coefficients: np.ndarray
    centre: np.ndarray
    length: np.ndarray
    facts: dict[str, np.ndarray]

    def __len__(self) -> int:
        return len(self.length)

    def snapshots(self) -> np.ndarray:
        """Columns U / L, shape (1300, leg): 13 numbers a section, leg size taken out."""
        return snapshot(self.coefficients, self.centre, self.length).T

    @property
    def identity(self) -> str:
        """Digest of the shapes: the same for the same legs, whatever file they are in."""
        return hashlib.sha256(self.snapshots().tobytes() + self.length.tobytes()).hexdigest()


def snapshot(coefficients: np.ndarray, centre: np.ndarray, length) -> np.ndarray:
    """Flatten sections (..., S, 11) and centres (..., S, 2) to U / L, shape (..., 13 S)."""
    sections = np.concatenate([coefficients, centre], axis=-1)
    scaled = sections / np.asarray(length, float)[..., None, None]
    return scaled.reshape(*scaled.shape[:-2], -1)


def sections_of(snapshots: np.ndarray, length) -> tuple[np.ndarray, np.ndarray]:
    """Undo `snapshot`: (..., 13 S) -> coefficients (..., S, 11) and centres (..., S, 2), mm."""
    scaled = snapshots.reshape(*snapshots.shape[:-1], -1, 13)
    sections = scaled * np.asarray(length, float)[..., None, None]
    return sections[..., :11], sections[..., 11:]


@cache
def load_cohort(which: str = "train") -> Cohort:
    """The shipped legs: `train` (35) or `val` (38)."""
    with (DATA / "cohort.npz").open("rb") as stream:
        return read_cohort(stream, which)


def read_cohort(file, which: str = "train") -> Cohort:
    """The legs in an npz file: `train_coef`, `train_centre`, `train_L` and facts, or `val_...`."""
    prefix = {"train": "train_", "val": "val_"}[which]
    with np.load(file) as stored:
        data = {k.removeprefix(prefix): stored[k] for k in stored.files if k.startswith(prefix)}
    arrays = [data.pop(name).astype(float) for name in ("coef", "centre", "L")]
    for array in (*arrays, *data.values()):
        array.flags.writeable = False
    return Cohort(*arrays, facts=data)


def write_cohort(file, cohort: Cohort) -> None:
    """Write legs to learn from, in the form that `read_cohort` reads."""
    np.savez_compressed(
        file,
        train_coef=cohort.coefficients,
        train_centre=cohort.centre,
        train_L=cohort.length,
        **{f"train_{name}": values for name, values in cohort.facts.items()},
    )
