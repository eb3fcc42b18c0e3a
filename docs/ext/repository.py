"""Pages that live elsewhere in the repository, and links that work on GitHub and on the site.

A link is written relative to its file, as GitHub wants it. When it leads to a file that is a page
of the site too, it becomes a link to that page. `include` takes the text of a file with its
links put right.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

#: Files of the repository -> the pages that show them.
PAGES = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "DECISIONS.md": "decisions.md",
    "CHANGELOG.md": "changes.md",
    "solvers/leg_bandage/README.md": "bandage_model.md",
    "solvers/leg_bandage/scan/SCANS.md": "bandage_scans.md",
    "solvers/leg_bandage/prediction/PREDICTION.md": "bandage_prediction.md",
    "solvers/leg_bandage/data/README.md": "bandage_data.md",
}
INCLUDE = re.compile(r"^```\{include\} (\S+)\n```$", re.MULTILINE)
LINK = re.compile(r"(?<=\]\()(?!\w+:|#|/)([^)\s#]+)(?=[)#])")


def setup(app: Sphinx) -> dict[str, Any]:
    """Take part in reading pages, after the generated ones are written."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _read(app: Sphinx, page: str, source: list[str]) -> None:
    path = Path(app.env.doc2path(page))
    if path.suffix == ".md":
        source[0] = text_of(source[0], path, path, Path(app.srcdir))


def text_of(text: str, file: Path, page: Path, docs: Path) -> str:
    """The text of `file` as it stands in `page`, what it includes as well."""

    def included(found: re.Match[str]) -> str:
        inner = (file.parent / found[1]).resolve()
        return text_of(inner.read_text(encoding="utf-8"), inner, page, docs)

    def linked(found: re.Match[str]) -> str:
        return link(found[1], file, page, docs)

    return INCLUDE.sub(included, LINK.sub(linked, text))


def link(target: str, file: Path, page: Path, docs: Path) -> str:
    """Where a link of `file` leads when it stands in `page`."""
    path = (file.parent / target).resolve()
    if not path.exists():
        return target  # a page that is generated
    shown = PAGES.get(path.relative_to(docs.parent).as_posix())
    if shown:
        path = docs / shown
    return Path(os.path.relpath(path, page.parent)).as_posix()
