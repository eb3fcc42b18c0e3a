"""The verb `leg-bandage predict`: the pressure under a bandage, for a scan or a folder of them."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from .options import (
    WORN,
    AsJson,
    BandageName,
    Ends,
    Front,
    Gradient,
    Html,
    KnownHand,
    Landmark,
    Length,
    Mesh,
    MuSkin,
    ScanOptions,
    Side,
    Skin,
    StudyFile,
    Tension,
    Unit,
    Up,
    mesh_to_solve,
    reachable,
    say,
    table,
    two_pressures,
    write,
)
from .prediction import PUBLISHED, Prediction, Reduced, choose_bandage, predict_pressure, summary
from .prediction.folder import rows_of, write_table
from .prediction.page import person_page
from .prediction.summary_points import gradient_words, point_rows
from .scan import FittedScan, ScanError
from .scan.reading import FORMATS, scans_in


def predict_verb(
    scan: Annotated[
        Path, typer.Argument(metavar="SCAN", help="STL, PLY or OBJ; or a folder of them.")
    ],
    bandage: BandageName = None,
    tension: Tension = None,
    stretch: Annotated[float, typer.Option(help="As laid: length over rest length.")] = 1.3,
    mu_skin: MuSkin = None,
    skin: Skin = None,
    known_hand: KnownHand = False,
    gradient: Gradient = "40:17",
    solve: Annotated[
        bool,
        typer.Option("--solve", help="Run the finite element model too, on the scan's sections."),
    ] = False,
    mesh: Mesh = None,
    study: StudyFile = None,
    side: Side = "auto",
    unit: Unit = None,
    up: Up = None,
    front: Front = None,
    landmark: Landmark = None,
    length: Length = None,
    ends: Ends = False,
    table_file: Annotated[
        Path | None,
        typer.Option(
            "--csv", metavar="CSV", help="Of a folder: the table goes here; default pressures.csv."
        ),
    ] = None,
    html: Html = None,
    as_json: AsJson = False,
) -> None:
    """Predict the pressure under a bandage on the leg of a scan, with its interval."""
    reachable(html)
    hand = None if known_hand else PUBLISHED
    choice = choose_bandage(bandage, tension, stretch, mu_skin, hand, skin)
    target = two_pressures("--gradient", gradient)
    solved_on = mesh_to_solve(mesh, solve)
    said = ScanOptions(side, unit, up, front, landmark, length, ends)
    reduced = Reduced.read(study)

    def predict(fitted: FittedScan) -> Prediction:
        return predict_pressure(fitted, choice, reduced, solved_on, target)

    if scan.is_dir():
        _predict_folder(scan, said.fit, predict, table_file or Path("pressures.csv"), html)
        return
    if table_file is not None:
        raise ScanError(f"--csv {table_file} is for a folder of scans, and {scan} is none")
    told = predict(said.fit(scan))
    if html is not None:
        write(html, person_page(told))
    if as_json:
        print(json.dumps(summary.figures(told), indent=1))
    else:
        _show(told, Console())
        if html is not None:
            print(f"\npage: {html}")
    if told.unsolved:
        sys.exit(1)


def _predict_folder(
    folder: Path,
    fit: Callable[[Path], FittedScan],
    predict: Callable[[FittedScan], Prediction],
    out: Path,
    html: Path | None,
) -> None:
    """A row a scan in `out`; what cannot be answered is told there and on standard error."""
    if html is not None:
        raise ScanError(f"--html {html} is for one scan; leave it out for the folder {folder}")
    reachable(out)
    files = scans_in(folder)
    if not files:
        raise ScanError(f"{folder}: holds no scan ({', '.join(FORMATS)})")
    done = write_table(out, _told_on_the_way(rows_of(files, fit, predict)))
    good = sum(row["status"] == "ok" for row in done)
    print(f"{good} of {len(done)} scans answered; table: {out}")


def _told_on_the_way(rows: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for row in rows:
        words = f"{row['pressure_b1']:.1f} mmHg" if row["status"] == "ok" else row["message"]
        print(f"{row['file']}: {words}", file=sys.stderr)
        yield row


def _show(told: Prediction, console: Console) -> None:
    say(console, f"{told.scan.side} leg; {summary.choice_words(told)}\n")
    console.print(table(("leg", "value", "runs", ""), summary.coordinate_rows(told)))
    say(console, "")
    console.print(table(("pressure at B1", "mmHg", "95 % interval", "on"), summary.answers(told)))
    say(console, "")
    console.print(table(("interval", "mmHg", "is"), summary.parts(told)))
    say(console, "")
    worn = told.worn()
    console.print(table(WORN, summary.worn_rows(worn)))
    for words in summary.worn_words(worn):
        say(console, f"- {words}")
    say(console, "")
    headings = ("point", "height, mm", "mmHg", "95 % interval", "target", "class of stockings")
    console.print(table(headings, point_rows(told)))
    say(console, f"\n{gradient_words(told)}")
    say(console, "")
    for note in (*told.notes, *told.scan.notes):
        say(console, f"- {note}")
