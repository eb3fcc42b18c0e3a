"""A claim on a folder where files cannot be locked: a file that only one process can make.

It names its maker. A claim of a process of this machine that has ended is taken over; whether
one of another machine still lives cannot be known, so that its file has to be deleted by hand.
"""

from __future__ import annotations

import os
import re
import socket
import time
from contextlib import suppress
from pathlib import Path

from surrogate.errors import ResultsError


def who() -> str:
    """This process, in words."""
    return (
        f"process {os.getpid()} on {socket.gethostname()}, "
        f"since {time.strftime('%Y-%m-%d %H:%M:%S')}"
    )


def take(path: Path) -> None:
    """Claim the folder of the lock file `path`; raises `ResultsError` when it is claimed."""
    claim = _claim(path)
    while True:
        try:
            file = os.open(claim, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        except FileExistsError:
            holder = _text(claim)
            if not _ended(holder):
                raise ResultsError(
                    f"{path.parent} is in use by {holder or 'another process'}; wait for it, or "
                    f"stop it, then run again. If it has ended, delete {claim}"
                ) from None
            _remove(claim, holder)
            continue
        os.write(file, who().encode())
        os.close(file)
        return


def _remove(claim: Path, holder: str) -> None:
    """Remove the claim of a holder that has ended; not that of another who was faster."""
    aside = claim.with_name(f"{claim.name}.{os.getpid()}")
    with suppress(FileNotFoundError):
        os.rename(claim, aside)
        if _text(aside) != holder:
            os.rename(aside, claim)
        else:
            os.unlink(aside)


def give_up(path: Path) -> None:
    """Take back this process's claim."""
    with suppress(OSError):
        os.unlink(_claim(path))


def _claim(path: Path) -> Path:
    return path.with_name(f"{path.name}.claimed")


def _text(claim: Path) -> str:
    with suppress(OSError, ValueError):
        return claim.read_text(encoding="utf-8").strip()
    return ""


def _ended(holder: str) -> bool:
    """True when the holder was a process of this machine that is there no more."""
    found = re.match(r"process (\d+) on (.*), since ", holder)
    if found is None or found[2] != socket.gethostname():
        return False
    if int(found[1]) == os.getpid():  # of an earlier process with our number
        return True
    if os.name == "nt":  # os.kill would end it
        return False
    try:
        os.kill(int(found[1]), 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False
    return False
