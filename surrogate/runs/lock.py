"""One writer at a time: a lock that a dead process cannot keep and nobody can delete unnoticed."""

from __future__ import annotations

import os
import socket
import sys
import time
from contextlib import suppress
from pathlib import Path

from surrogate.errors import ResultsError

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

#: Locks of POSIX keep other processes out; this keeps out the same process.
_HELD: set[str] = set()


class Lock:
    """The lock on the folder of `path`, held until `release` or the end of this process.

    Raises `ResultsError` when another process, or this one, holds it.
    """

    def __init__(self, path: Path):
        self.path, self._name = path, os.path.realpath(path)
        if self._name in _HELD:
            raise ResultsError(
                f"{path.parent} is in use by this process already; wait until its other "
                "study is done"
            )
        self._file = _taken(path)
        _HELD.add(self._name)

    def check(self) -> None:
        """See that the lock file is still there, and take it again where it was deleted.

        Raises `ResultsError` when another process has taken the lock in the meantime.
        """
        if not is_at(self._file, self.path):
            before, self._file = self._file, _taken(self.path)
            os.close(before)

    def release(self) -> None:
        """Free the lock."""
        _HELD.discard(self._name)
        os.close(self._file)


def is_at(file: int, path: Path) -> bool:
    """True when the open file is still the one at `path`."""
    try:
        return os.path.samestat(os.fstat(file), os.stat(path))
    except FileNotFoundError:
        return False


def _taken(path: Path) -> int:
    """Descriptor of the locked file at `path`, which says who holds it."""
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(file)
        except (BlockingIOError, PermissionError):
            holder = _holder(path)
            os.close(file)
            raise ResultsError(
                f"{path.parent} is in use by {holder}; wait for it, or stop it, then run again"
            ) from None
        except OSError:
            os.close(file)
            raise
        if is_at(file, path):
            break
        os.close(file)  # deleted between opening and locking: this lock would keep nobody out
    with suppress(OSError):  # the lock holds even where the disk has no room for the name
        os.ftruncate(file, 0)
        os.write(
            file,
            f"process {os.getpid()} on {socket.gethostname()}, "
            f"since {time.strftime('%Y-%m-%d %H:%M:%S')}".encode(),
        )
    return file


def _lock(file: int) -> None:
    if sys.platform == "win32":
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _holder(path: Path) -> str:
    with suppress(OSError, ValueError):
        return path.read_text().strip() or "another process"
    return "another process"
