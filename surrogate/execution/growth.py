"""Designs that grow while their runs are done: what `execute` and `work` ask of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from surrogate.runs.identity import RunInputs
from surrogate.runs.record import Record

#: The finished run of a key; None while there is none.
Find = Callable[[str], Record | None]


class Growth(Protocol):
    """Adds runs as answers come."""

    def more(self, find: Find, free: int) -> Mapping[str, RunInputs]:
        """Runs that were not asked for before, key -> inputs; none while others must end first.

        free  runs that could begin now
        """

    @property
    def ahead(self) -> int:
        """Runs that may still be added, at most."""
