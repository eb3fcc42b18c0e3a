"""The two files in which finished runs are kept: records, and the arrays that they point to."""

from __future__ import annotations

import os
import time
import zlib
from collections.abc import Mapping
from contextlib import nullcontext, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import ResultsError
from surrogate.runs.appending import AppendedFile
from surrogate.runs.record import Record, to_line

#: Most seconds between a record and its way onto the disk itself.
SYNC_SECONDS = 0.5


class RunsWriter:
    """A file of records and one of arrays in `folder`, appended together.

    cut    bytes of the file of records that count, None for all
    named  the places of arrays say in which file they are; else it is the journal's own
    """

    def __init__(
        self, folder: Path, records: str, fields: str, cut: int | None = None, named: bool = False
    ):
        self.folder, self._named = folder, fields if named else ""
        self._records = AppendedFile(folder / records, cut=cut)
        self._fields = AppendedFile(folder / fields)
        self._unsynced_since: float | None = None

    def append(self, record: Record, fields: Mapping[str, NDArray[np.float64]]) -> Record:
        """Write a finished run, its arrays first; returns it with the places of its arrays.

        Raises `ResultsError` when the disk takes no more; what was there before stays whole.
        """
        try:
            places = {name: self._write_field(array) for name, array in fields.items()}
            record = replace(record, fields={**record.fields, **places})
            self._records.write(to_line(record))
        except OSError as error:
            raise trouble(self.folder, error) from error
        if self._unsynced_since is None:
            self._unsynced_since = time.monotonic()
        return record

    def _write_field(self, array: NDArray[np.float64]) -> dict[str, Any]:
        data = np.asarray(array, dtype="<f8").tobytes()
        offset = self._fields.write(data)
        place = {"offset": offset, "shape": list(np.shape(array)), "crc": zlib.crc32(data)}
        return {**place, "file": self._named} if self._named else place

    @property
    def length(self) -> int:
        """Bytes of the file of records."""
        return os.fstat(self._records.file).st_size

    def sync(self, now: bool = False) -> None:
        """See that the files are still there; force old appends, or all `now`, onto the disk."""
        try:
            self._records.check()
            self._fields.check()
            since = self._unsynced_since
            if since is not None and (now or time.monotonic() - since >= SYNC_SECONDS):
                self._fields.sync()
                self._records.sync()
                self._unsynced_since = None
        except OSError as error:
            raise trouble(self.folder, error) from error

    def close(self, quietly: bool = False) -> None:
        """Put everything onto the disk and close; quietly: another error is under way."""
        try:
            with suppress(ResultsError) if quietly else nullcontext():
                self.sync(now=True)
        finally:
            self._records.close()
            self._fields.close()


def trouble(folder: Path, error: OSError | ValueError) -> ResultsError:
    """The sentence for a folder that takes no more."""
    return ResultsError(
        f"cannot write to {folder}: {getattr(error, 'strerror', None) or error}; the runs "
        "finished so far are kept. Make room or choose another folder, then run again"
    )
