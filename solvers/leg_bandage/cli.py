"""The command `leg-bandage`: from scans of legs to the inputs of the solvers.

Exit status: 0 done; 1 something failed; 2 the input is wrong; 130 interrupted.
"""

from __future__ import annotations

import io
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from threadpoolctl import threadpool_limits

from surrogate.errors import StudyError, SurrogateError

from .geometry.basis import fit_basis, shipped_basis
from .geometry.cohort import write_cohort
from .options import (
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
    Scan,
    Side,
    StudyFile,
    Tension,
    Unit,
    Up,
    reachable,
    table,
    two_pressures,
)
from .plan_command import plan_verb
from .prediction import (
    PUBLISHED,
    BandageChoiceError,
    Prediction,
    Reduced,
    choose_bandage,
    predict_pressure,
    summary,
)
from .prediction.folder import rows_of, scans_in, write_table
from .prediction.page import person_page
from .prediction.summary_points import gradient_words, point_rows
from .scan import FittedScan, ScanError, fit_scan
from .scan.growing import GrownCohort, build_cohort, cohort_in
from .scan.page import cohort_page, scan_page
from .scan.summary import figures

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="From the scan of a leg to the pressure under its bandage.",
)


@app.callback()
def _verbs() -> None:
    """Keeps the verbs verbs."""


@app.command("fit-scan")
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
    fitted = fit_scan(
        scan,
        side=side,
        unit=unit,
        up=up,
        front=front,
        landmarks=landmark or (),
        length=length,
        ends=ends,
        **_learnt(cohort, modes),
    )
    if html is not None:
        _write(html, scan_page(fitted))
    if as_json:
        print(json.dumps(figures(fitted), indent=1))
    else:
        _show_scan(fitted, Console())
        if html is not None:
            print(f"\npage: {html}")


@app.command("predict")
def predict_verb(
    scan: Annotated[
        Path, typer.Argument(metavar="SCAN", help="STL, PLY or OBJ; or a folder of them.")
    ],
    bandage: BandageName = None,
    tension: Tension = None,
    stretch: Annotated[float, typer.Option(help="As laid: length over rest length.")] = 1.3,
    mu_skin: MuSkin = None,
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
    choice = choose_bandage(bandage, tension, stretch, mu_skin, None if known_hand else PUBLISHED)
    target = two_pressures("--gradient", gradient)
    if mesh is not None and not solve:
        raise BandageChoiceError(
            f"--mesh {mesh} is that of the model which --solve runs; add --solve"
        )
    reduced = Reduced.read(study)

    def fit(path: Path) -> FittedScan:
        with threadpool_limits(1):  # its matrices are small
            return fit_scan(
                path,
                side=side,
                unit=unit,
                up=up,
                front=front,
                landmarks=landmark or (),
                length=length,
                ends=ends,
            )

    def predict(fitted: FittedScan) -> Prediction:
        return predict_pressure(
            fitted, choice, reduced, (mesh or "coarse") if solve else None, target
        )

    if scan.is_dir():
        _predict_folder(scan, fit, predict, table_file or Path("pressures.csv"), html)
        return
    if table_file is not None:
        raise ScanError(f"--csv {table_file} is for a folder of scans, and {scan} is none")
    told = predict(fit(scan))
    if html is not None:
        _write(html, person_page(told))
    if as_json:
        print(json.dumps(summary.figures(told), indent=1))
    else:
        _show_prediction(told, Console())
        if html is not None:
            print(f"\npage: {html}")
    if told.unsolved:
        sys.exit(1)


app.command("plan")(plan_verb)


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
    done = write_table(out, _told_on_the_way(rows_of(scans_in(folder), fit, predict)))
    good = sum(row["status"] == "ok" for row in done)
    print(f"{good} of {len(done)} scans answered; table: {out}")


def _told_on_the_way(rows: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for row in rows:
        words = f"{row['pressure_b1']:.1f} mmHg" if row["status"] == "ok" else row["message"]
        print(f"{row['file']}: {words}", file=sys.stderr)
        yield row


@app.command("build-cohort")
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
        _write(html, cohort_page(grown, folder))
    if as_json:
        print(json.dumps(_grown_figures(grown, out), indent=1))
    else:
        _show_cohort(grown, out, Console())


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


def _show_scan(scan: FittedScan, console: Console) -> None:
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
        console.print(f"- {note}", highlight=False, markup=False, soft_wrap=True)


def _show_prediction(told: Prediction, console: Console) -> None:
    def say(words: str) -> None:
        console.print(words, highlight=False, markup=False, soft_wrap=True)

    say(f"{told.scan.side} leg; {summary.choice_words(told)}\n")
    console.print(table(("leg", "value", "runs", ""), summary.coordinate_rows(told)))
    say("")
    console.print(table(("pressure at B1", "mmHg", "95 % interval", "on"), summary.answers(told)))
    say("")
    console.print(table(("interval", "mmHg", "is"), summary.parts(told)))
    say("")
    headings = ("point", "height, mm", "mmHg", "95 % interval", "target", "class of stockings")
    console.print(table(headings, point_rows(told)))
    say(f"\n{gradient_words(told)}")
    say("")
    for note in (*told.notes, *told.scan.notes):
        say(f"- {note}")


_LANDMARKS = {
    "ankle": "ankle, narrowest",
    "b1_girth": "B1, girth rule",
    "b1_profile": "B1, profile rule",
    "calf": "calf, widest",
}


def _place(landmark: dict[str, float] | None) -> str:
    if landmark is None:
        return "none"
    return f"{landmark['height']:.0f} mm up, girth {landmark['girth']:.0f} mm"


def _show_cohort(grown: GrownCohort, out: Path, console: Console) -> None:
    for name, why in grown.skipped.items():
        console.print(f"skipped {name}: {why}", highlight=False, markup=False, soft_wrap=True)
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


def _grown_figures(grown: GrownCohort, out: Path) -> dict[str, Any]:
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


def _write(page: Path, text: str) -> None:
    page.write_text(text, encoding="utf-8", errors="backslashreplace")


def main() -> None:
    """Run the command; people's mistakes end in sentences, never in a traceback."""
    for stream in (sys.stdout, sys.stderr):  # names of files need not be UTF-8
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        app()
    except (ScanError, BandageChoiceError, StudyError) as error:
        _stop(error, 2)
    except KeyboardInterrupt:
        _stop("interrupted", 130)
    except BrokenPipeError:  # the reader of a pipe, such as head, has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except (SurrogateError, OSError) as error:
        _stop(error, 1)
    except Exception as error:  # a mistake of ours, not of the user
        log = Path("leg-bandage-error.log").absolute()
        log.write_text(traceback.format_exc(), encoding="utf-8")
        _stop(f"internal error: {type(error).__name__}: {error}\nPlease report it with {log}", 1)


def _stop(why: object, status: int) -> None:
    print(why, file=sys.stderr)
    sys.exit(status)
