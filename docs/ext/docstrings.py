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
    place = 0
    while place < len(lines):
        line = lines[place]
        row = ROW.match(line)
        inner = _indented(lines, place + 1)
        place += 1 + len(inner)
        if line.lstrip().startswith((">>>", "..")):
            yield from (line, *inner)
        elif row:
            before = lines[place - len(inner) - 2] if place > len(inner) + 1 else ""
            if before.strip() and not (ROW.match(before) or before.startswith(" ")):
                yield ""
            yield f"- ``{row['name']}``: {plain(row['said'])}"
            yield from (f"  {plain(one.strip())}" for one in inner if one.strip())
            if _text(lines, place) and not ROW.match(lines[place]):
                yield ""
        elif inner and line.strip():
            yield plain(line) if line.rstrip().endswith("::") else f"{plain(line)} ::"
            yield from ("", *inner, "")
        else:
            yield from (plain(line), *inner)


def _indented(lines: list[str], place: int) -> list[str]:
    """The lines from `place` on that are indented, with blank ones between them."""
    end = place
    while end < len(lines) and (not lines[end].strip() or lines[end].startswith(" ")):
        end += 1
    while end > place and not lines[end - 1].strip():
        end -= 1
    return lines[place:end]


def _text(lines: list[str], place: int) -> bool:
    return place < len(lines) and bool(lines[place].strip())


def plain(text: str) -> str:
    """Text without meaning as markup, but for what stands in backticks."""
    parts = LITERAL.split(text)
    return "".join(
        part if LITERAL.fullmatch(part) else re.sub(r"([*|\\])|(?<=\w)(_)(?!\w)", r"\\\1\2", part)
        for part in parts
    )
