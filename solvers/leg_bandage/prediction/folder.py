"""A table of pressures for a folder of scans: a row a scan, also where one has no answer."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from ..scan import FittedScan, ScanError
from .points import POINTS
from .pressure import Prediction

WORN = ("standing", "lying_4h")
COLUMNS = (
    *("file", "status", "side", "front", "length", "rms", "widening", "extrapolates"),
    *("pressure_b1", "low", "high"),
    *(f"{name}{end}" for name in POINTS if name != "B1" for end in ("", "_low", "_high")),
    *(f"{name}{end}" for name in WORN for end in ("", "_low", "_high")),
    "message",
)


def rows_of(
    files: Iterable[Path],
    fit: Callable[[Path], FittedScan],
    predict: Callable[[FittedScan], Prediction],
) -> Iterable[dict[str, Any]]:
    """A row a file, as each is done; what cannot be answered says why."""
    for path in files:
        try:
            yield _row(path, predict(fit(path)))
        except ScanError as error:
            why = str(error).removeprefix(f"{path}: ")
            yield {"file": path.name, "status": "refused", "message": why}


def _row(path: Path, told: Prediction) -> dict[str, Any]:
    scan = told.scan
    row: dict[str, Any] = {
        "file": path.name,
        "status": "ok",
        "side": scan.side if scan.other is None else "unknown",
        "front": scan.front.source if scan.front else "",
        "length": round(scan.length, 2),
        "rms": round(scan.error.rms, 3),
        "widening": round(scan.widening, 3),
        "extrapolates": told.extrapolates,
        "pressure_b1": round(told.value, 3),
        "low": round(told.low, 3),
        "high": round(told.high, 3),
        "message": "; ".join(note for note in scan.notes if note.startswith(("POOR", "UNLIKE"))),
    }
    for point in told.points:
        if point.name != "B1":
            ends = (("", point.value), ("_low", point.low), ("_high", point.high))
            row |= {f"{point.name}{end}": round(value, 3) for end, value in ends}
    for name, one in zip(WORN, told.worn(), strict=False):  # none without B1
        row |= {name: round(one.value, 3), f"{name}_low": round(one.low, 3)}
        row |= {f"{name}_high": round(one.high, 3)}
    return row


def write_table(path: Path, rows: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Write the rows as CSV, each when it is there, so that none is lost; returns them."""
    done = []
    with path.open("w", newline="", encoding="utf-8", errors="backslashreplace") as stream:
        writer = csv.DictWriter(stream, COLUMNS, restval="")
        writer.writeheader()
        for row in rows:
            writer.writerow(row)
            stream.flush()
            done.append(row)
    return done
