"""From attempts to finished runs: which are made again, and what is written down of the others."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from surrogate.execution.answers import Outcome
from surrogate.execution.backend import Backend, RunSettings
from surrogate.execution.handle import Task
from surrogate.execution.stopping import Stop
from surrogate.runs.record import Record

#: More attempts, by default, for a run that the machine lost: killed for memory, a node's end.
LOST_AGAIN = 2

#: A finished run and its arrays, or None: none ended, but time has passed.
Finished = tuple[Record, Mapping[str, NDArray[np.float64]]] | None


def finished_runs(
    backend: Backend, settings: RunSettings, queue: deque[Task], stop: Stop
) -> Iterator[Finished]:
    """Runs of the queue as they end for good; failed attempts go back while they may.

    An answer of a deterministic solver, `SolverError` included, is not asked for again.
    """
    described = settings.spec.described
    with closing(backend.results(queue, stop)) as source:
        for event in source:
            if event is None:
                yield None
                continue
            task, outcome = event
            task.attempts += 1
            if _again(task, outcome, settings):
                queue.append(task)
                continue
            record = Record(
                task.key,
                task.call,
                outcome.status,
                outcome.message,
                outcome.seconds,
                task.attempts,
                time.time(),
                settings.timeout,
                outcome.outputs,
                solver=described,
                lost=outcome.lost,
            )
            yield record, outcome.fields


def _again(task: Task, outcome: Outcome, settings: RunSettings) -> bool:
    decided = outcome.answered and (settings.spec.deterministic or outcome.status == "ok")
    allowed = max(settings.retries, LOST_AGAIN) if outcome.lost else settings.retries
    return outcome.status != "ok" and not decided and task.attempts <= allowed
