"""The command as a whole, and what its verbs share: read a study, print a page."""

from __future__ import annotations

import gc
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from surrogate.cli.ending import stop

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


def read(path: Path) -> Study:
    """The study in a file; from here on the collector of garbage leaves alone what is loaded."""
    from surrogate.study.study import Study

    study = Study.from_yaml(path)
    gc.freeze()  # what is loaded by now stays: looking through it for cycles takes long
    gc.enable()
    return study


def finish(study: Study, outcome: Outcome, as_json: bool, quiet: bool) -> None:
    """Print what came of a study, and end with status 1 when something failed."""
    from surrogate.cli import findings
    from surrogate.cli.page import say

    show(findings.page(study, outcome), as_json, hidden=quiet)
    if outcome.trouble:
        say(outcome.trouble)
        raise typer.Exit(1)


def show(page: Page, as_json: bool, *, hidden: bool = False) -> None:
    """Print a page, or its data; hidden: nothing where no data was asked for."""
    if as_json:
        from surrogate.stages.summary import json_data

        print(json.dumps(json_data(page.data), indent=1, default=str, allow_nan=False))
    elif not hidden:
        from rich.console import Console

        page.show(Console())
