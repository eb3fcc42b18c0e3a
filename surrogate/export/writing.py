"""Templates of source files, and numbers as C and NumPy read them."""

from __future__ import annotations

import textwrap
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

WIDTH = 100
TEMPLATES = Path(__file__).parent / "templates"


def template(file: str, **words: Any) -> str:
    """A template of this chapter, filled in."""
    return _environment().get_template(file).render(words)


def source(file: str) -> str:
    """A file of this chapter as it is."""
    return (TEMPLATES / file).read_text(encoding="utf-8")


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # what is written is source text
    )
    environment.filters |= {"array": _array("{}"), "list": _array("[]"), "texts": _texts}
    environment.filters |= {"real": lambda value: _number(float(value), "NAN")}
    return environment


def _array(brackets: str) -> Any:
    """Writer of nested numbers between brackets, in lines that are not too long."""
    missing = "NAN" if brackets == "{}" else "math.nan"

    def written(values: Any) -> str:
        flat = _nested(np.asarray(values).tolist(), brackets, missing)
        return "\n".join(
            textwrap.wrap(
                flat,
                WIDTH,
                subsequent_indent="    ",
                break_long_words=False,
                break_on_hyphens=False,
            )
        )

    return written


def _nested(values: Any, brackets: str, missing: str) -> str:
    if isinstance(values, list):
        inner = ", ".join(_nested(value, brackets, missing) for value in values)
        return f"{brackets[0]}{inner}{brackets[1]}"
    return _number(values, missing)


def _number(value: float | int, missing: str) -> str:
    return missing if value != value else repr(value)


def _texts(values: tuple[str, ...]) -> str:
    """Strings of C, whatever letters they have."""
    escaped = [value.replace("\\", r"\\").replace('"', r"\"") for value in values]
    return "{" + ", ".join(f'"{value}"' for value in escaped) + "}"
