"""`build_cohort`: a shape basis from a folder of scans, and what each number of modes loses."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.basis import Basis, fit_basis, reconstruction_errors
from ..geometry.cohort import Cohort, read_cohort
from .errors import ScanError
from .fitting import FittedScan, fit_scan
from .reading import FORMATS, scans_in

LEAST = 3
"""Legs that make a basis; the paper learnt from 35."""

MOST_MODES = 10


@dataclass(frozen=True)
class Loss:
    """What K modes lose of the legs, mm between points of the skin at the same angle.

    Of all points of all legs: root mean square, 95th percentile, largest; the same
    percentile of legs left out of the learning (leave one out).
    """

    modes: int
    rms: float
    percentile_95: float
    largest: float
    left_out_95: float


@dataclass(frozen=True)
class GrownCohort:
    """Legs from scans.

    cohort   the legs; facts: `file` and `side` of each
    skipped  file name -> why it was not used
    losses   one `Loss` for each number of modes
    """

    cohort: Cohort
    skipped: Mapping[str, str]
    losses: tuple[Loss, ...]


def build_cohort(
    folder: str | Path, *, progress: Callable[[str], None] | None = None, **options: Any
) -> GrownCohort:
    """Legs from every STL, PLY and OBJ file in a folder, in the order of their names.

    options: those of `fit_scan`, for all files alike. progress is told each file name.
    Raises ScanError when fewer than three scans can be used; the others are skipped.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise ScanError(f"{folder}: there is no such folder; check the name")
    files = scans_in(folder)
    legs, skipped = [], {}
    for path in files:
        if progress is not None:
            progress(path.name)
        try:
            legs.append(fit_scan(path, **options))
        except ScanError as error:
            skipped[path.name] = str(error).removeprefix(f"{path}: ")
    if len(legs) < LEAST:
        reasons = "".join(f"\n  {name}: {why}" for name, why in skipped.items())
        raise ScanError(
            f"{folder}: {len(legs)} of {len(files)} scans ({', '.join(FORMATS)}) can "
            f"be used, a basis needs at least {LEAST}; add scans or repair these" + reasons
        )
    cohort = cohort_of(legs)
    return GrownCohort(cohort, skipped, losses(cohort))


def cohort_of(legs: list[FittedScan]) -> Cohort:
    """Fitted scans as a cohort."""
    return Cohort(
        np.array([leg.scanned.coefficients for leg in legs]),
        np.array([leg.scanned.centre for leg in legs]),
        np.array([leg.length for leg in legs]),
        {
            "file": np.array([leg.path.name for leg in legs]),
            "side": np.array([leg.side for leg in legs]),
        },
    )


def losses(cohort: Cohort) -> tuple[Loss, ...]:
    """Figure 1 of Chassagne et al. 2018 as numbers, and the same for legs left out."""
    most = min(MOST_MODES, len(cohort) - 1)
    left_out = [
        fit_basis(np.delete(cohort.snapshots(), leg, axis=1), most) for leg in range(len(cohort))
    ]
    found = []
    for modes in range(1, most + 1):
        away = reconstruction_errors(fit_basis(cohort.snapshots(), modes), cohort)[1]
        unseen = [
            reconstruction_errors(_first(basis, modes), _one(cohort, leg))[1]
            for leg, basis in enumerate(left_out)
        ]
        found.append(
            Loss(
                modes,
                float(np.sqrt((away**2).mean())),
                float(np.percentile(away, 95)),
                float(away.max()),
                float(np.percentile(unseen, 95)),
            )
        )
    return tuple(found)


def _first(basis: Basis, modes: int) -> Basis:
    return Basis(basis.modes[:, :modes], basis.training[:, :modes], basis.singular)


def _one(cohort: Cohort, leg: int) -> Cohort:
    return Cohort(
        cohort.coefficients[leg : leg + 1],
        cohort.centre[leg : leg + 1],
        cohort.length[leg : leg + 1],
        {},
    )


def cohort_in(path: str | Path) -> Cohort:
    """The cohort in a file that `leg-bandage build-cohort` wrote; raises ScanError."""
    if not Path(path).is_file():
        raise ScanError(
            f"{path}: there is no such file; make a cohort with `leg-bandage build-cohort FOLDER`"
        )
    try:
        cohort = read_cohort(Path(path))
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        raise ScanError(
            f"{path}: is not a cohort; make one with `leg-bandage build-cohort FOLDER`"
        ) from None
    if len(cohort) < LEAST:
        raise ScanError(f"{path}: holds {len(cohort)} legs, a basis needs at least {LEAST}")
    return cohort
