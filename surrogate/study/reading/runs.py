"""From the words of a study to the runs that ship with it."""

from __future__ import annotations

from pathlib import Path

from surrogate.runs import stored
from surrogate.runs.stored import StoredRuns
from surrogate.study.reading.mistakes import Reading


def stored_of(reading: Reading) -> tuple[StoredRuns, ...]:
    """The files under `stored:`, read whole."""
    found = []
    for index, name in enumerate(reading.part.stored):
        with reading.mistakes_at("stored", index):
            found.append(stored.load((reading.folder or Path()) / name, name))
    return tuple(found)
