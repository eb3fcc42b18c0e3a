"""Memory of a run: what its worker and all that it started hold in RAM together.

It is watched and not limited by the system: RLIMIT_AS counts addresses that numerical
libraries, Java and GPUs reserve and never use, and RLIMIT_DATA knows one process at a time.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

from surrogate.execution import guardian

#: Seconds between two looks.
LOOK_SECONDS = 0.25

#: Whether this system tells.
KNOWN = sys.platform == "linux"


def held(worker: int, place: Path) -> int:
    """Bytes that a worker and its descendants hold; pages that they share count once.

    place: temporary folder of the worker.
    """
    return sum(_proportional(pid) for pid in guardian.tree({worker: place}))


def is_above(limit: float, worker: int, place: Path) -> bool:
    """True when they hold more than `limit` bytes; quick while they are far below it."""
    resident = sum(_resident(pid) for pid in guardian.tree({worker: place}))
    return resident > limit and held(worker, place) > limit


def _resident(pid: int) -> int:
    with suppress(OSError), open(f"/proc/{pid}/statm", "rb") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return 0


def _proportional(pid: int) -> int:
    """Resident bytes, each page divided by the number of processes that share it."""
    with suppress(OSError), open(f"/proc/{pid}/smaps_rollup", "rb") as file:
        for line in file:
            if line.startswith(b"Pss:"):
                return 1024 * int(line.split()[1])
    return _resident(pid)
