"""Who does what in a folder that several workers share, by files and their names alone.

    journal/claims/<run>.<n>     made by O_EXCL, so by one worker only, whose name is in it;
                                 n + 1 takes over from a worker that is gone
    journal/workers/<worker>     a sign of life: a count that grows, or "ended" and the length
                                 of the worker's segment

No clocks are compared: a worker is gone when its sign has not changed for a lease, by the
clock of whoever watches it, or when it says that it has ended and all of its records are to
be seen. Folders on a network show changes late and in any order; that may delay a run, and a
claim is still made once, because the server decides on O_EXCL.
"""

from __future__ import annotations

import os
import tempfile
import threading
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from surrogate.errors import ResultsError
from surrogate.execution.clock import RunClock
from surrogate.runs.files import write_text
from surrogate.runs.journal import SEGMENTS, JournalContents, read
from surrogate.runs.writing import trouble

#: Seconds without a sign of life after which a worker's runs are done by others. Longer than
#: a network folder takes to show a change (60 s for NFS by default).
LEASE = 120.0

#: Signs of life in a lease.
SIGNS = 10

CLAIMS, WORKERS, ENDED = "claims", "workers", "ended"


@dataclass(frozen=True)
class SharedFolder:
    """All that workers read and write of each other, in the folder of a journal."""

    folder: Path

    def claim(self, run: str, generation: int, worker: str) -> bool:
        """True when this worker, and so no other, has the run from now on."""
        path = self._claim(run, generation)
        try:
            file = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666)
        except FileExistsError:
            return False
        except FileNotFoundError:
            path.parent.mkdir(parents=True, exist_ok=True)
            return self.claim(run, generation, worker)
        except OSError as error:
            raise trouble(self.folder, error) from error
        try:
            os.write(file, worker.encode())
        except OSError as error:
            raise trouble(self.folder, error) from error
        finally:
            os.close(file)
        return True

    def owner(self, run: str, generation: int) -> str | None:
        """Worker that made the claim, "" when it has not signed it yet; None without a claim."""
        try:
            return self._claim(run, generation).read_text()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise trouble(self.folder, error) from error

    def last_claim(self, run: str) -> tuple[int, str | None]:
        """Generation and worker of the last claim; -1 and None when nobody has claimed it."""
        generation, owner = -1, None
        while (later := self.owner(run, generation + 1)) is not None:
            generation, owner = generation + 1, later
        return generation, owner

    def show(self, worker: str, sign: str) -> None:
        """Give a sign of life."""
        write_text(self.folder / WORKERS / worker, sign)

    def sign(self, worker: str) -> str:
        """The last sign of life of a worker; "" when there is none."""
        with suppress(OSError):
            return (self.folder / WORKERS / worker).read_text()
        return ""

    def segment_length(self, worker: str) -> int:
        """Bytes of a worker's records that are to be seen."""
        with suppress(OSError):
            return (self.folder / SEGMENTS / f"{worker}.jsonl").stat().st_size
        return 0

    def segment_lengths(self) -> dict[str, int]:
        """Bytes of the records of each worker, by the name of their file."""
        return {path.name: path.stat().st_size for path in (self.folder / SEGMENTS).glob("*.jsonl")}

    def contents(self) -> JournalContents:
        """The journal with all segments."""
        return read(self.folder)

    def _claim(self, run: str, generation: int) -> Path:
        return self.folder / CLAIMS / run[:2] / f"{run}.{generation}"


@dataclass
class Watch:
    """Tells which workers are gone; to be asked, or `clock` to be read, every now and then."""

    shared: SharedFolder
    lease: float = LEASE
    clock: RunClock = field(default_factory=RunClock)
    _seen: dict[tuple[str, str], tuple[str, float]] = field(default_factory=dict)

    def is_gone(self, worker: str, claim: str) -> bool:
        """True when the worker does no more runs; claim: its claim, for one without a name."""
        sign = self.shared.sign(worker) if worker else ""
        word, _, length = sign.partition(" ")
        if word == ENDED and length.isdecimal():
            return self.shared.segment_length(worker) >= int(length)
        which, now = (worker, "" if worker else claim), self.clock.now()
        before, since = self._seen.setdefault(which, (sign, now))
        if before != sign:
            self._seen[which] = (sign, now)
            return False
        return now - since > self.lease


class Presence:
    """Signs of life of a worker that waits for others, from a thread of its own until `end`."""

    def __init__(self, shared: SharedFolder, worker: str, lease: float = LEASE):
        self.shared, self.worker = shared, worker
        self._over = threading.Event()
        words = (shared, worker, lease / SIGNS, self._over)
        shared.show(worker, "0")
        threading.Thread(target=_show_signs, args=words, daemon=True).start()

    def end(self) -> None:
        """Say that no more comes: others may do what this worker has not done."""
        self._over.set()
        self.shared.show(self.worker, f"{ENDED} 0")


def _show_signs(shared: SharedFolder, worker: str, pause: float, over: threading.Event) -> None:
    count = 0
    while not over.wait(pause):
        count += 1
        with suppress(ResultsError):  # a full disk: the next sign may find room
            shared.show(worker, str(count))


def at_work(folder: Path, lease: float = LEASE) -> list[str]:
    """Workers with a recent sign of life, by the clock of the disk that the folder is on."""
    signs = [path for path in (folder / WORKERS).glob("*") if not path.name.startswith(".")]
    if not signs:
        return []
    with suppress(OSError), tempfile.TemporaryFile(dir=folder / WORKERS) as probe:
        probe.write(b".")
        probe.flush()
        now = os.fstat(probe.fileno()).st_mtime
        return sorted(
            path.name
            for path in signs
            if now - path.stat().st_mtime < lease and not path.read_text().startswith(ENDED)
        )
    return []
