"""What `surrogate --help` prints. Made here, because typer needs pydantic to make it."""

from __future__ import annotations

from inspect import getdoc
from textwrap import fill

import typer

HEAD = """\
Usage: surrogate VERB [STUDY.yaml] [OPTIONS]

Designs of experiments, surrogates and sensitivity analysis of expensive simulations.
"""
FOOT = """\
A study is code: verbs that read one load the solver and the modules that it names.
surrogate VERB --help tells the options of a verb, surrogate --version the version."""


def overview(app: typer.Typer) -> str:
    """Every verb of the command with its first line."""
    verbs = [
        (one.name or one.callback.__name__, getdoc(one.callback) or "")
        for one in app.registered_commands
        if one.callback is not None
    ]
    return "\n".join([HEAD, *(_line(name, text) for name, text in verbs), "", FOOT])


def _line(name: str, text: str) -> str:
    first = text.split("\n")[0]
    return fill(first, width=88, initial_indent=f"  {name:<10}", subsequent_indent=" " * 12)
