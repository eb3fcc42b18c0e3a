"""The solver kept ready in processes of its own, one call at a time each, for a server.

Unlike a `Pool` it has no queue of runs that ends: a call comes at any time, takes a free
place, and waits for one when there is none. A process that crashes or runs over its time
costs its own call only, and is replaced.
"""

from __future__ import annotations

import multiprocessing
import uuid
from collections.abc import Mapping
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from concurrent.futures import TimeoutError as OutOfTime
from queue import Queue
from typing import Any

from surrogate.errors import SolverError
from surrogate.execution.workers import BuiltSolver, limit_threads
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output


class Places:
    """`count` processes that answer calls of a solver; `timeout`: seconds of one call.

    Use it in a `with` block: its end ends the processes.
    """

    def __init__(
        self,
        spec: SolverSpec,
        wanted: Mapping[str, Output],
        count: int = 1,
        timeout: float | None = None,
    ):
        self._spec, self._wanted, self._timeout = spec, wanted, timeout
        self._token = uuid.uuid4().hex
        self._free: Queue[ProcessPoolExecutor] = Queue()
        self.count = count
        for _ in range(count):
            self._free.put(_process())

    def __call__(self, call: Mapping[str, Any]) -> dict[str, Any]:
        """Outputs by name; raises `SolverError` when there is no answer."""
        process = self._free.get()
        try:
            outcome = process.submit(
                BuiltSolver.evaluate,
                self._token,
                self._spec.build,
                dict(self._spec.options),
                call,
                self._wanted,
            ).result(self._timeout)
        except OutOfTime:
            _end(process)
            process = _process()
            raise SolverError(f"stopped after {self._timeout:g} s, the time limit") from None
        except BrokenExecutor:
            _end(process)
            process = _process()
            raise SolverError("the solver ended its process") from None
        finally:
            self._free.put(process)
        if outcome.status != "ok":
            raise SolverError(outcome.message)
        return {**outcome.outputs, **outcome.fields}

    def __enter__(self) -> Places:
        return self

    def __exit__(self, *error: object) -> None:
        while not self._free.empty():
            _end(self._free.get())


def _process() -> ProcessPoolExecutor:
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(1, mp_context=context, initializer=limit_threads, initargs=(1,))


def _end(process: ProcessPoolExecutor) -> None:
    for one in (getattr(process, "_processes", None) or {}).values():
        one.kill()
    process.shutdown(wait=False, cancel_futures=True)
