"""Results handed on to files and other programs, and what is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from surrogate.cli import completion
from surrogate.cli.options import AsJson, Quiet, Results, StudyFile, Surrogate
from surrogate.cli.verbs.app import app, read, show


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
    from surrogate.cli import results, storing

    loaded = read(study)
    page = storing.store(loaded, results.folder_of(loaded, results_dir), to)
    show(page, as_json, hidden=quiet)


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

    show(compared(a, b, to), as_json, hidden=quiet)


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

    loaded = read(study)
    folder = results.folder_of(loaded, results_dir)
    page = exporting.export(loaded, folder, surrogate, output, kind, to, name)
    show(page, as_json, hidden=quiet)


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

    loaded = read(study)
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

    show(plugins(), as_json)


@app.command()
def schema(quiet: Quiet = False) -> None:
    """Print the JSON Schema of the study file."""
    from surrogate.study.schema import schema_text

    print(schema_text(), end="")
