"""Runs that a robust surrogate finds too far from the others, by number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from surrogate.fitting.fit import Fit
from surrogate.stages.fits import Fits

#: Runs that the sentence names.
NAMED = 10


@dataclass(frozen=True)
class Suspicious:
    """Suspicious runs of one output: their numbers in the runs dataset, and a sentence."""

    surrogate: str
    runs: tuple[int, ...]
    sentence: str


def suspicious(runs: xr.Dataset, fits: Fits) -> dict[str, Suspicious]:
    """Output -> its suspicious runs, of the first robust surrogate that finds some."""
    found: dict[str, Suspicious] = {}
    for by_output in fits.values():
        for output, fit in by_output.items():
            rows = np.asarray(getattr(fit.estimator, "suspicious_", ()), dtype=int)
            if len(rows) and output not in found:
                found[output] = _told(runs, fit, rows)
    return found


def _told(runs: xr.Dataset, fit: Fit, rows: np.ndarray) -> Suspicious:
    errors = fit.values[rows] - fit.predict(fit.coded[rows])
    rows = rows[np.argsort(-np.abs(errors), kind="stable")]
    numbers = [_number(runs, fit, row) for row in rows]
    named = ", ".join(_named(runs, number) for number in numbers[:NAMED])
    more = f" and {len(numbers) - NAMED} more" if len(numbers) > NAMED else ""
    one = len(numbers) == 1
    return Suspicious(
        fit.surrogate,
        tuple(int(runs["run"].values[k]) if "run" in runs.coords else k for k in numbers),
        f"{'Run' if one else 'Runs'} {named}{more} of {fit.output} "
        f"{'lies' if one else 'lie'} far from what {fit.surrogate} makes of the others (farthest "
        f"first). Look at {'it' if one else 'them'}: a mistake in input or output, a solver that "
        "did not converge, or a region where the polynomial is wrong",
    )


def _number(runs: xr.Dataset, fit: Fit, row: int) -> int:
    """Row of the runs dataset that a training run of a fit stands in."""
    near = np.abs(runs["coded"].values - fit.coded[row]).max(axis=1) <= 1e-9
    same = near & (runs[fit.output].values == fit.values[row])
    return int(np.flatnonzero(same)[0])


def _named(runs: xr.Dataset, row: int) -> str:
    """Number of a run, and where it was read."""
    number = int(runs["run"].values[row]) if "run" in runs.coords else row
    origin = str(runs["origin"].values[row]) if "origin" in runs else ""
    return f"{number} ({origin})" if origin else str(number)
