"""What came of a study, for those who print it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surrogate.stages.table import REPORT


@dataclass(frozen=True)
class Outcome:
    """What came of a study.

    folder   where everything lies
    summary  the content of summary.json
    trouble  a sentence when something failed, else ""
    fresh    False when all was up to date already
    """

    folder: Path
    summary: Mapping[str, Any]
    trouble: str
    fresh: bool = True

    @property
    def report(self) -> Path:
        """The report's path."""
        return self.folder / REPORT
