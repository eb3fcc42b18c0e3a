"""What the verbs of `leg-bandage` share: options, tables and sentences, files to write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from surrogate.errors import nearest

from .bandage.products import BANDAGES
from .equilibrium.model import MESHES
from .prediction import BandageChoiceError
from .scan import FittedScan, ScanError, fit_scan
from .scan.marks import DIRECTIONS
from .skin_friction import SKINS

WORN = ("at B1 as worn", "mmHg", "95 % interval", "of which, mmHg")
"""Headings of the table of pressures standing and after hours."""

Side = Annotated[
    str,
    typer.Option(help="right, left, or auto: by landmarks, foot or shape; both where none tells."),
]
Landmark = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=X,Y,Z",
        help=f"Point on the skin in the file's axes, repeatable: {', '.join(DIRECTIONS)}.",
    ),
]
Unit = Annotated[
    str | None,
    typer.Option(
        help="Of the file: mm, cm, inch or m; default: the one that makes the ankle an ankle."
    ),
]
Up = Annotated[
    str | None,
    typer.Option(
        metavar="AXIS", help="Axis of the file that points up the leg: z, -y ...; keeps the tilt."
    ),
]
Front = Annotated[
    str | None,
    typer.Option(metavar="AXIS", help="Axis of the file that points to the front; needs --up."),
]
Length = Annotated[
    float | None,
    typer.Option(metavar="MM", help="Of the leg to take above the ankle; default: to the calf."),
]
Ends = Annotated[bool, typer.Option("--ends", help="Cut where the scan ends.")]
Html = Annotated[Path | None, typer.Option(metavar="PAGE", help="Write a page that opens offline.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON, for scripts.")]
Scan = Annotated[Path, typer.Argument(metavar="SCAN", help="STL, PLY or OBJ.")]
BandageName = Annotated[
    str | None,
    typer.Option("--bandage", metavar="NAME", help=f"One of {', '.join(sorted(BANDAGES))}."),
]
Tension = Annotated[
    float | None,
    typer.Option(
        metavar="N/MM", help="Of the bandage per width at stretch 1.3, in place of a name."
    ),
]
MuSkin = Annotated[
    float | None,
    typer.Option(help="Friction on the skin; default: 0.2, and the interval holds 0.1 to 0.3."),
]
Skin = Annotated[
    str | None,
    typer.Option(help=f"In place of a friction: {', '.join(SKINS)}."),
]
KnownHand = Annotated[
    bool,
    typer.Option(
        "--known-hand", help="Stretch and overlap were measured as laid: leave their scatter out."
    ),
]
Gradient = Annotated[
    str, typer.Option(metavar="MMHG:MMHG", help="Target at the ankle and at the knee.")
]
StudyFile = Annotated[
    Path | None,
    typer.Option(metavar="YAML", help="Stored study to predict from; default: the one that ships."),
]
Mesh = Annotated[str | None, typer.Option(help="For --solve: coarse (default), medium or fine.")]


@dataclass(frozen=True)
class ScanOptions:
    """What the user said of a scan; the fields are the options of the same names."""

    side: str
    unit: str | None
    up: str | None
    front: str | None
    landmark: list[str] | None
    length: float | None
    ends: bool

    def fit(self, scan: Path, **learnt: Any) -> FittedScan:
        """The fitted scan; learnt: basis and lengths in place of those that ship."""
        with threadpool_limits(1):  # its matrices are small
            return fit_scan(
                scan,
                side=self.side,
                unit=self.unit,
                up=self.up,
                front=self.front,
                landmarks=self.landmark or (),
                length=self.length,
                ends=self.ends,
                **learnt,
            )


def mesh_to_solve(mesh: str | None, solve: bool) -> str | None:
    """The mesh of the model that --solve runs, None without; raises BandageChoiceError."""
    if mesh is not None and not solve:
        raise BandageChoiceError(
            f"--mesh {mesh} is that of the model which --solve runs; add --solve"
        )
    if mesh is not None and mesh not in MESHES:
        raise BandageChoiceError(f"mesh: {mesh!r} is unknown: {nearest(mesh, MESHES)}")
    return (mesh or "coarse") if solve else None


def two_pressures(option: str, words: str) -> tuple[float, float]:
    """Two pressures, mmHg, from `40:17`; raises BandageChoiceError."""
    try:
        first, second = (float(word) for word in words.split(":"))
    except ValueError:
        first = second = float("nan")
    if not (0 < first < 200 and 0 < second < 200):
        raise BandageChoiceError(
            f"{option} {words!r} is not two pressures in mmHg from 0 to 200; give them as 40:17"
        )
    return first, second


def table(headings: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> Table:
    """Rows under headings, without lines."""
    made = Table(box=None, pad_edge=False)
    for heading in headings:
        made.add_column(heading, overflow="fold")
    for row in rows:
        made.add_row(*row)
    return made


def say(console: Console, words: str) -> None:
    """A sentence as it is: nothing coloured, read as markup or broken into lines."""
    console.print(words, highlight=False, markup=False, soft_wrap=True)


def write(page: Path, text: str) -> None:
    """A page into its file; names of files in it need not be UTF-8."""
    page.write_text(text, encoding="utf-8", errors="backslashreplace")


def reachable(*paths: Path | None) -> None:
    """Raise ScanError for files that cannot be written, before anything takes its time."""
    for path in paths:
        if path is not None and (not path.parent.is_dir() or path.is_dir()):
            raise ScanError(
                f"{path}: cannot be written; the folder {path.parent} must be there "
                "and the name be that of a file"
            )
