"""Docstrings of this project as reStructuredText.

They are plain text for people who read the source. Two habits need a hand: rows of
`name    what it is`, which become lists, and signs such as `*` and `|`, which are mathematics
and no markup.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sphinx.application import Sphinx

ROW = re.compile(r"^(?P<name>[A-Za-z_][\w.]*(?:, \w+)*) {2,}(?P<said>\S.*)$")
LITERAL = re.compile(r"(``.+?``|`[^`]+`)")


def setup(app: Sphinx) -> dict[str, Any]:
    """Take part in reading docstrings."""
    app.connect("autodoc-process-docstring", _process)
    app.connect("autodoc-skip-member", _skip)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _process(
    app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]
) -> None:
    lines[:] = list(markup(lines))


def _skip(
    app: Sphinx, what: str, name: str, obj: object, skip: bool, options: object
) -> bool | None:
    """Leave out what scikit-learn adds to every estimator."""
    return True if re.fullmatch(r"set_\w+_request", name) else None


def markup(lines: list[str]) -> Iterator[str]:
    """The lines of a docstring, such that they mean in markup what they show as text."""
    literal, in_row, before = False, False, ""
    for line in lines:
        indented = line.startswith((" ", "\t"))
        if literal and line.strip() and not indented:
            literal = False
        row = None if literal or indented else ROW.match(line)
        if literal or line.lstrip().startswith((">>>", "..")):
            yield line
        elif row:
            if before.strip() and not in_row:
                yield ""
            yield f"- ``{row['name']}``: {plain(row['said'])}"
        elif in_row and indented:
            yield f"  {plain(line.strip())}"
        else:
            if in_row and line.strip():
                yield ""
            yield line[: len(line) - len(line.lstrip())] + plain(line.lstrip())
        in_row = bool(row) or (in_row and indented)
        literal = literal or line.rstrip().endswith("::")
        before = line


def plain(text: str) -> str:
    """Text without meaning as markup, but for what stands in backticks."""
    parts = LITERAL.split(text)
    return "".join(
        part if LITERAL.fullmatch(part) else re.sub(r"([*|\\])|(?<=\w)(_)(?!\w)", r"\\\1\2", part)
        for part in parts
    )
