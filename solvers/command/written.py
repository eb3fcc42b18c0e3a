"""Files that a program wrote: text of regular files, never more than fits.

A program may leave a pipe, or a link to a device, where its output should be; reading that
would wait, or go on, for ever.
"""

from __future__ import annotations

import io
import os
import stat
from pathlib import Path
from typing import BinaryIO

#: Bytes of the largest file that is read whole.
LARGEST = 100_000_000

_NO_WAITING: int = getattr(os, "O_NONBLOCK", 0)


class Unfit(Exception):
    """The file cannot be read; the message goes on from its name."""


def text(path: Path) -> str:
    """The whole file; raises `Unfit` when it has more than `LARGEST` bytes, `OSError`."""
    with _opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > LARGEST:
            raise Unfit(
                f"has {size / 1e6:.0f} MB; at most {LARGEST / 1e6:.0f} MB are read. Let the "
                "program write its results into a smaller file of their own"
            )
        return _decoded(file.read(LARGEST), "utf-8-sig")


def tail(path: Path, size: int | None = None) -> str:
    """The last `size` bytes of the file, `LARGEST` when None; raises `Unfit`, `OSError`."""
    with _opened(path) as file:
        start = max(0, file.seek(0, os.SEEK_END) - (size or LARGEST))
        file.seek(start)
        return _decoded(file.read(size or LARGEST), "utf-8" if start else "utf-8-sig")


def _decoded(data: bytes, encoding: str) -> str:
    return io.TextIOWrapper(io.BytesIO(data), encoding, errors="replace").read()


def _opened(path: Path) -> BinaryIO:
    _check_regular(os.stat(path))
    file = open(path, "rb", opener=lambda name, flags: os.open(name, flags | _NO_WAITING))
    try:
        _check_regular(os.fstat(file.fileno()))
    except Unfit:
        file.close()
        raise
    return file


def _check_regular(status: os.stat_result) -> None:
    if not stat.S_ISREG(status.st_mode):
        raise Unfit("is no regular file but a folder, a pipe or a device")
