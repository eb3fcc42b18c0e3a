"""The journal: one record per finished run, appended; the truth while runs go on.

    journal/runs.jsonl     a line of JSON per finished run (surrogate.runs.record)
    journal/fields.bin     little-endian doubles of array outputs, end to end
    journal/lock           who writes now
    journal/damaged.jsonl  lines that were damaged, set aside when runs went on
    journal/segments/      the same two files for each of the workers that share the folder

The segments of workers (surrogate.runs.segment) are read with the rest. Of a run that stands in
several files the later record counts, and one with an answer before one without.

A run's arrays are written before its line, and its line counts only when it is
complete, passes its checksum and the arrays pass theirs. So the process may be killed
at any moment: what is torn is cut off at the next start and that run is done again.
Both files reach the disk itself at most half a second after a record.
"""

from __future__ import annotations

import gc
import hashlib
import json
import mmap
import os
import re
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from itertools import accumulate
from math import prod
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import ResultsError
from surrogate.runs.lock import Lock
from surrogate.runs.record import Record, from_line
from surrogate.runs.writing import RunsWriter, trouble

RECORDS, FIELDS, LOCK, DAMAGED = "runs.jsonl", "fields.bin", "lock", "damaged.jsonl"
SEGMENTS = "segments"
_FIELDS_OF_SEGMENT = re.compile(rf"{SEGMENTS}/[\w-]+\.bin")


@dataclass(frozen=True)
class JournalContents:
    """What a journal held when it was read.

    records  by key
    length   bytes of the file of records that count
    damaged  what is wrong with a line that is whole and no record: number (from 1) -> reason
    damaged_segments  a sentence for each such line of a segment
    digests  of what counts of each file of records, by its path in the folder
    """

    records: dict[str, Record]
    folder: Path
    length: int = 0
    damaged: Mapping[int, str] = field(default_factory=dict)
    damaged_segments: tuple[str, ...] = ()
    digests: Mapping[str, str] = field(default_factory=dict)

    def values(self, record: Record, name: str) -> float | NDArray[np.float64]:
        """Output `name` of a record: a float, or an array of doubles read from the disk."""
        if name in record.outputs:
            return record.outputs[name]
        place = record.fields[name]
        path = self.folder / place.get("file", FIELDS)
        data = np.fromfile(path, dtype="<f8", count=prod(place["shape"]), offset=place["offset"])
        return data.reshape(place["shape"])

    @property
    def told(self) -> list[str]:
        """A sentence for each damaged line."""
        own = _told(self.folder / RECORDS, self.damaged)
        return [*own, *self.damaged_segments]

    @property
    def digest(self) -> str:
        """What tells these contents from all others, as `digest` gives it."""
        return _digest(self.digests)


def _told(path: Path, damaged: Mapping[int, str]) -> list[str]:
    return [
        f"{path}, line {number}: the record is damaged ({reason}); its run counts as not done"
        for number, reason in damaged.items()
    ]


def read(folder: str | Path) -> JournalContents:
    """All whole records of the journal in `folder`; the last one of a key counts.

    Changes nothing, so it is safe while another process writes. A journal that does not
    exist is empty. Damaged lines are left out and told. Raises `ResultsError` when it is
    there and cannot be read.
    """
    folder = Path(folder)
    contents = _read_file(folder / RECORDS, folder)
    told: list[str] = []
    digests = dict(contents.digests)
    for path in _segments(folder):
        segment = _read_file(path, folder)
        told += _told(path, segment.damaged)
        digests |= segment.digests
        for key, record in segment.records.items():
            if _counts(record, contents.records.get(key)):
                contents.records[key] = record
    return replace(contents, damaged_segments=tuple(told), digests=digests)


def digest(folder: str | Path) -> str:
    """`read(folder).digest`, at a fortieth of the time: the records are not looked at."""
    folder = Path(folder)
    found = {path: _whole_lines(path) for path in (folder / RECORDS, *_segments(folder))}
    return _digest({_name(path, folder): _sha256(d) for path, d in found.items() if d is not None})


def _segments(folder: Path) -> list[Path]:
    return sorted((folder / SEGMENTS).glob("*.jsonl"))


def _name(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix()


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _digest(digests: Mapping[str, str]) -> str:
    return _sha256(json.dumps(digests, sort_keys=True).encode())[:32]


def _counts(record: Record, other: Record | None) -> bool:
    """Whether a record goes before another one of the same run, from another file."""
    if other is None:
        return True
    if (record.status == "ok") != (other.status == "ok"):
        return record.status == "ok"
    return record.finished > other.finished


def _whole_lines(path: Path) -> bytes | None:
    """What counts of a file of records: all but a torn last line; None without the file."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise ResultsError(
            f"{path} cannot be read: {getattr(error, 'strerror', None) or error}; "
            "it is where finished runs are kept"
        ) from error
    return data[: data.rfind(b"\n") + 1]


def _read_file(path: Path, folder: Path) -> JournalContents:
    """The records of one file."""
    data = _whole_lines(path)
    if data is None:
        return JournalContents({}, folder)
    records: dict[str, Record] = {}
    damaged: dict[int, str] = {}
    with _without_collections(), _Fields(folder) as fields:
        for number, line in enumerate(data.split(b"\n"), start=1):
            if line and not line.isspace():  # blank: was damaged and is set aside
                try:
                    record = from_line(line)
                    fields.check(record)
                except ValueError as error:
                    damaged[number] = str(error)
                else:
                    records[record.key] = record
    digests = {_name(path, folder): _sha256(data)}
    return JournalContents(records, folder, len(data), damaged, digests=digests)


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
    """The files of arrays, mapped for checking."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.data: dict[str, mmap.mmap | bytes] = {}

    def __enter__(self) -> _Fields:
        return self

    def __exit__(self, *error: object) -> None:
        for data in self.data.values():
            if isinstance(data, mmap.mmap):
                data.close()

    def _mapped(self, name: str) -> mmap.mmap | bytes:
        if name not in self.data:
            self.data[name] = b""
            with suppress(OSError, ValueError), open(self.folder / name, "rb") as file:
                self.data[name] = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        return self.data[name]

    def check(self, record: Record) -> None:
        """Raise `ValueError` when an array is not there to its last byte, or changed."""
        for name, place in record.fields.items():
            file = place.get("file", FIELDS)
            if file != FIELDS and not _FIELDS_OF_SEGMENT.fullmatch(file):
                raise ValueError(f"its array '{name}' is in no file of the journal")
            data = self._mapped(file)
            end = place["offset"] + 8 * prod(place["shape"])
            if end > len(data):
                raise ValueError(f"its array '{name}' is cut off")
            with memoryview(data) as view, view[place["offset"] : end] as part:
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

    @property
    def records(self) -> dict[str, Record]:
        """Records by key, those appended since included."""
        return self.contents.records

    @property
    def now(self) -> JournalContents:
        """What it holds now, as `read` would give it."""
        data = _whole_lines(self.folder / RECORDS) or b""
        return replace(
            self.contents,
            length=len(data),
            damaged={},
            digests={**self.contents.digests, RECORDS: _sha256(data)},
        )

    def __enter__(self) -> Journal:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._lock = Lock(self.folder / LOCK)
        except (OSError, ValueError) as error:
            raise trouble(self.folder, error) from error
        try:
            self.contents = read(self.folder)
            _set_aside(self.contents)
            self._writer = RunsWriter(self.folder, RECORDS, FIELDS, cut=self.contents.length)
        except BaseException as error:
            self._lock.release()
            if isinstance(error, OSError):
                raise trouble(self.folder, error) from error
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self._writer.close(quietly=error is not None)
        finally:
            self._lock.release()

    def append(
        self, record: Record, fields: Mapping[str, NDArray[np.float64]] | None = None
    ) -> None:
        """Add a finished run, its arrays first; places that the record states stay valid.

        Raises `ResultsError` when the disk takes no more, or the journal was deleted or is
        written by another process; what was there before stays whole.
        """
        self.records[record.key] = self._writer.append(record, fields or {})
        self.sync()

    def adopt(self, record: Record, other: JournalContents) -> None:
        """Add a run that another journal holds, with its arrays."""
        fields = {name: np.asarray(other.values(record, name)) for name in record.fields}
        self.append(replace(record, fields={}), fields)

    def sync(self, now: bool = False) -> None:
        """See that journal and lock are still there; force old appends, or all, onto the disk."""
        self._writer.sync(now)
        try:
            self._lock.check()
        except OSError as error:
            raise trouble(self.folder, error) from error


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
