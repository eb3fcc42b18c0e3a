"""The profiler as markup: what is known of the study, and the program that shows it.

Both are gzip in base64, an eighth of their size: a page of a small study stays small.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from markupsafe import Markup

from surrogate.portable.joined import bare, bare_style, script
from surrogate.report.content import Content
from surrogate.report.profiler.chosen import Chosen
from surrogate.report.profiler.payload import payload
from surrogate.report.profiler.scene_data import shown_geometry
from surrogate.report.profiler.stills import stills

HERE = Path(__file__).parent
_LAYOUT = Markup(
    '<div class="profiler" id="explore-profiler" hidden></div>\n'
    "{still}"
    "<noscript><p>The profiler needs scripts, which this browser does not run.</p></noscript>\n"
    '<script type="text/plain" id="explore-data">{data}</script>\n'
    '<script type="text/plain" id="explore-program">{program}</script>\n'
    "<script>{unpack}</script>"
)


def widget(content: Content, shown: list[Chosen], leading: Sequence[str] = ()) -> Markup:
    """Everything of the profiler that stands in the page; leading: as `payload` takes it."""
    data = json.dumps(payload(content, shown, leading), separators=(",", ":"), allow_nan=False)
    unpack = Markup(bare((HERE / "unpack.js").read_text(encoding="utf-8")))
    geometry = shown_geometry(content)
    still = Markup("") if geometry is None else stills(content, shown, geometry)
    return _LAYOUT.format(data=_packed(data), program=program(), unpack=unpack, still=still)


@cache
def program() -> str:
    """Style and joined modules, packed; the same for every study."""
    style = bare_style((HERE / "profiler.css").read_text(encoding="utf-8"))
    code = script(HERE / "javascript" / "main.js")
    return _packed(json.dumps({"style": style, "code": code}))


def _packed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")
