"""What Ctrl-C and SIGTERM mean while runs go on."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType


@dataclass
class Stop:
    """What is asked for.

    finish  start no more runs, wait for those under way
    now     give those under way up as well
    """

    finish: bool = False
    now: bool = False


@contextmanager
def stop_on_signals() -> Iterator[Stop]:
    """A first Ctrl-C finishes the runs under way, a second one or SIGTERM stops at once.

    One more interrupts whatever goes on. Only the main thread can listen to signals; in
    others nothing is ever asked for.
    """
    stop = Stop()

    def handle(number: int, frame: FrameType | None) -> None:
        if stop.now:
            raise KeyboardInterrupt
        stop.now = stop.finish or number != signal.SIGINT
        stop.finish = True

    if threading.current_thread() is not threading.main_thread():
        yield stop
        return
    before = {number: signal.signal(number, handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
