"""A segment of the journal: the runs of one of several workers that share its folder.

    journal/segments/<worker>.jsonl    records, as in the journal
    journal/segments/<worker>.bin      their arrays

Nobody else writes to it, so it needs no lock, which network folders are bad at.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from surrogate.runs.journal import SEGMENTS, JournalContents
from surrogate.runs.record import Record
from surrogate.runs.writing import RunsWriter, trouble


class Segment:
    """The segment of `worker`, whose name no other has; its files are made when it has a run."""

    def __init__(self, folder: Path, worker: str):
        self.folder, self.worker = folder, worker
        self._writer: RunsWriter | None = None

    def __enter__(self) -> Segment:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._writer is not None:
            self._writer.close(quietly=error is not None)

    def append(self, record: Record, fields: Mapping[str, NDArray[np.float64]]) -> Record:
        """Add a finished run with its arrays; `ResultsError` when the disk takes no more."""
        writer = self._writer = self._writer or self._opened()
        record = writer.append(record, fields)
        writer.sync()
        return record

    def adopt(self, record: Record, other: JournalContents) -> Record:
        """Add a run that another journal holds, with its arrays."""
        fields = {name: np.asarray(other.values(record, name)) for name in record.fields}
        return self.append(Record(**{**vars(record), "fields": {}}), fields)

    def sync(self) -> None:
        """See that the files are still there; force old appends onto the disk."""
        if self._writer is not None:
            self._writer.sync()

    @property
    def length(self) -> int:
        """Bytes of the file of records."""
        return self._writer.length if self._writer is not None else 0

    def _opened(self) -> RunsWriter:
        names = (f"{SEGMENTS}/{self.worker}.jsonl", f"{SEGMENTS}/{self.worker}.bin")
        try:
            (self.folder / SEGMENTS).mkdir(parents=True, exist_ok=True)
            return RunsWriter(self.folder, *names, named=True)
        except OSError as error:
            raise trouble(self.folder, error) from error
