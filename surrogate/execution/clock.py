"""Time that counts against a limit: only while this process ran."""

from __future__ import annotations

import time

#: Longest pause between two looks at the clock while all is well, in seconds.
TICK = 0.2

#: A longer time between two looks means that nothing ran: a suspended laptop, a stopped job.
LONGEST_STEP = 1.0


class RunClock:
    """Seconds since its making, without those during which this process stood still."""

    def __init__(self) -> None:
        self._seconds = 0.0
        self._looked = time.monotonic()

    def now(self) -> float:
        """Look at the clock; to be done at least every `TICK` seconds."""
        moment = time.monotonic()
        step, self._looked = moment - self._looked, moment
        self._seconds += step if step <= LONGEST_STEP else TICK
        return self._seconds
