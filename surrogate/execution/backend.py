"""What carries out runs, wherever it does so: the one protocol that each executor follows."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from surrogate.execution.answers import Outcome
from surrogate.execution.handle import Task
from surrogate.execution.stopping import Stop
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output

#: An attempt that ended, or None: nothing did, but time has passed.
Event = tuple[Task, Outcome] | None


class Backend(Protocol):
    """Carries out the tasks of a queue."""

    @property
    def under_way(self) -> int:
        """Runs that are not given back yet."""

    def results(self, queue: deque[Task], stop: Stop) -> Generator[Event, None, None]:
        """Yield (task, outcome) as runs end, and None now and then when none does.

        A result may be forgotten only when the next event is asked for: by then it is kept.
        Whoever consumes it may append tasks to the queue. It ends when the queue is empty
        and no run goes on, or as `stop` asks: then finished runs are still yielded and the
        others are given up. Raises `PluginError` when the solver cannot be built there,
        `SurrogateError` when no run can be carried out any more.
        """


@dataclass(frozen=True)
class RunSettings:
    """What a backend has to know of the runs.

    wanted   outputs to keep
    places   runs under way at once; None: as many as there are cores, or the cluster has places
    threads  of numerical libraries in a run; None: cores / places
    timeout  seconds that a run may take, None for any
    memory   bytes that a run and the programs that it starts may use, None for any
    retries  more attempts for a worker that is killed while it starts
    folder   where scripts and their output may be put, for whoever looks for a cause
    """

    spec: SolverSpec
    wanted: Mapping[str, Output]
    places: int | None = None
    threads: int | None = None
    timeout: float | None = None
    memory: float | None = None
    retries: int = 0
    folder: Path = Path()


#: Makes a backend when the runs begin.
Start = Callable[[RunSettings], Backend]


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
