"""A design: named coded points and how they came about."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from surrogate.card import Card, Carded

Method = TypeVar("Method", bound=Callable[..., NDArray[np.float64]])


@dataclass(frozen=True, repr=False)
class Design(Carded):
    """Where to run the solver.

    name      as in the study: train, test, ...
    method    what makes it
    options   of that method, its seed included
    rows      number of points, augmentations included; of a search with augmentations that
              leave out what is there already, at most
    find      gives the points; a search may take a while
    added     (augmentation, number of rows) in the order of the rows at the end
    searched  True when `find` is a search: its points are kept, and found only for a run
    spread    of a search: its points all differ and fill the ranges, so that there is nothing
              to judge before a run but their number
    identity  equal for designs of equal method, options, augmentations and space
    replicates  how often each point stands in the rows
    chosen    number of rows at the end that followed from answers (adaptive designs)
    chosen_levels  of fidelity of these rows; () where they are all of the last level
    """

    name: str
    method: str
    options: Mapping[str, Any]
    rows: int
    find: Callable[[], NDArray[np.float64]]
    added: tuple[tuple[str, int], ...] = field(default=())
    searched: bool = False
    spread: bool = False
    identity: str = ""
    replicates: int = 1
    chosen: int = 0
    chosen_levels: tuple[str, ...] = ()

    @property
    def _card(self) -> Card:
        facts = {
            "method": self.method,
            "runs": self.runs,
            "options": ", ".join(f"{word}={value}" for word, value in self.options.items()),
            "added": ", ".join(f"{count} by {name}" for name, count in self.added),
            "chosen": str(self.chosen) * bool(self.chosen),
            "points": "" if self.at_hand else "not searched for yet",
        }
        return Card("Design", self.name, facts)

    @cached_property
    def coded(self) -> NDArray[np.float64]:
        """Points, shape (run, parameter), augmentations included."""
        return self.find()

    @property
    def at_hand(self) -> bool:
        """Whether the points are there without a search."""
        return not self.searched or "coded" in self.__dict__

    def with_points(self, coded: NDArray[np.float64]) -> Design:
        """The same design with points that were found before."""
        design = replace(self, rows=len(coded))
        design.__dict__["coded"] = coded
        return design

    @property
    def initial(self) -> NDArray[np.float64]:
        """The points (run, parameter) that followed from no answer."""
        return self.coded[: len(self.coded) - self.chosen]

    def with_chosen(self, coded: NDArray[np.float64], levels: tuple[str, ...] = ()) -> Design:
        """The same initial points, and these, of these levels of fidelity, behind them."""
        found = replace(self, chosen=len(coded), chosen_levels=levels)
        return found.with_points(np.vstack([self.initial, coded]))

    @property
    def levels(self) -> list[str]:
        """Level of fidelity of each row, of a design that names levels in `runs`; [] of others.

        What was added to it is of its last level.
        """
        counts = self.options.get("runs")
        if not isinstance(counts, Mapping):
            return []
        named = [name for name, count in counts.items() for _ in range(count)]
        named += self.chosen_levels
        return (named + [list(counts)[-1]] * max(self.runs - len(named), 0))[: self.runs]

    @property
    def truth(self) -> NDArray[np.float64]:
        """Points (run, parameter) of the last level of fidelity; all points of other designs."""
        levels = np.array(self.levels)
        return self.coded[levels == levels[-1]] if len(levels) else self.coded

    def repeated(self, times: int) -> Design:
        """The same design with each point `times` times, one after the other."""
        return replace(
            self,
            rows=self.rows * times,
            find=partial(_repeated, self.find, times),
            added=tuple((name, rows * times) for name, rows in self.added),
            identity=f"{self.identity}_{times}" if self.identity else "",
            replicates=self.replicates * times,
        )

    @property
    def runs(self) -> int:
        """Number of rows."""
        return len(self.coded) if self.at_hand else self.rows


def _repeated(find: Callable[[], NDArray[np.float64]], times: int) -> NDArray[np.float64]:
    return np.repeat(find(), times, axis=0)


def searching(rows: Callable[..., int], *, spread: bool = False) -> Callable[[Method], Method]:
    """Marks a design method that searches, so that a study searches once and only for a run.

    rows: takes the space and the options of the method, checks them (`DesignError`) and gives
    the number of points. spread: as in `Design`.
    """

    def mark(method: Method) -> Method:
        method.__dict__.update(rows=rows, spread=spread)
        return method

    return mark
