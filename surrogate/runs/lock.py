"""One writer at a time: a lock that a dead process cannot keep and nobody can delete unnoticed.

The system holds it (POSIX locks, Windows' byte ranges). Where a file system knows no locks, as
some of clusters do, a file beside it takes its place: `surrogate.runs.claim`.
"""

from __future__ import annotations

import errno
import os
import sys
import threading
from contextlib import suppress
from pathlib import Path

from surrogate.errors import ResultsError
from surrogate.runs import claim

if sys.platform == "win32":
    import msvcrt
else:
    try:
        import fcntl
    except ImportError:  # a system without locks on files
        fcntl = None  # type: ignore[assignment]

#: Locks of POSIX keep other processes out; this keeps out the same process.
_HELD: set[str] = set()
#: What a system answers whose files cannot be locked.
_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOTSUP}
#: The byte that Windows locks: beyond the text, which others can read then.
_FAR = 2**30


#: Threads take locks one after the other: the system's locks are those of the whole process.
_TAKING = threading.Lock()


class Lock:
    """The lock on the folder of `path`, held until `release` or the end of this process.

    Raises `ResultsError` when another process, or this one, holds it.
    """

    def __init__(self, path: Path):
        self.path, self._name = path, os.path.realpath(path)
        with _TAKING:
            if self._name in _HELD:
                raise ResultsError(
                    f"{path.parent} is in use by this process already; wait until its other "
                    "study is done"
                )
            self._file, self._claimed = _taken(path)
            _HELD.add(self._name)

    def check(self) -> None:
        """See that the lock file is still there, and take it again where it was deleted.

        Raises `ResultsError` when another process has taken the lock in the meantime.
        """
        if not is_at(self._file, self.path):
            before = self._file
            self._file, self._claimed = _taken(self.path)
            os.close(before)

    def release(self) -> None:
        """Free the lock."""
        _HELD.discard(self._name)
        if self._claimed:
            claim.give_up(self.path)
        os.close(self._file)


def is_at(file: int, path: Path) -> bool:
    """True when the open file is still the one at `path`."""
    if sys.platform == "win32":
        return path.exists()  # an open file cannot be deleted or replaced there
    try:
        return os.path.samestat(os.fstat(file), os.stat(path))
    except FileNotFoundError:
        return False


def _taken(path: Path) -> tuple[int, bool]:
    """Descriptor of the locked file at `path`, which says who holds it; whether by a claim."""
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            claimed = not _locked(file)
            if claimed:
                claim.take(path)
        except (BlockingIOError, PermissionError):
            holder = _holder(path)
            os.close(file)
            raise ResultsError(
                f"{path.parent} is in use by {holder}; wait for it, or stop it, then run again"
            ) from None
        except BaseException:
            os.close(file)
            raise
        if is_at(file, path):
            break
        os.close(file)  # deleted between opening and locking: this lock would keep nobody out
    with suppress(OSError):  # the lock holds even where the disk has no room for the name
        os.ftruncate(file, 0)
        os.write(file, claim.who().encode())
    return file, claimed


def _locked(file: int) -> bool:
    """Lock the file; False where files cannot be locked. Raises what the system raises."""
    if sys.platform == "win32":
        os.lseek(file, _FAR, os.SEEK_SET)
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        os.lseek(file, 0, os.SEEK_SET)
        return True
    if fcntl is None:
        return False
    try:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
        return False
    return True


def _holder(path: Path) -> str:
    with suppress(OSError, ValueError):
        return path.read_text(encoding="utf-8").strip() or "another process"
    return "another process"
