"""What has been understood of a study so far, and the mistakes found on the way."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from surrogate.errors import DesignError, PluginError, StudyError
from surrogate.study import file as studyfile
from surrogate.study.file import StudyPart
from surrogate.study.source import Source


@dataclass
class Reading:
    """What has been understood of a study so far, and the mistakes found on the way."""

    part: StudyPart
    folder: Path | None
    broken: set[studyfile.Path]
    mistakes: list[studyfile.Mistake] = field(default_factory=list)

    def wrong(self, sentence: str, *path: str | int, on_key: bool = False) -> None:
        """Note a mistake in the part of the study at `path`."""
        self.mistakes.append(studyfile.Mistake(path, sentence, on_key))

    @contextmanager
    def noting(self, *path: str | int, on_key: bool = False) -> Iterator[None]:
        """Turn errors of the block into mistakes at `path`."""
        try:
            yield
        except StudyError as error:
            for sentence in error.mistakes:
                self.wrong(sentence, *path, on_key=on_key)
        except (PluginError, DesignError) as error:
            self.wrong(str(error), *path, on_key=on_key)

    def options_wrong(self, mistakes: list[tuple[str, str]], *path: str | int) -> None:
        """Note what is wrong with a plug-in's options, which stand at `path`."""
        for option, sentence in mistakes:
            misnamed = not option or "is unknown" in sentence
            self.wrong(sentence, *path, *filter(None, [option]), on_key=misnamed)

    def is_broken(self, *path: str) -> bool:
        """True when the part at `path` was left out because of a mistake of shape."""
        return any(path[:n] in self.broken for n in range(1, len(path) + 1))


def sentences(source: Source, mistakes: list[studyfile.Mistake]) -> list[str]:
    """Every mistake as `file:line:column: sentence`, in the order of the file, each once."""
    ordered = sorted(mistakes, key=lambda m: source.locate(m.path, key=m.on_key))
    return list(dict.fromkeys(source.sentence(m.path, m.sentence, key=m.on_key) for m in ordered))
