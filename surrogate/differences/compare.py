"""Two results folders side by side."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from surrogate.differences.decisions import goals_part, screening_part, versions_part
from surrogate.differences.figures import coefficients_part, indices_part, surrogates_part
from surrogate.differences.folder import ResultsFolder, read
from surrogate.differences.part import Part
from surrogate.differences.runs import answers_part, counts_part
from surrogate.differences.words import study_part

PARTS: tuple[Callable[[ResultsFolder, ResultsFolder], Part], ...] = (
    study_part,
    versions_part,
    counts_part,
    answers_part,
    surrogates_part,
    coefficients_part,
    indices_part,
    screening_part,
    goals_part,
)


def compare(a: Path, b: Path) -> tuple[ResultsFolder, ResultsFolder, list[Part]]:
    """Both folders and what changed from A to B; parts about which nothing is known are empty.

    Raises `ResultsError` for a folder without results.
    """
    sides = read("A", a), read("B", b)
    return *sides, [_found(part, *sides) for part in PARTS]


def _found(part: Callable[[ResultsFolder, ResultsFolder], Part], *sides: ResultsFolder) -> Part:
    """A part, or a sentence that the files do not hold it as they should."""
    try:
        return part(*sides)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        name = part.__name__.removesuffix("_part").replace("_", " ")
        said = f"This cannot be compared: a file is not as it was written ({error!r})."
        return Part(part.__name__.removesuffix("_part"), name.capitalize(), (said,))
