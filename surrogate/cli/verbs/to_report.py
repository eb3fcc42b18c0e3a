"""From a study to its report: write one, look at it, do its runs, show what came of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from surrogate.cli.options import AsJson, Quiet, Results, RetryFailed, StudyFile
from surrogate.cli.retrying import RetryingCommand, chosen
from surrogate.cli.verbs.app import app, finish, read, show


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
    show(Page({"file": str(path)}, [done]), False, hidden=quiet)


@app.command()
def check(
    study: StudyFile,
    model: Annotated[
        str | None,
        typer.Option(
            metavar="MODEL",
            help="Precision of linear, interactions, quadratic or 'a, b, a:b' on every design.",
        ),
    ] = None,
    effect: Annotated[
        float, typer.Option(help="Effect to find, in standard deviations of the error.")
    ] = 2.0,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Show parameters, designs, aliasing, precision, runs and time. Runs nothing.

    A study is code: reading it loads and builds the solver that it names, and loads the
    modules beside it. Check only studies of people you trust.
    """
    from surrogate.cli import results, standing

    loaded = read(study)
    page = standing.check(loaded, results.folder_of(loaded, results_dir), model, effect)
    show(page, as_json, hidden=quiet)


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

    loaded = read(study)
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
    finish(loaded, outcome, as_json, quiet)


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
    from surrogate.cli import results, standing
    from surrogate.cli.progress import RunsBar

    loaded = read(study)
    folder = results.folder_of(loaded, results_dir)
    with RunsBar(loaded.name, hidden=quiet) as bar:
        loaded.run(
            workers=workers,
            results=folder,
            executor=loaded.shared,
            retry_failed=chosen(retry_failed),
            progress=bar,
        )
    show(standing.status(loaded, folder), as_json, hidden=quiet)


@app.command()
def status(
    study: StudyFile,
    results_dir: Results = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    watch: Annotated[bool, typer.Option("--watch", help="Again until all are done.")] = False,
) -> None:
    """Count the runs that are done, failed and left; show the time left."""
    from surrogate.cli import results, standing

    loaded = read(study)
    if watch:
        from surrogate.cli.watching import watch as keep_showing

        keep_showing(loaded, results.folder_of(loaded, results_dir), as_json=as_json)
        return
    show(standing.status(loaded, results.folder_of(loaded, results_dir)), as_json)


@app.command()
def report(
    study: StudyFile, results_dir: Results = None, as_json: AsJson = False, quiet: Quiet = False
) -> None:
    """Rebuild the report from the stored runs. Runs nothing."""
    from surrogate.cli import results
    from surrogate.cli.progress import StagesBar

    loaded = read(study)
    folder = results.folder_of(loaded, results_dir)
    with StagesBar(loaded.name, hidden=quiet) as steps:
        outcome = results.analyse(loaded, folder, again=True, steps=steps)
    finish(loaded, outcome, as_json, quiet)


@app.command("open")
def open_report(study: StudyFile, results_dir: Results = None, quiet: Quiet = False) -> None:
    """Show the report in the browser, and say where it lies. Runs nothing."""
    from surrogate.cli import browsing, results
    from surrogate.cli.page import say

    loaded = read(study)
    path, notes = browsing.report_of(loaded, results.folder_of(loaded, results_dir), study)
    if not quiet:
        print(path, flush=True)
        for note in notes:
            say(note)
    if not browsing.browse(path):
        say("no browser can be started here; open the file in one")
        raise typer.Exit(1)
