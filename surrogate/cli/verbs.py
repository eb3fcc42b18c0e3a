"""The command `surrogate`: verbs only, each imports what it needs and calls one function.

`--help` and the small verbs answer at once: NumPy, SciPy and xarray are loaded by the
verbs that compute.

Exit status: 0 done; 1 ran, but something failed; 2 the input is wrong; 130 interrupted.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from contextlib import suppress
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from typer.core import TyperGroup

from surrogate.cli.retrying import RetryingCommand, chosen
from surrogate.errors import DesignError, PluginError, StudyError, SurrogateError

if TYPE_CHECKING:
    from surrogate.cli.page import Page
    from surrogate.cli.results import Outcome
    from surrogate.study.study import Study


class _Verbs(TyperGroup):
    """Says how far a verb came when it was interrupted; typer would end without a word."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stop:
            _stop(stop if stop.args else "interrupted", 130)


app = typer.Typer(
    cls=_Verbs,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Designs of experiments, surrogates and sensitivity analysis of expensive simulations.",
)

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY.yaml", help="The study file.")]
Results = Annotated[
    Path | None,
    typer.Option(
        "--results", metavar="DIR", help="Results go to DIR/<study>; default: results/<study>."
    ),
]
RetryFailed = Annotated[
    list[str] | None,
    typer.Option(
        "--retry-failed",
        metavar="[WHICH]",
        help="Do failed and timed-out runs again; WHICH: failed, timed_out or 'message~text'.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON, for scripts.")]


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
) -> None:
    """Write NAME.yaml: a commented study to start from, of a table with --data."""
    from surrogate.study import template

    path = template.write(name, data=data)
    print(f"{path} is written; next: surrogate check {path}")


@app.command()
def check(study: StudyFile, results_dir: Results = None, as_json: AsJson = False) -> None:
    """Show parameters, designs, aliasing, number of runs and time. Runs nothing.

    A study is code: reading it loads and builds the solver that it names, and loads the
    modules beside it. Check only studies of people you trust.
    """
    from surrogate.cli import results, terminal

    loaded = _read(study)
    _show(terminal.check(loaded, results.folder_of(loaded, results_dir)), as_json)


@app.command(cls=RetryingCommand)
def run(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes.")] = None,
    retry_failed: RetryFailed = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Do every run again, earlier and stored runs included.")
    ] = False,
) -> None:
    """Do what is missing: runs, fits, indices, report. Ctrl-C is safe."""
    from surrogate.cli import results
    from surrogate.cli.progress import RunsBar, StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    loaded = loaded.found(folder)
    for sentence in () if fresh else [*loaded.unused, *loaded.damaged(folder)]:
        print(sentence, file=sys.stderr)
    with RunsBar(loaded.name) as bar:
        runs = results.do_runs(
            loaded,
            folder,
            workers=workers,
            retry_failed=chosen(retry_failed),
            fresh=fresh,
            progress=bar,
        )
    with StagesBar(loaded.name) as steps:
        outcome = results.analyse(loaded, folder, runs, workers=workers, steps=steps)
    _finish(loaded, outcome, as_json)


@app.command(cls=RetryingCommand)
def work(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
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
    with RunsBar(loaded.name) as bar:
        loaded.run(
            workers=workers,
            results=folder,
            executor=loaded.shared,
            retry_failed=chosen(retry_failed),
            progress=bar,
        )
    _show(terminal.status(loaded, folder), as_json)


@app.command()
def status(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    watch: Annotated[bool, typer.Option("--watch", help="Again until all are done.")] = False,
) -> None:
    """Count the runs that are done, failed and left; show the time left."""
    from surrogate.cli import results, terminal

    loaded = _read(study)
    if watch:
        from surrogate.cli.watching import watch as keep_showing

        keep_showing(loaded, results.folder_of(loaded, results_dir))
        return
    _show(terminal.status(loaded, results.folder_of(loaded, results_dir)), as_json)


@app.command()
def report(study: StudyFile, results_dir: Results = None, as_json: AsJson = False) -> None:
    """Rebuild the report from the stored runs. Runs nothing."""
    from surrogate.cli import results
    from surrogate.cli.progress import StagesBar

    loaded = _read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name) as steps:
        outcome = results.analyse(loaded, folder, again=True, steps=steps)
    _finish(loaded, outcome, as_json)


@app.command()
def predict(
    study: StudyFile,
    at: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME=VALUE]...", help="A value for each parameter."),
    ] = None,
    points: Annotated[
        Path | None, typer.Option(metavar="CSV", help="Points; the header names the parameters.")
    ] = None,
    surrogate: Annotated[
        str | None, typer.Option(metavar="S", help="Which surrogate; default: the best.")
    ] = None,
    results_dir: Results = None,
    as_json: AsJson = False,
) -> None:
    """Predict outputs at new points, with intervals. Runs nothing."""
    from surrogate.cli import results, terminal

    loaded = _read(study)
    _show(
        terminal.predict(
            loaded, results.folder_of(loaded, results_dir), surrogate, at or [], points
        ),
        as_json,
    )


@app.command()
def validate(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    cases: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV, runs dataset or study; default: the study's own."),
    ] = None,
) -> None:
    """Compare surrogates and other models with reference cases. Runs no solver of the study."""
    from surrogate.cli import results, terminal

    loaded = _read(study)
    _show(terminal.validate(loaded, results.folder_of(loaded, results_dir), cases), as_json)


@app.command()
def store(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Default: runs/<study>.nc beside the study.")
    ] = None,
) -> None:
    """Write the finished runs into a small file that ships with the study."""
    from surrogate.cli import results, terminal

    loaded = _read(study)
    _show(terminal.store(loaded, results.folder_of(loaded, results_dir), to), as_json)


@app.command()
def serve(
    study: StudyFile,
    results_dir: Results = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 for any free one.")] = 4242,
    surrogate: Annotated[
        str | None, typer.Option(metavar="S", help="Which surrogate; default: the best.")
    ] = None,
    solver: Annotated[bool, typer.Option("--solver", help="Serve the solver itself.")] = False,
    host: Annotated[
        str, typer.Option(help="Address to listen at; the default is this machine only.")
    ] = "127.0.0.1",
    workers: Annotated[int | None, typer.Option(min=1, help="Processes of the solver.")] = None,
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
        print(
            f"{loaded.name}: http://{host}:{server.server_address[1]}; Ctrl-C ends it", flush=True
        )
        server.serve_forever()


@app.command("list")
def list_plugins(as_json: AsJson = False) -> None:
    """List solvers, designs, regressors and sensitivity methods, one line each."""
    from surrogate.cli.plugins import plugins

    _show(plugins(), as_json)


@app.command()
def schema() -> None:
    """Print the JSON Schema of the study file."""
    from surrogate.study.schema import json_schema

    print(json.dumps(json_schema(), indent=2))


def _read(path: Path) -> Study:
    from surrogate.study.study import Study

    return Study.from_yaml(path)


def _finish(study: Study, outcome: Outcome, as_json: bool) -> None:
    from surrogate.cli import terminal

    _show(terminal.outcome(study, outcome), as_json)
    if outcome.trouble:
        print(outcome.trouble, file=sys.stderr)
        raise typer.Exit(1)


def _show(page: Page, as_json: bool) -> None:
    if as_json:
        from surrogate.stages.summary import json_data

        print(json.dumps(json_data(page.data), indent=1, default=str, allow_nan=False))
    else:
        from rich.console import Console

        page.show(Console())


def main() -> None:
    """Run the command; people's mistakes end in sentences, never in a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # paths may hold bytes that are no UTF-8
            stream.reconfigure(errors="backslashreplace")
    try:
        _carry_out()
    except (StudyError, DesignError, PluginError) as error:
        _stop(error, 2)
    except SurrogateError as error:
        _stop(error, 1)
    except BrokenPipeError:  # whoever read our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        sys.exit(1)
    except OSError as error:
        _stop(_refused(error), 1)
    except Exception as error:  # a mistake of ours, not of the user
        log = Path("surrogate-error.log").absolute()
        with suppress(OSError):
            log.write_text(traceback.format_exc(), encoding="utf-8")
        _stop(
            f"internal error: {type(error).__name__}: {error}\nFinished runs are kept. "
            f"Please report it with {log}",
            1,
        )


def _carry_out() -> None:
    try:
        if sys.argv[1:] in ([], ["-h"], ["--help"]):
            from surrogate.cli.overview import overview

            print(overview(app))
        else:
            app()
    finally:
        sys.stdout.flush()


def _refused(error: OSError) -> str:
    """What the system refused: a file or folder, or, without a name, the output."""
    if error.filename is None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what still waits has nowhere to go
        return f"the output cannot be written: {error.strerror or error}"
    return (
        f"{os.fsdecode(error.filename)}: {error.strerror or error}; make room or choose another "
        "folder with --results, then do it again. Finished runs are kept"
    )


def _stop(why: object, status: int) -> NoReturn:
    print(why, file=sys.stderr)
    sys.exit(status)
