"""One writer at a time: a lock that a dead process cannot keep."""

from __future__ import annotations

import os
import socket
import time
from contextlib import suppress
from pathlib import Path

from surrogate.errors import ResultsError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
    import msvcrt

#: Locks of POSIX keep other processes out; this keeps out the same process.
_HELD: set[str] = set()


def take_lock(path: Path) -> int:
    """Descriptor that holds the lock on `path`; it is free when this process ends, however it does.

    Raises `ResultsError` when another process, or this one, holds it.
    """
    name = os.path.realpath(path)
    if name in _HELD:
        raise ResultsError(
            f"{path.parent} is in use by this process already; wait until its other study is done"
        )
    lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        if fcntl:
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            msvcrt.locking(lock, msvcrt.LK_NBLCK, 1)
    except (BlockingIOError, PermissionError):
        holder = _holder(path)
        os.close(lock)
        raise ResultsError(
            f"{path.parent} is in use by {holder}; wait for it, or stop it, then run again"
        ) from None
    except OSError:
        os.close(lock)
        raise
    with suppress(OSError):  # the lock holds even where the disk has no room for the name
        os.ftruncate(lock, 0)
        os.write(
            lock,
            f"process {os.getpid()} on {socket.gethostname()}, "
            f"since {time.strftime('%Y-%m-%d %H:%M:%S')}".encode(),
        )
    _HELD.add(name)
    return lock


def _holder(path: Path) -> str:
    with suppress(OSError):
        return path.read_text().strip() or "another process"
    return "another process"


def release_lock(path: Path, lock: int) -> None:
    """Free a lock."""
    _HELD.discard(os.path.realpath(path))
    os.close(lock)
