"""A limit for building a study's solver in this process."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from surrogate.errors import PluginError

#: Least limit, in seconds, where runs have one.
BUILD_SECONDS = 30.0


@contextmanager
def limited(what: str, timeout: float | None) -> Iterator[None]:
    """Raise `PluginError` when the block takes longer than `timeout`, at least `BUILD_SECONDS`.

    timeout: of a run; None for any. Only the main thread, and where there is SIGALRM, can
    be interrupted; elsewhere there is no limit.
    """
    main = threading.current_thread() is threading.main_thread()
    if timeout is None or not main or not hasattr(signal, "setitimer"):
        yield
        return
    limit = max(timeout, BUILD_SECONDS)

    def stop(number: int, frame: FrameType | None) -> None:
        raise PluginError(
            f"{what}: it was not ready after {limit:g} s; if it takes that long, raise "
            "execution: timeout"
        )

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, limit)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
