"""How far a long computation is, told from within to whoever listens.

::

    for fold in counted("fold", folds): ...

tells "fold 3 of 10" as each begins; loops inside add their own part, "fold 3 of 10, mode 2 of 7".
Where nobody listens a loop costs nothing, and a listener is told `PAUSE` apart at least.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

Item = TypeVar("Item")

#: Seconds between two tellings, at least.
PAUSE = 0.2


@dataclass(frozen=True)
class Reached:
    """Where a computation is.

    text   of each loop where it is; may be empty
    share  of the whole that is done, from 0 to 1
    """

    text: str
    share: float


@dataclass
class _Loop:
    total: int
    begun: int = 0
    text: str = ""


@dataclass
class _Listener:
    hear: Callable[[Reached], None]
    told: float
    loops: list[_Loop] = field(default_factory=list)

    def tell(self) -> None:
        now = time.monotonic()
        if now - self.told < PAUSE:
            return
        self.told = now
        sizes = [1, *(max(loop.total, 1) for loop in self.loops)]
        share = sum(
            (loop.begun - 1) / math.prod(sizes[: depth + 2])
            for depth, loop in enumerate(self.loops)
        )
        self.hear(Reached(", ".join(loop.text for loop in self.loops if loop.text), share))


_listener: ContextVar[_Listener | None] = ContextVar("listener", default=None)


@contextmanager
def listening(hear: Callable[[Reached], None]) -> Iterator[None]:
    """Tells `hear` of the loops that run in the block."""
    before = _listener.set(_Listener(hear, time.monotonic()))
    try:
        yield
    finally:
        _listener.reset(before)


@contextmanager
def counting(total: int) -> Iterator[Callable[[str], None]]:
    """Of a computation in `total` parts of about the same size: `begin(text)` as each begins."""
    listener = _listener.get()
    if listener is None:
        yield lambda text: None
        return
    loops = listener.loops
    depth, loop = len(loops), _Loop(total)

    def begin(text: str) -> None:
        del loops[depth:]  # of loops inside that an error ended
        loops.append(loop)
        loop.begun, loop.text = loop.begun + 1, text
        listener.tell()

    try:
        yield begin
    finally:
        del loops[depth:]


def counted(name: str, items: Sequence[Item]) -> Iterator[Item]:
    """The items; tells "name k of n" as each is begun, where there are several."""
    with counting(len(items)) as begin:
        for k, item in enumerate(items, start=1):
            begin(f"{name} {k} of {len(items)}" if len(items) > 1 else "")
            yield item
