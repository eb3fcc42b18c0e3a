"""Questions to a study whose runs are there. Each prints an answer, with what it is worth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from surrogate.cli import completion
from surrogate.cli.options import AsJson, Quiet, Results, StudyFile, Surrogate, Values
from surrogate.cli.verbs.app import app, read, show


@app.command()
def dossier(
    study: StudyFile, results_dir: Results = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Write the evidence of credibility, as a reviewer asks for it (ASME V&V 40). Runs nothing."""
    from surrogate.cli import results
    from surrogate.cli.dossier import dossier as written

    loaded = read(study)
    page = written(loaded, results.folder_of(loaded, results_dir), study)
    show(page, as_json, hidden=quiet)


@app.command()
def predict(
    study: StudyFile,
    at: Values = None,
    points: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Points, a table; the header names the parameters."),
    ] = None,
    surrogate: Surrogate = None,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Predict outputs at new points, with intervals. Runs nothing."""
    from surrogate.cli import predicting, results
    from surrogate.cli.progress import StagesBar

    loaded = read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        page = predicting.predict(loaded, folder, surrogate, at or [], points, steps)
    show(page, as_json)


@app.command()
def solve(
    study: StudyFile,
    goal: Annotated[
        str | None,
        typer.Argument(
            metavar="[GOAL]",
            help="A goal of the study's solve:.",
            autocompletion=completion.goals,
        ),
    ] = None,
    target: Annotated[
        list[str] | None, typer.Option(metavar="OUT=VALUE", help="A value to hit.")
    ] = None,
    minimise: Annotated[
        list[str] | None, typer.Option(metavar="OUT", help="As small as can be.")
    ] = None,
    maximise: Annotated[
        list[str] | None, typer.Option(metavar="OUT", help="As large as can be.")
    ] = None,
    subject_to: Annotated[
        list[str] | None, typer.Option(metavar="'A <= B'", help="What must hold.")
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE", help="Hold a parameter.", autocompletion=completion.parameters
        ),
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Choose this one; default: all.",
            autocompletion=completion.parameter_names,
        ),
    ] = None,
    uncertain: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Nobody controls this one.",
            autocompletion=completion.parameter_names,
        ),
    ] = None,
    probability: Annotated[
        float | None, typer.Option(min=0.01, max=0.9999, help="How surely; default: 0.9.")
    ] = None,
    candidates: Annotated[
        int | None, typer.Option(min=1, max=50, help="Answers at most; default: 5.")
    ] = None,
    surrogate: Surrogate = None,
    verify: Annotated[
        bool, typer.Option("--verify", help="Run the solver at the candidates.")
    ] = False,
    runs: Annotated[
        int | None,
        typer.Option(min=1, help="Verifying runs with uncertain inputs; default: 20."),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes.")] = None,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Find inputs that reach a goal, with the probability that the solver agrees.

    The goal is one of the study's, or what the options say. Runs no solver without --verify.
    """
    from surrogate.cli import results, solving
    from surrogate.study.solving import Goals

    loaded = read(study)
    words = Goals(
        target=tuple(target or ()),
        minimise=tuple(minimise or ()),
        maximise=tuple(maximise or ()),
        subject_to=tuple(subject_to or ()),
        fix=tuple(fix or ()),
        free=tuple(free or ()),
        uncertain=tuple(uncertain or ()),
        probability=probability,
        candidates=candidates,
        surrogate=surrogate,
    )
    folder = results.folder_of(loaded, results_dir)
    how = {"verify": verify, "quiet": quiet}
    page = solving.solve(loaded, folder, goal, words, runs=runs, workers=workers, **how)
    show(page, as_json)


@app.command()
def validate(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    cases: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Table, runs dataset or study; default: the study's own."
        ),
    ] = None,
) -> None:
    """Compare surrogates and other models with reference cases. Runs no solver of the study."""
    from surrogate.cli import results, validating
    from surrogate.cli.progress import StagesBar

    loaded = read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        page = validating.validate(loaded, folder, cases, steps)
    show(page, as_json)


@app.command()
def calibrate(
    study: StudyFile,
    verify: Annotated[
        bool, typer.Option("--verify", help="Run the solver at draws of the posterior.")
    ] = False,
    runs: Annotated[int | None, typer.Option(min=1, help="Verifying runs; default: 20.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes.")] = None,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Learn inputs from the measurements of calibration:, by the surrogates.

    Runs no solver without --verify.
    """
    from surrogate.cli import calibrating, results

    loaded = read(study)
    folder = results.folder_of(loaded, results_dir)
    how = {"verify": verify, "quiet": quiet}
    page = calibrating.calibrate(loaded, folder, runs=runs, workers=workers, **how)
    show(page, as_json)
