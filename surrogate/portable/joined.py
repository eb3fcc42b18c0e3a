"""One script of several ES modules, for pages that open without a server.

The modules are written so that browsers and Node load them as they are: one import of names a
line, and exports in front of declarations. Joined, they share one scope, so that names at their
top level must all differ.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

JAVASCRIPT = Path(__file__).parent / "javascript"

_IMPORT = re.compile(r'^import \{[^}]*\} from "([^"]+)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?function|const|class)", re.MULTILINE)
_NAME = re.compile(r"^(?:async )?(?:function\*?|const|let|class) (\w+)", re.MULTILINE)
_COMMENT = re.compile(r"^\s*//.*\n", re.MULTILINE)
_INDENT = re.compile(r"^ +", re.MULTILINE)


def script(entry: Path) -> str:
    """The modules that `entry` imports, directly or not, and itself, as one strict function.

    Raises ValueError for a name that two modules declare.
    """
    return f'"use strict";\n(() => {{\n{body(entry)}}})();\n'


def body(entry: Path) -> str:
    """The modules one behind the other, without comments of whole lines, indents and exports.

    Raises ValueError for a name that two modules declare.
    """
    parts: list[str] = []
    owners: dict[str, str] = {}
    for path in modules(entry):
        text = _EXPORT.sub("", _IMPORT.sub("", path.read_text(encoding="utf-8")))
        for name in _NAME.findall(text):
            if owners.setdefault(name, path.name) != path.name:
                raise ValueError(f"{owners[name]} and {path.name} both declare '{name}'")
        parts.append(bare(text))
    return "".join(parts)


def bare(text: str) -> str:
    """A script without comments of whole lines (//) and without indents."""
    return _INDENT.sub("", _COMMENT.sub("", text))


def bare_style(text: str) -> str:
    """A style sheet without the white space that only people need."""
    return re.sub(r"\s*([{};,])\s*|(?<=:) +", r"\1", text)


def modules(entry: Path) -> list[Path]:
    """Files of a module and all that it imports, each behind those that it needs."""
    found: dict[Path, None] = {}

    def visit(path: Path) -> Iterator[Path]:
        for name in _IMPORT.findall(path.read_text(encoding="utf-8")):
            needed = (path.parent / name).resolve()
            if needed not in found:
                yield from visit(needed)
        found[path] = None
        yield path

    return list(dict.fromkeys(visit(entry.resolve())))
