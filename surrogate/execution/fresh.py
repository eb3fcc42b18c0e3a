"""Everything again: runs that take nothing over, and destroy nothing before they are done."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from surrogate.execution.execute import execute
from surrogate.execution.progress import Progress
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import Journal, read


def execute_fresh(
    spec: SolverSpec, columns: Mapping[str, Any], book: Journal, **options: Any
) -> Progress:
    """As `execute`, at every row; new records follow the old ones of `book` when all are done.

    Until then they stand in a journal of their own beside it. So an interrupted call is
    resumed by repeating it, and one that is given up has changed nothing. Of a key that stands
    twice in a journal the last record counts.
    """
    aside = _aside(book.folder)
    try:
        tally = execute(spec, columns, journal=aside, **options)
    except KeyboardInterrupt as stop:
        raise KeyboardInterrupt(*(f"{why}, with --fresh" for why in stop.args)) from None
    done = read(aside)
    for record in done.records.values():
        book.adopt(record, done)
    shutil.rmtree(aside)
    return tally


def interrupted(journal: Path) -> int:
    """Number of new runs that wait for an interrupted `execute_fresh` to be resumed."""
    return len(read(_aside(journal)).records)


def _aside(journal: Path) -> Path:
    return journal.with_name(f"{journal.name}_fresh")
