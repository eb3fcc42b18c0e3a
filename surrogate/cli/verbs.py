"""The command `surrogate`: verbs only, each imports what it needs and calls one function.

`--help` and the small verbs answer at once: NumPy, SciPy and xarray are loaded by the
verbs that compute.

Exit status: 0 done; 1 ran, but something failed; 2 the input is wrong; 130 interrupted.
"""

from __future__ import annotations

import gc
import json
import os
import sys
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from surrogate.cli import completion
from surrogate.cli.ending import carried_out, stop
from surrogate.cli.options import AsJson, Quiet, Results, RetryFailed, StudyFile, Surrogate, Values
from surrogate.cli.retrying import RetryingCommand, chosen

if TYPE_CHECKING:
    from surrogate.cli.outcome import Outcome
    from surrogate.cli.page import Page
    from surrogate.study.study import Study


class _Verbs(TyperGroup):
    """Says how far a verb came when it was interrupted; typer would end without a word."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            stop(interrupt if interrupt.args else "interrupted", 130)


app = typer.Typer(
    cls=_Verbs,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Designs of experiments, surrogates and sensitivity analysis of expensive simulations.",
)


@app.callback(invoke_without_command=True)
def _whole(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        from surrogate import __version__

        print(__version__)
        raise typer.Exit()


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the new study.")],
    data: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A table of runs or tests: csv, tsv, xlsx, parquet, nc."),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Write NAME.yaml: a commented study to start from, of a table with --data."""
    from surrogate.cli.page import Page
    from surrogate.study import template

    path = template.write(name, data=data)
    done = f"{path} is written; next: surrogate check {path}"
    _show(Page({"file": str(path)}, [done]), False, hidden=quiet)


@app.command()
def check(
    study: StudyFile, results_dir: Results = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Show parameters, designs, aliasing, number of runs and time. Runs nothing.

    A study is code: reading it loads and builds the solver that it names, and loads the
    modules beside it. Check only studies of people you trust.
    """
    from surrogate.cli import results, terminal

    loaded = _read(study)
    page = terminal.check(loaded, results.folder_of(loaded, results_dir))
    _show(page, as_json, hidden=quiet)


@app.command(cls=RetryingCommand)
def run(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes.")] = None,
    retry_failed: RetryFailed = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Do every run again, earlier and stored runs included.")
    ] = False,
) -> None:
    """Do what is missing: runs, fits, indices, report. Ctrl-C is safe."""
    from surrogate.cli import results
    from surrogate.cli.page import say
    from surrogate.cli.progress import RunsBar, StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    loaded = loaded.found(folder)
    for sentence in () if fresh or quiet else loaded.unused:
        say(sentence)
    with RunsBar(loaded.name, hidden=quiet) as bar:
        runs = results.do_runs(
            loaded,
            folder,
            workers=workers,
            retry_failed=chosen(retry_failed),
            fresh=fresh,
            progress=bar,
            tell=say,
        )
    with StagesBar(loaded.name, hidden=quiet) as steps:
        outcome = results.analyse(loaded, folder, runs, workers=workers, steps=steps)
    _finish(loaded, outcome, as_json, quiet)


@app.command(cls=RetryingCommand)
def work(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes.")] = None,
    retry_failed: RetryFailed = None,
) -> None:
    """Do runs of a study side by side with other such workers, on any machine that has the folder.

    They share the results folder and nothing else: start as many as you like, whenever and
    wherever; each ends when all runs are done. Then `surrogate run` makes the report.
    """
    from surrogate.cli import results, terminal
    from surrogate.cli.progress import RunsBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    with RunsBar(loaded.name, hidden=quiet) as bar:
        loaded.run(
            workers=workers,
            results=folder,
            executor=loaded.shared,
            retry_failed=chosen(retry_failed),
            progress=bar,
        )
    _show(terminal.status(loaded, folder), as_json, hidden=quiet)


@app.command()
def status(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    watch: Annotated[bool, typer.Option("--watch", help="Again until all are done.")] = False,
) -> None:
    """Count the runs that are done, failed and left; show the time left."""
    from surrogate.cli import results, terminal

    loaded = _read(study)
    if watch:
        from surrogate.cli.watching import watch as keep_showing

        keep_showing(loaded, results.folder_of(loaded, results_dir), as_json=as_json)
        return
    _show(terminal.status(loaded, results.folder_of(loaded, results_dir)), as_json)


@app.command()
def report(
    study: StudyFile, results_dir: Results = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Rebuild the report from the stored runs. Runs nothing."""
    from surrogate.cli import results
    from surrogate.cli.progress import StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        outcome = results.analyse(loaded, folder, again=True, steps=steps)
    _finish(loaded, outcome, as_json, quiet)


@app.command("open")
def open_report(study: StudyFile, results_dir: Results = None, quiet: Quiet = False) -> None:
    """Show the report in the browser, and say where it lies. Runs nothing."""
    from surrogate.cli import browsing, results
    from surrogate.cli.page import say

    loaded = _read(study)
    path, notes = browsing.report_of(loaded, results.folder_of(loaded, results_dir), study)
    if not quiet:
        print(path, flush=True)
        for note in notes:
            say(note)
    if not browsing.browse(path):
        say("no browser can be started here; open the file in one")
        raise typer.Exit(1)


@app.command()
def dossier(
    study: StudyFile, results_dir: Results = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Write the evidence of credibility, as a reviewer asks for it (ASME V&V 40). Runs nothing."""
    from surrogate.cli import results
    from surrogate.cli.dossier import dossier as written

    loaded = _read(study)
    page = written(loaded, results.folder_of(loaded, results_dir), study)
    _show(page, as_json, hidden=quiet)


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
    from surrogate.cli import results, terminal
    from surrogate.cli.progress import StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        page = terminal.predict(loaded, folder, surrogate, at or [], points, steps)
    _show(page, as_json)


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

    loaded = _read(study)
    words = Goals(
        tuple(target or ()),
        tuple(minimise or ()),
        tuple(maximise or ()),
        tuple(subject_to or ()),
        tuple(fix or ()),
        tuple(free or ()),
        tuple(uncertain or ()),
        probability,
        candidates,
        surrogate,
    )
    folder = results.folder_of(loaded, results_dir)
    how = {"verify": verify, "quiet": quiet}
    page = solving.solve(loaded, folder, goal, words, runs=runs, workers=workers, **how)
    _show(page, as_json)


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
    from surrogate.cli import results, terminal
    from surrogate.cli.progress import StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        page = terminal.validate(loaded, folder, cases, steps)
    _show(page, as_json)


@app.command()
def calibrate(
    study: StudyFile, results_dir: Results = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Learn inputs from the measurements of calibration:, by the surrogates. Runs no solver."""
    from surrogate.cli import calibrating, results
    from surrogate.cli.progress import StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        page = calibrating.calibrate(loaded, folder, steps)
    _show(page, as_json)


@app.command()
def store(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Default: runs/<study>.nc beside the study.")
    ] = None,
) -> None:
    """Write the finished runs into a small file that ships with the study."""
    from surrogate.cli import results, terminal

    loaded = _read(study)
    page = terminal.store(loaded, results.folder_of(loaded, results_dir), to)
    _show(page, as_json, hidden=quiet)


@app.command()
def compare(
    a: Annotated[Path, typer.Argument(metavar="RESULTS_A", help="Results folder of a study.")],
    b: Annotated[Path, typer.Argument(metavar="RESULTS_B", help="The folder to set beside it.")],
    as_json: AsJson = False,
    quiet: Quiet = False,
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The page; default: RESULTS_B/compare.html.")
    ] = None,
) -> None:
    """Show what changed between two results folders, such as results/beam. Runs nothing."""
    from surrogate.cli.comparing import compare as compared

    _show(compared(a, b, to), as_json, hidden=quiet)


@app.command()
def export(
    study: StudyFile,
    kind: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="FORMAT",
            help="json, python, c, javascript, onnx or fmu.",
            autocompletion=completion.formats,
        ),
    ],
    to: Annotated[Path, typer.Option(metavar="FILE", help="The file to write.")],
    surrogate: Surrogate = None,
    output: Annotated[
        str | None,
        typer.Option(metavar="OUT", help="Which output; default: the only one."),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Name of the function; default: the output's."),
    ] = None,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write a surrogate as a file for other programs: C, Python, JavaScript, ONNX, FMU, JSON."""
    from surrogate.cli import exporting, results

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    page = exporting.export(loaded, folder, surrogate, output, kind, to, name)
    _show(page, as_json, hidden=quiet)


@app.command()
def serve(
    study: StudyFile,
    results_dir: Results = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 for any free one.")] = 4242,
    surrogate: Surrogate = None,
    solver: Annotated[bool, typer.Option("--solver", help="Serve the solver itself.")] = False,
    host: Annotated[
        str, typer.Option(help="Address to listen at; the default is this machine only.")
    ] = "127.0.0.1",
    workers: Annotated[int | None, typer.Option(min=1, help="Processes of the solver.")] = None,
    quiet: Quiet = False,
) -> None:
    """Serve the surrogates, or the solver, to other programs by UM-Bridge, until Ctrl-C."""
    from surrogate.cli import results, serving

    loaded = _read(study)
    with serving.server(
        loaded,
        results.folder_of(loaded, results_dir),
        surrogate=surrogate,
        solver=solver,
        port=port,
        host=host,
        workers=workers,
    ) as server:
        address = f"http://{host}:{server.server_address[1]}"
        print(address if quiet else f"{loaded.name}: {address}; Ctrl-C ends it", flush=True)
        server.serve_forever()


@app.command("list")
def list_plugins(as_json: AsJson = False, quiet: Quiet = False) -> None:
    """List solvers, designs, regressors and sensitivity methods, one line each."""
    from surrogate.cli.plugins import plugins

    _show(plugins(), as_json)


@app.command()
def schema(quiet: Quiet = False) -> None:
    """Print the JSON Schema of the study file."""
    from surrogate.study.schema import schema_text

    print(schema_text(), end="")


def _read(path: Path) -> Study:
    from surrogate.study.study import Study

    study = Study.from_yaml(path)
    gc.freeze()  # what is loaded by now stays: looking through it for cycles takes long
    gc.enable()
    return study


def _finish(study: Study, outcome: Outcome, as_json: bool, quiet: bool) -> None:
    from surrogate.cli import terminal
    from surrogate.cli.page import say

    _show(terminal.outcome(study, outcome), as_json, hidden=quiet)
    if outcome.trouble:
        say(outcome.trouble)
        raise typer.Exit(1)


def _show(page: Page, as_json: bool, *, hidden: bool = False) -> None:
    """Print a page, or its data; hidden: nothing where no data was asked for."""
    if as_json:
        from surrogate.stages.summary import json_data

        print(json.dumps(json_data(page.data), indent=1, default=str, allow_nan=False))
    elif not hidden:
        from rich.console import Console

        page.show(Console())


def main() -> None:
    """Run the command; people's mistakes end in sentences, never in a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # paths may hold bytes that are no UTF-8
            stream.reconfigure(errors="backslashreplace")
    carried_out(_command)


def _command() -> None:
    completes = "_SURROGATE_COMPLETE" in os.environ  # then the words stand there, not in argv
    if not completes and sys.argv[1:] in ([], ["-h"], ["--help"]):
        from surrogate.cli.overview import overview

        print(overview(app))
    else:
        app(prog_name="surrogate")
