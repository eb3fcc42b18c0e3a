"""The command `surrogate`: verbs only, each calls one function.

Exit status: 0 done; 1 ran, but something failed; 2 the input is wrong; 130 interrupted.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from surrogate import __version__, pages, plugins, results, starting, studyfile
from surrogate.errors import DesignError, PluginError, StudyError, SurrogateError
from surrogate.progress import RunsBar
from surrogate.study import Study

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False,
                  context_settings={"help_option_names": ["-h", "--help"]},
                  help="From an expensive simulation to a cheap model that can be trusted.")

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY.yaml", help="the study file")]
Results = Annotated[Path | None, typer.Option("--results", metavar="DIR",
                    help="where results/<study> goes; default: the current folder")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON for scripts")]
SurrogateName = Annotated[str | None, typer.Option("--surrogate", metavar="S",
                          help="which surrogate; default: the best one")]


@app.command()
def new(name: Annotated[str, typer.Argument(metavar="NAME")]) -> None:
    """Write NAME.yaml, a commented study to start from."""
    path = starting.write(name)
    print(f"{path} is written; next: surrogate check {path}")


@app.command()
def check(study: StudyFile, results_dir: Results = None, as_json: AsJson = False) -> None:
    """Read a study; show parameters, designs, aliasing, run count and time. Runs nothing."""
    _show(pages.check(Study.from_yaml(study), _folder(results_dir)), as_json)


@app.command()
def run(study: StudyFile, results_dir: Results = None, as_json: AsJson = False,
        workers: Annotated[int | None, typer.Option(min=1, help="processes")] = None,
        retry: Annotated[bool, typer.Option("--retry-failed", help="do failed runs again")] = False,
        ) -> None:
    """Go the whole way to the report; does only what is missing. Ctrl-C is safe."""
    loaded = Study.from_yaml(study)
    with RunsBar(loaded.name) as bar:
        outcome = results.complete(loaded, results.folder_of(loaded, results_dir),
                                   workers=workers, retry_failed=retry, progress=bar)
    _show(pages.outcome(outcome), as_json)
    if outcome.trouble:
        print(outcome.trouble, file=sys.stderr)
        raise typer.Exit(1)


@app.command()
def status(study: StudyFile, results_dir: Results = None, as_json: AsJson = False) -> None:
    """How many runs are done, failed and left, and the time left."""
    _show(pages.status(Study.from_yaml(study), _folder(results_dir)), as_json)


@app.command()
def report(study: StudyFile, results_dir: Results = None) -> None:
    """Rebuild the report from the stored runs; runs nothing."""
    loaded = Study.from_yaml(study)
    outcome = results.analyse(loaded, results.folder_of(loaded, results_dir))
    print(f"report: {outcome.report}")


@app.command(context_settings={"allow_extra_args": True})
def predict(context: typer.Context, study: StudyFile, results_dir: Results = None,
            surrogate: SurrogateName = None, as_json: AsJson = False,
            points: Annotated[Path | None, typer.Option(help="CSV of points")] = None) -> None:
    """Predict at `name=value ...` (or --points FILE.csv), with intervals; no solver run."""
    loaded = Study.from_yaml(study)
    _show(pages.predict(loaded, results.folder_of(loaded, results_dir), surrogate,
                        context.args, points), as_json)


@app.command("list")
def list_plugins(as_json: AsJson = False) -> None:
    """Solvers, designs, regressors and sensitivity methods, with one line each."""
    _show(pages.plugins(), as_json)


@app.command()
def schema() -> None:
    """Print the JSON Schema of the study file."""
    print(json.dumps(studyfile.json_schema(), indent=2))


@app.callback(invoke_without_command=True)
def _version(version: Annotated[bool, typer.Option("--version", help="show it")] = False) -> None:
    if version:
        print(__version__)
        raise typer.Exit()
