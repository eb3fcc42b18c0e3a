"""The journal: one record per finished run, appended; the truth while runs go on.

    journal/runs.jsonl     a line of JSON per finished run (surrogate.runs.record)
    journal/fields.bin     little-endian doubles of array outputs, end to end
    journal/lock           who writes now
    journal/damaged.jsonl  lines that were damaged, set aside when runs went on

A run's arrays are written before its line, and its line counts only when it is
complete, passes its checksum and the arrays pass theirs. So the process may be killed
at any moment: what is torn is cut off at the next start and that run is done again.
Both files reach the disk itself at most `SYNC_SECONDS` after a record.
"""

from __future__ import annotations

import gc
import mmap
import os
import time
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field, replace
from itertools import accumulate
from math import prod
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import ResultsError
from surrogate.runs.appending import AppendedFile
from surrogate.runs.lock import Lock
from surrogate.runs.record import Record, from_line, to_line

SYNC_SECONDS = 0.5
RECORDS, FIELDS, LOCK, DAMAGED = "runs.jsonl", "fields.bin", "lock", "damaged.jsonl"


@dataclass(frozen=True)
class JournalContents:
    """What a journal held when it was read.

    records  by key
    length   bytes of the file of records that count
    damaged  what is wrong with a line that is whole and no record: number (from 1) -> reason
    """

    records: dict[str, Record]
    folder: Path
    length: int = 0
    damaged: Mapping[int, str] = field(default_factory=dict)

    def values(self, record: Record, name: str) -> float | NDArray[np.float64]:
        """Output `name` of a record: a float, or an array of doubles read from the disk."""
        if name in record.outputs:
            return record.outputs[name]
        place = record.fields[name]
        data = np.fromfile(
            self.folder / FIELDS, dtype="<f8", count=prod(place["shape"]), offset=place["offset"]
        )
        return data.reshape(place["shape"])

    @property
    def told(self) -> list[str]:
        """A sentence for each damaged line."""
        return [
            f"{self.folder / RECORDS}, line {number}: the record is damaged ({reason}); "
            "its run counts as not done"
            for number, reason in self.damaged.items()
        ]


def read(folder: str | Path) -> JournalContents:
    """All whole records of the journal in `folder`; the last one of a key counts.

    Changes nothing, so it is safe while another process writes. A journal that does not
    exist is empty. Damaged lines are left out and told. Raises `ResultsError` when it is
    there and cannot be read.
    """
    folder = Path(folder)
    try:
        data = (folder / RECORDS).read_bytes()
    except FileNotFoundError:
        return JournalContents({}, folder)
    except (OSError, ValueError) as error:
        raise ResultsError(
            f"{folder / RECORDS} cannot be read: {getattr(error, 'strerror', None) or error}; "
            "it is where finished runs are kept"
        ) from error
    length = data.rfind(b"\n") + 1
    records: dict[str, Record] = {}
    damaged: dict[int, str] = {}
    with _without_collections(), _Fields(folder / FIELDS) as fields:
        for number, line in enumerate(data[:length].split(b"\n"), start=1):
            if line and not line.isspace():  # blank: was damaged and is set aside
                try:
                    record = from_line(line)
                    fields.check(record)
                except ValueError as error:
                    damaged[number] = str(error)
                else:
                    records[record.key] = record
    return JournalContents(records, folder, length, damaged)


@contextmanager
def _without_collections() -> Iterator[None]:
    """Records make no cycles; looking for some doubles the time of reading 100 000 of them."""
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


class _Fields:
    """The file of arrays, mapped for checking."""

    def __init__(self, path: Path):
        self.data: mmap.mmap | bytes = b""
        with suppress(OSError, ValueError), open(path, "rb") as file:
            self.data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)

    def __enter__(self) -> _Fields:
        return self

    def __exit__(self, *error: object) -> None:
        if isinstance(self.data, mmap.mmap):
            self.data.close()

    def check(self, record: Record) -> None:
        """Raise `ValueError` when an array is not there to its last byte, or changed."""
        for name, place in record.fields.items():
            end = place["offset"] + 8 * prod(place["shape"])
            if end > len(self.data):
                raise ValueError(f"its array '{name}' is cut off")
            with memoryview(self.data) as view, view[place["offset"] : end] as part:
                if zlib.crc32(part) != place["crc"]:
                    raise ValueError(f"the checksum of its array '{name}' does not match")


class Journal:
    """A journal open for writing; use as `with Journal(folder) as journal`.

    Entering takes the lock, reads what is there into `contents`, cuts off a torn end and
    sets damaged lines aside. Raises `ResultsError` when another process writes to it.
    """

    def __init__(self, folder: str | Path):
        self.folder = Path(folder)
        self.contents = JournalContents({}, self.folder)
        self._unsynced_since: float | None = None

    @property
    def records(self) -> dict[str, Record]:
        """Records by key, those appended since included."""
        return self.contents.records

    def __enter__(self) -> Journal:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._lock = Lock(self.folder / LOCK)
        except (OSError, ValueError) as error:
            raise _trouble(self.folder, error) from error
        try:
            self.contents = read(self.folder)
            _set_aside(self.contents)
            self._records = AppendedFile(self.folder / RECORDS, cut=self.contents.length)
            self._fields = AppendedFile(self.folder / FIELDS)
        except BaseException as error:
            self._lock.release()
            if isinstance(error, OSError):
                raise _trouble(self.folder, error) from error
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            with suppress(ResultsError) if error else nullcontext():
                self.flush()
        finally:
            self._records.close()
            self._fields.close()
            self._lock.release()

    def append(
        self, record: Record, fields: Mapping[str, NDArray[np.float64]] | None = None
    ) -> None:
        """Add a finished run, its arrays first; places that the record states stay valid.

        Raises `ResultsError` when the disk takes no more, or the journal was deleted or is
        written by another process; what was there before stays whole.
        """
        try:
            places = {name: self._write_field(array) for name, array in (fields or {}).items()}
            record = replace(record, fields={**record.fields, **places})
            self._records.write(to_line(record))
        except OSError as error:
            raise _trouble(self.folder, error) from error
        self.records[record.key] = record
        if self._unsynced_since is None:
            self._unsynced_since = time.monotonic()
        self.sync()

    def adopt(self, record: Record, other: JournalContents) -> None:
        """Add a run that another journal holds, with its arrays."""
        fields = {name: np.asarray(other.values(record, name)) for name in record.fields}
        self.append(replace(record, fields={}), fields)

    def _write_field(self, array: NDArray[np.float64]) -> dict[str, Any]:
        data = np.asarray(array, dtype="<f8").tobytes()
        offset = self._fields.write(data)
        return {"offset": offset, "shape": list(np.shape(array)), "crc": zlib.crc32(data)}

    def sync(self) -> None:
        """See that journal and lock are still there; force old appends onto the disk."""
        try:
            self._records.check()
            self._fields.check()
            self._lock.check()
        except OSError as error:
            raise _trouble(self.folder, error) from error
        since = self._unsynced_since
        if since is not None and time.monotonic() - since >= SYNC_SECONDS:
            self.flush()

    def flush(self) -> None:
        """Force all appends onto the disk."""
        try:
            self._fields.sync()
            self._records.sync()
        except OSError as error:
            raise _trouble(self.folder, error) from error
        self._unsynced_since = None


def _set_aside(contents: JournalContents) -> None:
    """Copy damaged lines into a file of their own, then blank them: they are told once."""
    if not contents.damaged:
        return
    path = contents.folder / RECORDS
    lines = path.read_bytes()[: contents.length].split(b"\n")
    starts = [0, *accumulate(len(line) + 1 for line in lines)]
    with open(contents.folder / DAMAGED, "ab") as copy:
        copy.writelines(lines[number - 1] + b"\n" for number in contents.damaged)
        copy.flush()
        os.fsync(copy.fileno())
    with open(path, "r+b") as file:
        for number in contents.damaged:
            file.seek(starts[number - 1])
            file.write(b" " * len(lines[number - 1]))


def _trouble(folder: Path, error: OSError | ValueError) -> ResultsError:
    return ResultsError(
        f"cannot write to {folder}: {getattr(error, 'strerror', None) or error}; the runs "
        "finished so far are kept. Make room or choose another folder, then run again"
    )
