"""A figure as data: its title, what it shows in words, its numbers, and the drawing of them.

The page shows the drawing, writes the numbers as a table behind it, and makes of both what can
be downloaded: SVG and PNG of the drawing, CSV of the table.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from surrogate.report import digits
from surrogate.report.drawing import group, tag

#: Significant digits of the spread of a column of numbers.
DIGITS = 5


@dataclass(frozen=True)
class Column:
    """Numbers or words of a figure, one a row; `name` has the unit."""

    name: str
    values: NDArray[np.generic]

    @property
    def numeric(self) -> bool:
        """True for numbers."""
        return bool(np.issubdtype(self.values.dtype, np.number))

    @property
    def empty(self) -> bool:
        """True when no number in it is known."""
        return self.numeric and bool(np.isnan(np.asarray(self.values, dtype=float)).all())

    def words(self) -> list[str]:
        """The values as printed, numbers with the same decimals throughout."""
        if not self.numeric or np.issubdtype(self.values.dtype, np.integer):
            return [str(value) for value in self.values]
        return digits.column(self.values, DIGITS)


def column(name: str, values: ArrayLike | Sequence[object]) -> Column:
    """A column of these values, (k,)."""
    found = np.asarray(values)
    return Column(name, found if np.issubdtype(found.dtype, np.number) else found.astype(str))


@dataclass(frozen=True)
class Plot:
    """A drawing of `width` times `height` units with what it says and the numbers in it.

    title    its name, on the page and of the files
    says     what it shows, for those who do not see it
    numbers  columns of one length
    """

    title: str
    says: str
    numbers: tuple[Column, ...]
    width: float
    height: float
    marks: Markup

    @property
    def rows(self) -> Iterable[tuple[str, ...]]:
        """The numbers as printed, row by row."""
        return zip(*(one.words() for one in self.numbers), strict=True)

    @property
    def file(self) -> str:
        """The title as the name of a file, without its ending."""
        return re.sub(r"\W+", "-", self.title).strip("-").lower()

    def svg(self, key: object) -> Markup:
        """The `<svg>`; `key` tells its ids from those of others on the page."""
        return tag(
            "svg",
            tag("title", self.title, id=f"plot-{key}-title"),
            tag("desc", self.says, id=f"plot-{key}-says"),
            group(self.marks, aria_hidden="true"),
            viewBox=f"0 0 {self.width:.0f} {self.height:.0f}",
            role="img",
            aria_labelledby=f"plot-{key}-title",
            aria_describedby=f"plot-{key}-says",
            style=f"max-width:{self.width * 1.15:.0f}px",
        )


def plot(
    width: float,
    height: float,
    *children: object,
    title: str,
    says: str,
    numbers: Iterable[Column],
) -> Plot:
    """A figure of these marks; of its columns of numbers those that have any."""
    known = tuple(one for one in numbers if not one.empty)
    return Plot(title, says, known, width, height, group(*children))
