"""What changed in the study file: keys and values, however they are written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from surrogate.differences.folder import ResultsFolder
from surrogate.differences.part import SIDES, Part, side_by_side
from surrogate.study.file import read

COLUMNS = {"key": "key", "change": "change", **SIDES}
#: Longest value that is printed; the JSON data has it whole.
LONGEST = 60


def study_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Keys whose values differ; `tension: [1, 2]` and `tension: {range: [1, 2]}` do not."""
    title = "Study file"
    if a.words is None or b.words is None:
        return Part("study_file", title, ("One of the study files cannot be read.",))
    of_a, of_b = (dict(_flat(_meant(one.words))) for one in (a, b))
    rows = [
        {"key": key, "change": _change(key, of_a, of_b), **both}
        for key, both in side_by_side(of_a, of_b)
        if key not in of_a or key not in of_b or of_a[key] != of_b[key]
    ]
    if not rows:
        return Part("study_file", title, ("The study files say the same.",))
    said = f"{len(rows)} {'key differs' if len(rows) == 1 else 'keys differ'}."
    shown = [{**row, "a": _short(row["a"]), "b": _short(row["b"])} for row in rows]
    return Part("study_file", title, (said,), COLUMNS, rows, shown)


def _meant(words: Any) -> Any:
    """The data with defaults filled in and short forms written out, where it is sound."""
    part, mistakes, _ = read(words)
    return words if part is None or mistakes else part.model_dump()


def _flat(data: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, Any]]:
    """Each value that is no mapping, under its keys joined by points; empty ones are left out."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            yield from _flat(value, (*path, str(key)))
    elif data is not None and data not in ((), [], ""):
        yield ".".join(path), _plain(data)


def _plain(value: Any) -> Any:
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else value


def _change(key: str, of_a: Mapping[str, Any], of_b: Mapping[str, Any]) -> str:
    return "added" if key not in of_a else "removed" if key not in of_b else "changed"


def _short(value: Any) -> str | None:
    text = None if value is None else " ".join(str(value).split())
    return text if text is None or len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."
