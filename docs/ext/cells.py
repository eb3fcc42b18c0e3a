"""Cells of notebooks as readers type them: files with their names, commands with a prompt.

A cell that begins with `%%writefile spring.yaml` is shown as that file, one of lines with `!` as
commands for the terminal.
"""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

WRITE = "%%writefile "
LANGUAGES = {".py": "python", ".yaml": "yaml"}


def setup(app: Sphinx) -> dict[str, Any]:
    """Take part in what is read, before it is highlighted."""
    app.connect("doctree-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _read(app: Sphinx, doctree: nodes.document) -> None:
    for block in list(doctree.findall(nodes.literal_block)):
        text = block.astext()
        if text.startswith(WRITE):
            first, _, rest = text.partition("\n")
            name = first.removeprefix(WRITE)
            shown = _replace(block, rest, LANGUAGES.get(PurePath(name).suffix, "text"), name)
            doctree.set_id(shown)
        elif text.startswith("!") and block.get("language", "").startswith("ipython"):
            lines = [line.replace("!", "$ ", 1) for line in text.splitlines()]
            _replace(block, "\n".join(lines), "console", "")


def _replace(block: nodes.literal_block, text: str, language: str, caption: str) -> nodes.Element:
    shown = nodes.literal_block(text, text, language=language, classes=block["classes"])
    if not caption:
        block.replace_self(shown)
        return shown
    named = nodes.container("", literal_block=True, classes=["literal-block-wrapper"])
    named += nodes.caption("", caption)
    named += shown
    block.replace_self(named)
    return named
