"""What has been understood of a study so far, and the mistakes found on the way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from surrogate.errors import DesignError, KeyPath, Mistake, PluginError, StudyError
from surrogate.study.parts.study import StudyPart
from surrogate.study.source import Source


@dataclass
class Reading:
    """What has been understood of a study so far, and the mistakes found on the way.

    notes: what a reader should know of the study's data, a sentence each
    """

    part: StudyPart
    folder: Path | None
    broken: set[KeyPath]
    mistakes: list[Mistake] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def wrong(self, sentence: str, *path: str | int, on_key: bool = False) -> None:
        """Note a mistake in the part of the study at `path`."""
        self.mistakes.append(Mistake(path, sentence, on_key))

    @contextmanager
    def mistakes_at(self, *path: str | int, on_key: bool = False) -> Iterator[None]:
        """Turn errors of the block into mistakes at `path`, or below it where they say so."""
        try:
            yield
        except StudyError as error:
            self.add(error.placed, *path, on_key=on_key)
        except (PluginError, DesignError) as error:
            self.wrong(str(error), *path, on_key=on_key)

    def add(self, found: Iterable[Mistake], *path: str | int, on_key: bool = False) -> None:
        """Note mistakes whose own paths start at `path`."""
        for one in found:
            self.wrong(one.sentence, *path, *one.path, on_key=one.on_key or on_key)

    def is_broken(self, *path: str) -> bool:
        """True when the part at `path` was left out because of a mistake of shape."""
        return any(path[:n] in self.broken for n in range(1, len(path) + 1))


def sentences(source: Source, mistakes: list[Mistake]) -> list[str]:
    """Every mistake as `file:line:column: sentence`, in the order of the file, each once."""
    ordered = sorted(mistakes, key=lambda m: source.locate(m.path, key=m.on_key))
    return list(dict.fromkeys(source.sentence(m.path, m.sentence, key=m.on_key) for m in ordered))
