"""Which failed runs are done again: those of a status, or whose message holds a text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

STATUSES = ("failed", "timed_out")
MESSAGE = "message~"


def is_asked(status: str, message: str, rerun: Iterable[str]) -> bool:
    """True when a run that ended so, without an answer, is one of those to do again."""
    return any(
        one.removeprefix(MESSAGE) in message if one.startswith(MESSAGE) else one == status
        for one in rerun
    )


def mistakes(rerun: Iterable[str]) -> Iterator[str]:
    """A sentence for each entry that is neither a status nor a text to look for."""
    for one in rerun:
        if one == MESSAGE:
            yield "rerun: 'message~' needs a text: message~licence"
        elif one not in STATUSES and not one.startswith(MESSAGE):
            yield f"rerun: '{one}' is unknown; use failed, timed_out or message~text"
