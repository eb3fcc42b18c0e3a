"""The verb `leg-bandage fit-scan`: length and shape coordinates of a scanned leg."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from .geometry.basis import fit_basis, shipped_basis
from .options import (
    AsJson,
    Ends,
    Front,
    Html,
    Landmark,
    Length,
    Scan,
    ScanOptions,
    Side,
    Unit,
    Up,
    reachable,
    say,
    table,
    write,
)
from .scan import FittedScan, ScanError
from .scan.growing import cohort_in
from .scan.page import scan_page
from .scan.summary import figures

_LANDMARKS = {
    "ankle": "ankle, narrowest",
    "b1_girth": "B1, girth rule",
    "b1_profile": "B1, profile rule",
    "calf": "calf, widest",
}


def fit_scan_verb(
    scan: Scan,
    side: Side = "auto",
    unit: Unit = None,
    up: Up = None,
    front: Front = None,
    landmark: Landmark = None,
    length: Length = None,
    ends: Ends = False,
    cohort: Annotated[
        Path | None,
        typer.Option(metavar="NPZ", help="Legs to learn the basis from; default: those that ship."),
    ] = None,
    modes: Annotated[int, typer.Option(min=1, max=10, help="Of the basis.")] = 4,
    html: Html = None,
    as_json: AsJson = False,
) -> None:
    """Fit the scan of a leg: length, shape coordinates, error, landmarks."""
    reachable(html)
    said = ScanOptions(side, unit, up, front, landmark, length, ends)
    fitted = said.fit(scan, **_learnt(cohort, modes))
    if html is not None:
        write(html, scan_page(fitted))
    if as_json:
        print(json.dumps(figures(fitted), indent=1))
    else:
        _show(fitted, Console())
        if html is not None:
            print(f"\npage: {html}")


def _learnt(path: Path | None, modes: int) -> dict[str, Any]:
    """Basis and range of lengths of the legs in a file; of the shipped ones for None."""
    if path is None:
        return {"basis": shipped_basis(modes)}
    cohort = cohort_in(path)
    if modes > len(cohort) - 1:
        raise ScanError(
            f"{modes} modes cannot be computed from the {len(cohort)} legs in {path}; "
            f"give --modes {len(cohort) - 1} or fewer"
        )
    return {
        "basis": fit_basis(cohort.snapshots(), modes),
        "lengths": (float(cohort.length.min()), float(cohort.length.max())),
    }


def _show(scan: FittedScan, console: Console) -> None:
    told = figures(scan)
    rows = [
        (
            name,
            f"{scan.coordinates[name]:.1f} mm"
            if name == "length"
            else f"{scan.coordinates[name]:.4f}",
            f"{low:.1f} .. {high:.1f}" if name == "length" else f"{low:.3f} .. {high:.3f}",
            "inside" if scan.in_range[name] else "OUTSIDE",
        )
        for name, (low, high) in scan.ranges.items()
    ]
    console.print(table(("coordinate", "value", "legs of the basis", ""), rows))
    error = scan.error
    console.print(
        f"\nerror of the shape: {error.rms:.2f} mm RMS, {error.percentile_95:.2f} mm "
        f"95th percentile, {error.largest:.2f} mm at most\n",
        highlight=False,
    )
    rows = [
        (_LANDMARKS[name], *(_place(told["landmarks"][leg][name]) for leg in ("scanned", "fitted")))
        for name in _LANDMARKS
    ]
    console.print(table(("landmark", "on the scan", "on the fitted leg"), rows))
    console.print()
    for note in scan.notes:
        say(console, f"- {note}")


def _place(landmark: dict[str, float] | None) -> str:
    if landmark is None:
        return "none"
    return f"{landmark['height']:.0f} mm up, girth {landmark['girth']:.0f} mm"
