"""The verb `leg-bandage build-cohort`: a shape basis from a folder of scans."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from .geometry.cohort import write_cohort
from .options import AsJson, Ends, Front, Html, Length, Side, Unit, Up, reachable, say, table, write
from .scan.growing import GrownCohort, build_cohort
from .scan.page import cohort_page


def build_cohort_verb(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Of scans.")],
    out: Annotated[Path, typer.Option(metavar="NPZ", help="The legs go here.")] = Path(
        "cohort.npz"
    ),
    side: Side = "auto",
    unit: Unit = None,
    up: Up = None,
    front: Front = None,
    length: Length = None,
    ends: Ends = False,
    html: Html = None,
    as_json: AsJson = False,
) -> None:
    """Learn a shape basis from a folder of scans; use it with fit-scan --cohort."""
    out = out.with_suffix(".npz")
    reachable(out, html)
    grown = build_cohort(
        folder,
        progress=lambda name: print(name, file=sys.stderr),
        side=side,
        unit=unit,
        up=up,
        front=front,
        length=length,
        ends=ends,
    )
    with out.open("wb") as stream:
        write_cohort(stream, grown.cohort)
    if html is not None:
        write(html, cohort_page(grown, folder))
    if as_json:
        print(json.dumps(_figures(grown, out), indent=1))
    else:
        _show(grown, out, Console())


def _show(grown: GrownCohort, out: Path, console: Console) -> None:
    for name, why in grown.skipped.items():
        say(console, f"skipped {name}: {why}")
    rows = [
        (
            str(loss.modes),
            f"{loss.rms:.2f}",
            f"{loss.percentile_95:.2f}",
            f"{loss.largest:.2f}",
            f"{loss.left_out_95:.2f}",
        )
        for loss in grown.losses
    ]
    headings = ("modes", "RMS, mm", "95 %, mm", "largest, mm", "95 % left out, mm")
    console.print(table(headings, rows))
    console.print(
        f"\n{len(grown.cohort)} legs are in {out}; next: leg-bandage fit-scan SCAN --cohort {out}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )


def _figures(grown: GrownCohort, out: Path) -> dict[str, Any]:
    facts = grown.cohort.facts
    return {
        "cohort": str(out),
        "skipped": dict(grown.skipped),
        "legs": [
            {"file": str(file), "side": str(side), "length": float(length)}
            for file, side, length in zip(
                facts["file"], facts["side"], grown.cohort.length, strict=True
            )
        ],
        "losses": [asdict(loss) for loss in grown.losses],
    }
