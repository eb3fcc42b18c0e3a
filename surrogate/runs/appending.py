"""A file that only grows, by whole pieces."""

from __future__ import annotations

import os
from pathlib import Path

from surrogate.errors import ResultsError
from surrogate.runs.lock import is_at


class AppendedFile:
    """The file at `path`, open for appending; cut: bytes of it that count, None for all.

    A piece that does not fit is taken back. Every piece goes to the end as it then is,
    so a second writer would destroy nothing.
    """

    def __init__(self, path: Path, cut: int | None = None):
        self.path = path
        binary = getattr(os, "O_BINARY", 0)
        self.file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | binary, 0o666)
        if cut is not None and cut < os.fstat(self.file).st_size:
            os.ftruncate(self.file, cut)
        self.clean = True

    def write(self, data: bytes) -> int:
        """Offset at which `data` now stands."""
        left = memoryview(data)
        try:
            while left:
                left = left[os.write(self.file, left) :]
        except OSError:
            self._take_back(len(data) - len(left))
            raise
        self.clean = False
        return os.lseek(self.file, 0, os.SEEK_CUR) - len(data) if data else self._size()

    def _take_back(self, written: int) -> None:
        end = os.lseek(self.file, 0, os.SEEK_CUR)
        if written and end == self._size():
            os.ftruncate(self.file, end - written)

    def _size(self) -> int:
        return os.fstat(self.file).st_size

    def check(self) -> None:
        """Raise `ResultsError` when the file is no longer the one at its path."""
        if not is_at(self.file, self.path):
            raise ResultsError(
                f"{self.path} was deleted or replaced while runs were written to it; the runs "
                "of this time may be lost with it. Run again, and leave the folder alone meanwhile"
            )

    def sync(self) -> None:
        """Force what was written onto the disk."""
        if not self.clean:
            os.fsync(self.file)
            self.clean = True

    def close(self) -> None:
        """Close the file."""
        os.close(self.file)
