"""How far jobs in other processes are: memory that they write and their parent reads.

A line a job, overwritten without a lock: a reader may meet half a line, which is left out, and
a writer that is killed holds nothing up.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from contextlib import suppress

from surrogate.counting import Reached

#: Bytes of a line.
WIDTH = 128
END = b"\n"


class Board:
    """A line for each job, by its label; goes to a process among the arguments of its start."""

    def __init__(self, labels: Sequence[str]):
        self.places = {label: k * WIDTH for k, label in enumerate(labels)}
        context = multiprocessing.get_context("spawn")
        self.bytes = context.RawArray("c", max(len(labels), 1) * WIDTH)

    def write(self, label: str, part: Reached) -> None:
        """How far the job is."""
        start, text = self.places[label], part.text.encode()[: WIDTH - 16]
        line = f"{part.share:.6f} ".encode() + text + END
        self.bytes[start : start + len(line)] = line

    def read(self, label: str) -> Reached | None:
        """What was written of the job last; None when there is nothing, or half a line."""
        start = self.places[label]
        line, end, _ = bytes(self.bytes[start : start + WIDTH]).partition(END)
        share, space, text = line.decode("utf-8", "replace").partition(" ")
        with suppress(ValueError):
            return Reached(text, float(share)) if end and space else None
        return None
