"""The journal: one record per finished run, appended; the truth while runs go on.

    journal/runs.jsonl   a line of JSON per finished run
    journal/fields.bin   little-endian doubles of array outputs, end to end
    journal/lock         who writes now

A run's arrays are written before its line, and its line counts only when it is
complete and the arrays pass their checksum. So the process may be killed at any
moment: what is torn is cut off at the next start and that run is done again.
Both files reach the disk itself at most `SYNC_SECONDS` after a record.
"""

from __future__ import annotations

import json
import mmap
import os
import time
import zlib
from collections.abc import Mapping
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from surrogate.errors import ResultsError
from surrogate.runs.lock import release_lock, take_lock

SYNC_SECONDS = 0.5
RECORDS, FIELDS, LOCK = "runs.jsonl", "fields.bin", "lock"


@dataclass(frozen=True)
class Record:
    """One finished run.

    key       identity (surrogate.runs.identity.keys)
    inputs    what the solver was called with
    status    ok, failed or timed_out; `message` says why
    seconds   duration of the last attempt; `limit` the time it was allowed, None for any
    finished  seconds since 1970 (UTC)
    outputs   scalar outputs by name
    fields    array outputs by name: {"offset": bytes, "shape": [...], "crc": checksum}
    solver    {"solver": name, "version": ..., "options": ...}
    """

    key: str
    inputs: Mapping[str, float | str]
    status: str
    message: str
    seconds: float
    attempts: int
    finished: float
    limit: float | None = None
    outputs: Mapping[str, float] = field(default_factory=dict)
    fields: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    solver: Mapping[str, Any] = field(default_factory=dict)

    def holds(self, names) -> bool:
        """True for a good run in which all outputs called `names` were kept."""
        return self.status == "ok" and all(n in self.outputs or n in self.fields for n in names)

    def answers(self, names) -> bool:
        """True when it `holds` the outputs, or says that the point has no answer."""
        return self.status != "ok" or self.holds(names)


@dataclass(frozen=True)
class JournalContents:
    """What a journal held when it was read: records by key, and bytes that count."""

    records: dict[str, Record]
    folder: Path
    length: int = 0
    dropped: int = 0

    def values(self, record: Record, name: str) -> float | np.ndarray:
        """Output `name` of a record: a float, or an array of doubles read from the disk."""
        if name in record.outputs:
            return record.outputs[name]
        place = record.fields[name]
        count = int(np.prod(place["shape"], dtype=int))
        data = np.fromfile(self.folder / FIELDS, dtype="<f8", count=count, offset=place["offset"])
        return data.reshape(place["shape"])


def read(folder: str | Path) -> JournalContents:
    """All whole records of the journal in `folder`; the last one of a key counts.

    Changes nothing, so it is safe while another process writes. A journal that does not
    exist is empty. Damaged lines are left out and counted in `dropped`. Raises
    `ResultsError` when it is there and cannot be read.
    """
    folder = Path(folder)
    try:
        data = (folder / RECORDS).read_bytes()
    except FileNotFoundError:
        return JournalContents({}, folder)
    except OSError as error:
        raise ResultsError(
            f"{folder / RECORDS} cannot be read: {error.strerror or error}; it is "
            "where finished runs are kept"
        ) from error
    length = data.rfind(b"\n") + 1
    records, dropped = {}, int(length < len(data))
    with _Fields(folder / FIELDS) as fields:
        for line in data[:length].splitlines():
            record = _parse(line)
            if record is None or not all(map(fields.whole, record.fields.values())):
                dropped += 1
            else:
                records[record.key] = record
    return JournalContents(records, folder, length, dropped)


def _parse(line: bytes) -> Record | None:
    try:
        return Record(**json.loads(line))
    except (ValueError, TypeError):
        return None


class _Fields:
    """The file of arrays, mapped for checking."""

    def __init__(self, path: Path):
        self.data: Any = b""
        with suppress(FileNotFoundError, ValueError), open(path, "rb") as file:
            self.data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)

    def __enter__(self) -> _Fields:
        return self

    def __exit__(self, *error) -> None:
        if self.data:
            self.data.close()

    def whole(self, place: Mapping[str, Any]) -> bool:
        """True when the array is there to its last byte and unchanged."""
        end = place["offset"] + 8 * int(np.prod(place["shape"], dtype=int))
        if end > len(self.data):
            return False
        with memoryview(self.data) as view, view[place["offset"] : end] as part:
            return zlib.crc32(part) == place["crc"]


class Journal:
    """A journal open for writing; use as `with Journal(folder) as journal`.

    Entering takes the lock, cuts off a torn end and reads what is there into
    `contents`. Raises `ResultsError` when another process writes to it.
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
            self._lock = take_lock(self.folder / LOCK)
        except OSError as error:
            raise _trouble(self.folder, error) from error
        try:
            self.contents = read(self.folder)
            self._records = _Appending(self.folder / RECORDS, cut=self.contents.length)
            self._fields = _Appending(self.folder / FIELDS)
        except BaseException as error:
            release_lock(self.folder / LOCK, self._lock)
            if isinstance(error, OSError):
                raise _trouble(self.folder, error) from error
            raise
        return self

    def __exit__(self, *error) -> None:
        try:
            with suppress(ResultsError) if error[0] else nullcontext():
                self._sync()
        finally:
            self._records.close()
            self._fields.close()
            release_lock(self.folder / LOCK, self._lock)

    def append(self, record: Record, fields: Mapping[str, np.ndarray] | None = None) -> None:
        """Add a finished run, its arrays first; places that the record states stay valid.

        Raises `ResultsError` when the disk takes no more; what was there before stays whole.
        """
        try:
            places = {name: self._write_field(array) for name, array in (fields or {}).items()}
            # JSON has no NaN: a gap is null, which becomes NaN again in the runs dataset.
            scalars = {
                name: None if value != value else value for name, value in record.outputs.items()
            }
            whole = {**vars(record), "outputs": scalars, "fields": {**record.fields, **places}}
            self._records.write(json.dumps(whole, allow_nan=False).encode() + b"\n")
        except OSError as error:
            raise _trouble(self.folder, error) from error
        self.records[record.key] = Record(**whole)
        if self._unsynced_since is None:
            self._unsynced_since = time.monotonic()
        self.sync()

    def adopt(self, record: Record, other: JournalContents) -> None:
        """Add a run that another journal holds, with its arrays."""
        fields = {name: other.values(record, name) for name in record.fields}
        self.append(replace(record, fields={}), fields)

    def _write_field(self, array: np.ndarray) -> dict[str, Any]:
        data = np.asarray(array, dtype="<f8").tobytes()
        offset = self._fields.write(data)
        return {"offset": offset, "shape": list(np.shape(array)), "crc": zlib.crc32(data)}

    def sync(self) -> None:
        """Force what was appended onto the disk, when some of it waits too long."""
        since = self._unsynced_since
        if since is not None and time.monotonic() - since >= SYNC_SECONDS:
            self._sync()

    def _sync(self) -> None:
        try:
            self._fields.sync()
            self._records.sync()
        except OSError as error:
            raise _trouble(self.folder, error) from error
        self._unsynced_since = None


class _Appending:
    """A file that only grows, by whole pieces: a piece that does not fit is taken back."""

    def __init__(self, path: Path, cut: int | None = None):
        binary = getattr(os, "O_BINARY", 0)
        self.file = os.open(path, os.O_WRONLY | os.O_CREAT | binary, 0o666)
        if cut is not None and cut < os.fstat(self.file).st_size:
            os.ftruncate(self.file, cut)
        self.end = os.lseek(self.file, 0, os.SEEK_END)
        self.clean = True

    def write(self, data: bytes) -> int:
        """Offset at which `data` now stands."""
        start, view = self.end, memoryview(data)
        try:
            while view:
                view = view[os.write(self.file, view) :]
        except OSError:
            os.ftruncate(self.file, start)
            os.lseek(self.file, start, os.SEEK_SET)
            raise
        self.end, self.clean = start + len(data), False
        return start

    def sync(self) -> None:
        if not self.clean:
            os.fsync(self.file)
            self.clean = True

    def close(self) -> None:
        os.close(self.file)


def _trouble(folder: Path, error: OSError) -> ResultsError:
    return ResultsError(
        f"cannot write to {folder}: {error.strerror or error}; the runs finished "
        "so far are kept. Make room or choose another folder, then run again"
    )
