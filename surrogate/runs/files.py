"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import secrets
import tempfile
from contextlib import suppress
from pathlib import Path

from surrogate.errors import ResultsError


def write_bytes(path: str | Path, content: bytes | memoryview, *, sync: bool = True) -> None:
    """Write `content` into `path`; until it is whole, an older file stays as it is.

    sync  wait until the disk has it; False for what is checked when read and can be made again
    Raises `ResultsError` when the disk does not take it.
    """
    path = Path(path)
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        number, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with open(number, "wb") as file:
            file.write(content)
            file.flush()
            if sync:
                os.fsync(number)
        os.chmod(temporary, 0o666 & ~_mask())  # as a newly made file has; mkstemp's are narrower
        os.replace(temporary, path)
    except OSError as error:
        raise ResultsError(
            f"cannot write {path}: {error.strerror or error}; "
            "make room or choose another folder, then run again"
        ) from error
    finally:
        if temporary is not None:
            with suppress(FileNotFoundError):
                os.unlink(temporary)


def write_new(path: str | Path, text: str) -> bool:
    """Write a new file, whole or not at all; False when it is there already, which stays.

    Of several processes that write the same file at once one does.
    """
    path = Path(path)
    whole = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    write_text(whole, text)
    try:
        os.link(whole, path)
    except FileExistsError:
        return False
    except OSError:  # a folder without links: one process makes the file, and then fills it
        if not _claimed(path):
            return False
        os.replace(whole, path)
    finally:
        with suppress(FileNotFoundError):
            os.unlink(whole)
    return True


def _claimed(path: Path) -> bool:
    """True when this process has made the file."""
    try:
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    except FileExistsError:
        return False
    except OSError as error:
        raise ResultsError(f"cannot write {path}: {error.strerror or error}") from error
    return True


def write_text(path: str | Path, text: str, *, sync: bool = True) -> None:
    """Write `text` as UTF-8, whole or not at all; bytes of paths that were no UTF-8 escaped."""
    write_bytes(path, text.encode(errors="backslashreplace"), sync=sync)


def _mask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
