"""What an adaptive design has chosen, kept in the results folder: its only memory.

    points_00020.json    coded points that follow the first 20 rows, and their levels of fidelity
                         where there are some; none: there is none left
    review_00025.json    what was found when 25 runs had ended

Each file is made once and by one process. So a design goes on where it was after any end, and
several workers that share the folder choose every point once.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive.aim import Review
from surrogate.errors import ResultsError
from surrogate.runs.files import write_new
from surrogate.runs.identity import canonical

Array = NDArray[np.float64]

#: The numbers of a review that may be gaps.
NUMBERS = ("figure", "estimate", "spent", "step")
#: Files whose content stays in memory: a design looks at all of its own for each choice.
FILES = 10_000


@dataclass(frozen=True, eq=False)
class State:
    """What a design has chosen and found.

    points   coded (k, parameter), behind the initial ones
    reviews  in the order of their runs
    closed   no allowed point is left
    levels   of fidelity of the points; () for one level
    """

    points: Array
    reviews: tuple[Review, ...] = ()
    closed: bool = False
    levels: tuple[str, ...] = ()


@dataclass(frozen=True)
class Kept:
    """The files of one design; its folder is named after the identity of its rule."""

    folder: Path

    def read(self, initial: int, size: int) -> State:
        """All of it; initial: rows before the first choice, size: number of parameters."""
        parts, rows, closed = [np.empty((0, size))], initial, False
        levels: list[str] = []
        while not closed and (path := self._points(rows)).exists():
            parts.append(_coded(path, size))
            levels += map(str, _read(path).get("levels", ()))
            rows, closed = rows + len(parts[-1]), not len(parts[-1])
        return State(np.vstack(parts), tuple(self._reviews()), closed, tuple(levels))

    def write(self, initial: int, state: State) -> None:
        """Keep a state that comes from elsewhere; what is there already stays."""
        if len(state.points):
            self.add_points(initial, state.points, state.levels)
        if state.closed:
            self.add_points(initial + len(state.points), state.points[:0])
        for review in state.reviews:
            self.add_review(review)

    def add_points(self, rows: int, coded: Array, levels: Sequence[str] = ()) -> bool:
        """Keep points that follow so many rows; False when others have chosen there before."""
        told: dict[str, Any] = {"coded": coded.tolist()}
        return write_new(
            self._points(rows), canonical({**told, "levels": list(levels)} if levels else told)
        )

    def _reviews(self) -> list[Review]:
        """All reviews, in the order of their runs."""
        return [_review(path) for path in sorted(self.folder.glob("review_*.json"))]

    def add_review(self, review: Review) -> None:
        """Keep a review; one of as many runs that is there already stays."""
        write_new(self.folder / f"review_{review.runs:05d}.json", canonical(as_data(review)))

    def _points(self, rows: int) -> Path:
        return self.folder / f"points_{rows:05d}.json"


def _coded(path: Path, size: int) -> Array:
    coded = np.array(_read(path).get("coded"), dtype=float)
    if coded.shape == (0,):
        return np.empty((0, size))
    if coded.ndim != 2 or coded.shape[1] != size or not np.isfinite(coded).all():
        raise _damaged(path)
    return coded


def _review(path: Path) -> Review:
    try:
        return from_data(_read(path))
    except (KeyError, TypeError, ValueError, AttributeError):
        raise _damaged(path) from None


def as_data(review: Review) -> dict[str, Any]:
    """The review as JSON data; JSON has no NaN, a gap is null."""
    lengths = {name: list(logs) for name, logs in review.lengths.items()}
    numbers = {word: getattr(review, word) for word in NUMBERS}
    told = {word: one if math.isfinite(one) else None for word, one in numbers.items()}
    return {"runs": review.runs, **told, "lengths": lengths}


def from_data(found: Mapping[str, Any]) -> Review:
    """The review in JSON data."""
    told = {word: found.get(word) for word in NUMBERS}
    numbers = {word: math.nan if one is None else float(one) for word, one in told.items()}
    lengths = {name: tuple(map(float, logs)) for name, logs in found["lengths"].items()}
    return Review(int(found["runs"]), lengths=lengths, **numbers)


def _read(path: Path) -> Mapping[str, Any]:
    try:
        seen = path.stat()
        found = _parsed(path, seen.st_mtime_ns, seen.st_size)
    except (OSError, ValueError):
        raise _damaged(path) from None
    if not isinstance(found, dict):
        raise _damaged(path)
    return found


@lru_cache(maxsize=FILES)
def _parsed(path: Path, changed: int, size: int) -> Any:
    """The JSON data of a file that was changed last at this time: it is read once."""
    return json.loads(path.read_text(encoding="utf-8"))


def _damaged(path: Path) -> ResultsError:
    return ResultsError(
        f"{path} is damaged; restore it, or delete it with all later files beside it: the design "
        "then chooses again from there"
    )
