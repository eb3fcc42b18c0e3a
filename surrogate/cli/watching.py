"""`surrogate status --watch`: how far the runs are, again and again, until none is left."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from surrogate.cli import standing
from surrogate.cli.page import Page
from surrogate.cli.progress import duration
from surrogate.stages.summary import json_data
from surrogate.study.study import Study

#: Seconds between two looks on a terminal, and between two lines elsewhere.
LOOK, A_LINE = 5.0, 60.0


def watch(
    study: Study,
    results: Path,
    console: Console | None = None,
    sleep: Callable[[float], None] = time.sleep,
    as_json: bool = False,
) -> None:
    """Show the status until all runs are done: a page on a terminal, else a line a minute.

    as_json: a line of JSON in place of either.
    """
    console = console or Console()
    while True:
        page = standing.status(study, results)
        if as_json:
            print(json.dumps(json_data(page.data), allow_nan=False), flush=True)
        elif console.is_terminal:
            console.clear()
            page.show(console)
        else:
            line = f"{time.strftime('%H:%M')} {_line(str(page.parts[0]), page.data)}"
            Page(page.data, [line]).show(console)
            sys.stdout.flush()
        if not page.data["runs"]["missing"]:
            return
        sleep(LOOK if console.is_terminal else A_LINE)


def _line(first: str, data: Mapping[str, Any]) -> str:
    """What is done, and the time left as far as it is known."""
    seconds = data["seconds_left"]
    return f"{first}; about {duration(seconds)} left" if seconds else first
