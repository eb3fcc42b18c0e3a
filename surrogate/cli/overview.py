"""What `surrogate --help` prints. Made here, because typer needs pydantic to make it."""

from __future__ import annotations

from inspect import getdoc
from shutil import get_terminal_size
from textwrap import fill

import typer

HEAD = (
    "Usage: surrogate VERB [STUDY.yaml] [OPTIONS]",
    "",
    "Designs of experiments, surrogates and sensitivity analysis of expensive simulations.",
    "",
)
FOOT = (
    "",
    "A study is code: verbs that read one load the solver and the modules that it names.",
    "surrogate VERB --help tells the options of a verb, surrogate --version the version. "
    "surrogate --install-completion teaches the shell to complete words at TAB.",
)
#: Longest line, where the terminal is wider.
WIDEST = 88


def overview(app: typer.Typer) -> str:
    """Every verb of the command with its first line."""
    verbs = [
        (one.name or one.callback.__name__, getdoc(one.callback) or "")
        for one in app.registered_commands
        if one.callback is not None
    ]
    width = min(get_terminal_size().columns, WIDEST)
    return "\n".join(
        [
            *(fill(line, width) for line in HEAD),
            *(_line(name, text, width) for name, text in verbs),
            *(fill(line, width) for line in FOOT),
        ]
    )


def _line(name: str, text: str, width: int) -> str:
    first = text.split("\n")[0]
    return fill(first, width, initial_indent=f"  {name:<10}", subsequent_indent=" " * 12)
