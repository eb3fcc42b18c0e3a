"""The temporary folder of a program's workers: owned by the program, gone with it.

A program that is killed together with its guardian leaves its folder; the next one finds
that nobody holds its lock, and removes it.
"""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from surrogate.errors import ResultsError, SurrogateError
from surrogate.runs.lock import Lock

PREFIX, LOCK = "surrogate-", "owner"


@contextmanager
def owned_folder() -> Iterator[Path]:
    """A new temporary folder, removed at the end; removes those of programs that were killed."""
    _remove_abandoned()
    try:
        folder, lock = _create()
    except OSError as error:
        raise SurrogateError(
            f"no temporary folder can be made in {tempfile.gettempdir()}: {error.strerror}; "
            "make room, or set TMPDIR to another folder"
        ) from error
    try:
        yield folder
    finally:
        lock.release()
        shutil.rmtree(folder, ignore_errors=True)


def _create() -> tuple[Path, Lock]:
    while True:
        folder = Path(tempfile.mkdtemp(prefix=PREFIX))
        # Another start may take it for abandoned, and remove it, before it is locked.
        with suppress(ResultsError, FileNotFoundError):
            return folder, Lock(folder / LOCK)


def _remove_abandoned() -> None:
    for path in Path(tempfile.gettempdir()).glob(f"{PREFIX}*/{LOCK}"):
        with suppress(ResultsError, OSError):
            if _is_ours(path.parent):
                _remove(path)


def _remove(path: Path) -> None:
    """Remove the folder of this lock, which is held meanwhile: a start may just have made it."""
    lock = Lock(path)
    try:
        shutil.rmtree(path.parent, ignore_errors=True)
    finally:
        lock.release()
    shutil.rmtree(path.parent, ignore_errors=True)  # Windows keeps a file that is open


def _is_ours(folder: Path) -> bool:
    """False for a folder that another user made: its lock could be a link to a file of ours."""
    status = folder.lstat()
    return stat.S_ISDIR(status.st_mode) and (
        not hasattr(os, "getuid") or status.st_uid == os.getuid()
    )


def worker_place(folder: Path, number: int) -> Path:
    """Temporary folder of a worker; what it prints goes to a file beside it."""
    place = folder / str(number)
    place.mkdir()
    return place
