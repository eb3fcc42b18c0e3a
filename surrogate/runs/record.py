"""One finished run as a line of the journal, with a checksum.

    {"crc": "9f03a1c2", "key": ..., "inputs": {...}, "status": "ok", ...}

The checksum (CRC-32) is that of the line's bytes behind it, so a changed bit makes
the record damaged and never another answer. Lines without one, which version 0.1.0
wrote, are read too when their types are right. Whatever else a line holds, it is damaged.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import prod
from typing import Any

from surrogate.solver import Output

#: How a run can end.
ENDED = ("ok", "failed", "timed_out")

_SUM = b'{"crc": "'
_BODY = len(_SUM) + 8 + len(b'", ')
_LARGEST = 1.7976931348623157e308
_LATEST = 9.2e9  # seconds since 1970 that a date of NumPy in nanoseconds can hold
_LONGEST_DIMENSION = 2**40


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
    lost      True when the machine ended it (no memory, a node that failed): no answer at all
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
    lost: bool = False

    def holds(self, wanted: Mapping[str, Output]) -> bool:
        """True for a good run in which these outputs were kept, in these shapes."""
        return self.status == "ok" and all(
            tuple(self.fields[name]["shape"]) == output.shape
            if name in self.fields
            else name in self.outputs and not output.dims
            for name, output in wanted.items()
        )

    def answers(self, wanted: Mapping[str, Output]) -> bool:
        """True when it `holds` the outputs, or says that the point has no answer."""
        return self.status != "ok" or self.holds(wanted)


def to_line(record: Record) -> bytes:
    """The record as a line, its checksum in front."""
    # JSON has no NaN: a gap is null, which becomes NaN again in the runs dataset.
    scalars = {name: None if value != value else value for name, value in record.outputs.items()}
    body = json.dumps({**vars(record), "outputs": scalars}, allow_nan=False).encode()[1:]
    return b'%b%08x", %b\n' % (_SUM, zlib.crc32(body), body)


def from_line(line: bytes) -> Record:
    """The record in a line; raises `ValueError` with a sentence part that says what is wrong."""
    line = line.rstrip(b"\r")
    summed = line.startswith(_SUM)
    body = line[_BODY:] if summed else line
    if summed and line[len(_SUM) : _BODY] != b'%08x", ' % zlib.crc32(body):
        raise ValueError("its checksum does not match")
    try:
        record = Record(**json.loads(("{" if summed else "") + body.decode()))
        right = summed or _well_typed(record)  # what passes its sum is as `to_line` wrote it
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError, MemoryError):
        right = False
    if not right:
        raise ValueError("it is no record of a run")
    return record


def _well_typed(record: Record) -> bool:
    """Whether a record read from JSON has the types that `Record` declares."""
    return (
        type(record.key) is type(record.message) is str
        and record.status in ENDED
        and _number(record.seconds)
        and type(record.attempts) is int
        and 0 <= record.attempts < 2**31
        and _number(record.finished)
        and abs(record.finished) < _LATEST
        and (record.limit is None or _number(record.limit))
        and type(record.solver) is dict
        and type(record.lost) is bool
        and all(type(value) is str or _number(value) for value in record.inputs.values())
        and all(value is None or _number(value) for value in record.outputs.values())
        and all(map(_place, record.fields.values()))
    )


def _number(value: Any) -> bool:
    return type(value) in (float, int) and -_LARGEST <= value <= _LARGEST


def _place(place: Any) -> bool:
    """Whether it says where an array lies."""
    return (
        type(place["shape"]) is list
        and len(place["shape"]) <= 32
        and all(type(n) is int and 0 <= n < _LONGEST_DIMENSION for n in place["shape"])
        and prod(place["shape"]) < 2**60
        and type(place["offset"]) is type(place["crc"]) is int
        and place["offset"] >= 0
    )
