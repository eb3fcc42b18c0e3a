"""Arguments and options that several verbs take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from surrogate.cli import completion

StudyFile = Annotated[
    Path,
    typer.Argument(
        metavar="STUDY.yaml", help="The study file.", autocompletion=completion.study_files
    ),
]
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
Surrogate = Annotated[
    str | None,
    typer.Option(
        metavar="S",
        help="Which surrogate; default: the best.",
        autocompletion=completion.surrogates,
    ),
]
Values = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[NAME=VALUE]...",
        help="A value for each parameter.",
        autocompletion=completion.parameters,
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON, for scripts.")]
Quiet = Annotated[
    bool,
    typer.Option("--quiet", "-q", help="Print nothing but errors and the result asked for."),
]
