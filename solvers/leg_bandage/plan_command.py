"""The verb `leg-bandage plan`: stretch and overlap for a pressure."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from typing import Annotated, Any

import typer
from rich.console import Console

from surrogate.errors import SolverError

from .options import (
    WORN,
    AsJson,
    BandageName,
    Ends,
    Front,
    Gradient,
    KnownHand,
    Landmark,
    Length,
    Mesh,
    MuSkin,
    Scan,
    ScanOptions,
    Side,
    Skin,
    StudyFile,
    Tension,
    Unit,
    Up,
    mesh_to_solve,
    say,
    table,
    two_pressures,
)
from .prediction import (
    PUBLISHED,
    BandageChoiceError,
    Reduced,
    choose_bandage,
    predict_pressure,
    summary,
)
from .prediction.compression_class import BS, RAL, STANDARDS
from .prediction.plan import Plan, check_plan, plan_wrapping, stretch_of_ends
from .prediction.pressure import Prediction, Solved, solved_or_why
from .prediction.worn import hoop_on
from .prediction.worn_pressure import WornPressure, worn_pressures


def plan_verb(
    scan: Scan,
    target: Annotated[float, typer.Option(metavar="MMHG", help="Pressure to reach at B1.")],
    bandage: BandageName = None,
    tension: Tension = None,
    overlap: Annotated[
        float | None,
        typer.Option(help="To lay; default: the surest between half (0.5) and two thirds."),
    ] = None,
    standard: Annotated[
        str, typer.Option(help="Of the class that is to be kept: RAL or BS.")
    ] = "RAL",
    within: Annotated[
        str | None,
        typer.Option(metavar="MMHG:MMHG", help="To be kept in place of a class."),
    ] = None,
    mu_skin: MuSkin = None,
    skin: Skin = None,
    known_hand: KnownHand = False,
    gradient: Gradient = "40:17",
    solve: Annotated[
        bool, typer.Option("--solve", help="Verify by the finite element model, friction 0.2.")
    ] = False,
    graduated: Annotated[
        bool,
        typer.Option("--graduated", help="--solve with the stretch that changes along the leg."),
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
    as_json: AsJson = False,
) -> None:
    """Plan stretch and overlap for a pressure at B1, with the probability of keeping its class."""
    if graduated and not solve:
        raise BandageChoiceError("--graduated is for --solve; add --solve")
    solved_on = mesh_to_solve(mesh, solve)
    hand = None if known_hand else PUBLISHED
    choice = choose_bandage(bandage, tension, mu_skin=mu_skin, hand=hand, skin=skin)
    kept = None if within is None else two_pressures("--within", within)
    asked, down = _standard(standard), two_pressures("--gradient", gradient)
    check_plan(target, kept, overlap)
    said = ScanOptions(side, unit, up, front, landmark, length, ends)
    reduced = Reduced.read(study)
    told = predict_pressure(said.fit(scan), choice, reduced, gradient=down)
    plan = plan_wrapping(told, target, standard=asked, within=kept, overlap=overlap, gradient=down)
    solved, unsolved = _verified(told, plan, solved_on, graduated)
    if as_json:
        print(json.dumps(plan_figures(told, plan, solved, unsolved), indent=1))
    else:
        _show(told, plan, solved, Console())
    if unsolved:
        raise SolverError(f"the finite element model has no answer for this plan: {unsolved}")


def worn_in(told: Prediction, plan: Plan) -> tuple[WornPressure, ...]:
    """The pressure of the plan standing, and lying after four hours."""
    best, hoop = plan.best, told.hoop()
    if hoop is not None:
        hoop = hoop_on(told.scan.scanned, hoop.height, best.stretch)
    return worn_pressures((best.median, best.low, best.high), hoop)


def _standard(name: str) -> str:
    found = {"RAL": RAL, "BS": BS}.get(name.upper(), name)
    if found not in STANDARDS:
        raise BandageChoiceError(f"standard: {name!r} is neither RAL ({RAL}) nor BS ({BS})")
    return found


def _verified(
    told: Prediction, plan: Plan, mesh: str | None, graduated: bool
) -> tuple[Solved | None, str]:
    """The finite element model on the scan's own sections, wrapped as planned; or why not."""
    first, last = plan.best.stretch, None
    if graduated:
        first, last = stretch_of_ends(plan, told.scan.length)
    return solved_or_why(
        told.scan.scanned,
        replace(told.choice, stretch=first),
        mesh,
        overlap=plan.best.overlap,
        stretch_free=last,
    )


def plan_figures(
    told: Prediction, plan: Plan, solved: Solved | None, unsolved: str
) -> dict[str, Any]:
    """The plan for scripts; mmHg, mm."""
    low, high = plan.within
    ends = stretch_of_ends(plan, told.scan.length)
    return {
        "scan": str(told.scan.path),
        "bandage": asdict(replace(told.choice, stretch=plan.best.stretch)),
        "target": plan.target,
        "at": "B1",
        "standard": plan.standard or None,
        "class": plan.class_name or None,
        "within": [low, high if high < float("inf") else None],
        "stretch": plan.best.stretch,
        "overlap": plan.best.overlap,
        "layers": plan.best.layers,
        "probability": plan.best.probability,
        "pressure": {"median": plan.best.median, "low": plan.best.low, "high": plan.best.high},
        "worn": [asdict(one) for one in worn_in(told, plan)],
        "alternatives": [asdict(one) for one in plan.others],
        "graduated": {
            "points": [asdict(one) for one in plan.along],
            "stretch_first_end": ends[0],
            "stretch_free_end": ends[1],
        },
        "extrapolates": plan.extrapolates or told.extrapolates,
        "solved": None
        if solved is None
        else {
            "mesh": solved.mesh,
            "value": solved.value,
            "inside": plan.holds(solved.value),
            "seconds": solved.seconds,
        },
        "unsolved": unsolved,
    }


def _show(told: Prediction, plan: Plan, solved: Solved | None, console: Console) -> None:
    best, (low, high) = plan.best, plan.within
    kept = f"{low:g} to {high:g} mmHg" if high < float("inf") else f"{low:g} mmHg and more"
    name = f"{plan.standard} class {plan.class_name}, {kept}" if plan.standard else kept
    say(
        console,
        f"{told.scan.side} leg; for {plan.target:g} mmHg at B1 lay "
        f"{told.choice.bandage or 'the bandage'} at stretch {best.stretch:.2f} with overlap "
        f"{best.overlap:.2f} ({best.layers:.1f} layers).",
    )
    say(
        console,
        f"It is then in {name}, with probability {best.probability:.2f}; 95 % of the draws "
        f"over friction, hand and leg: {best.low:.1f} .. {best.high:.1f} mmHg.\n",
    )
    worn = worn_in(told, plan)
    console.print(table(WORN, summary.worn_rows(worn)))
    for words in summary.worn_words(worn):
        say(console, f"- {words}")
    say(console, "")
    some = plan.others[:: max(len(plan.others) // 4, 1)]
    rows = [(f"{one.overlap:.2f}", f"{one.stretch:.2f}", f"{one.probability:.2f}") for one in some]
    console.print(table(("overlap", "stretch", "probability"), rows))
    say(console, "")
    points = [
        (
            one.point,
            f"{one.height:.0f}",
            f"{one.target:.0f}",
            f"{one.even:.0f}",
            f"{one.stretch:.2f}",
        )
        for one in plan.along
    ]
    headings = ("point", "height, mm", "target, mmHg", "at one stretch", "stretch for it")
    console.print(table(headings, points))
    say(
        console,
        "\n- Pressures in the last table are means around the leg, by the girth (tape measure).",
    )
    if plan.extrapolates:
        say(
            console,
            "- Its tension is beyond the stored runs: pressure is taken in proportion to tension.",
        )
    if solved is not None:
        inside = "inside" if plan.holds(solved.value) else "OUTSIDE"
        say(
            console,
            f"- Finite elements, {solved.mesh}, mu_skin {told.choice.mu_skin:g}: "
            f"{solved.value:.1f} mmHg at B1, {inside}; "
            f"{solved.seconds:.0f} s.",
        )
    for note in told.scan.notes:
        say(console, f"- {note}")
