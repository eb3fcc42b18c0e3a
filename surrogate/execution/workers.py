"""What happens inside a worker process: build the solver once, then answer calls."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Mapping
from multiprocessing import parent_process
from multiprocessing.connection import Connection, wait

from threadpoolctl import threadpool_limits

from surrogate.execution.answers import Outcome, describe, evaluate
from surrogate.solver import Output, Solver

#: Seconds of work after which a worker gives the rest of a batch back.
BATCH_SECONDS = 0.1

#: Bytes of a solver's printing that are kept.
PRINTED_BYTES = 1_000_000

THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)


def work(
    connection: Connection, spec: bytes, wanted: Mapping[str, Output], threads: int, printed: str
) -> None:
    """Life of a worker process.

    spec is the pickled (build, options) of the solver. Sends a text when the solver cannot
    be built, else None whenever it is idle; receives batches [(number, call), ...], answers
    each call by (number, outcome) as soon as it is known. None ends it.
    """
    _leave_terminal(printed)
    _end_with_parent()
    threads = limit_threads(threads)
    try:
        build, options = pickle.loads(spec)
        solver = build(**options)
    except BaseException as error:
        connection.send(describe(error))
        return
    with threadpool_limits(threads):
        _answer(connection, solver, wanted)


def _answer(connection: Connection, solver: Solver, wanted: Mapping[str, Output]) -> None:
    connection.send(None)
    while (batch := connection.recv()) is not None:
        until = time.perf_counter() + BATCH_SECONDS
        for number, call in batch:
            connection.send((number, evaluate(solver, call, wanted)))
            if time.perf_counter() > until:
                break
        _forget_printed()
        connection.send(None)


def _leave_terminal(printed: str) -> None:
    """Print into a file, keep out of the way of Ctrl-C, and lead a group of processes.

    As a group, a worker and the programs that it started can be killed together.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(os, "setsid"):
        os.setsid()
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    file = os.open(printed, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
    os.dup2(file, 1)
    os.dup2(file, 2)
    os.close(file)
    sys.stdout = open(1, "w", buffering=1, errors="replace", closefd=False)
    sys.stderr = open(2, "w", buffering=1, errors="replace", closefd=False)


def _forget_printed() -> None:
    if os.fstat(1).st_size > PRINTED_BYTES:
        os.ftruncate(1, 0)


def _end_with_parent() -> None:
    """Watch for the death of the parent, even by kill -9, and end with it."""
    parent = parent_process()

    def watch() -> None:
        wait([parent.sentinel])
        if hasattr(os, "killpg"):
            os.killpg(0, signal.SIGKILL)
        os._exit(1)

    if parent is not None:
        threading.Thread(target=watch, daemon=True).start()


def limit_threads(threads: int) -> int:
    """Limit libraries not yet loaded, and programs that the solver starts, to `threads`.

    Fewer when the user's environment asks for fewer; returns how many it is.
    """
    stated = os.environ.get("OMP_NUM_THREADS", "")
    if stated.isdigit() and int(stated) > 0:
        threads = min(threads, int(stated))
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, str(threads)))
    return threads


class BuiltSolver:
    """The solver of one study inside somebody's executor: built once per thread."""

    _last = threading.local()

    @classmethod
    def evaluate(cls, token: str, build, options, call, wanted) -> Outcome:
        """Outcome of one call; a solver that cannot be built makes a failed run."""
        if getattr(cls._last, "token", None) != token:
            try:
                cls._last.solver = build(**options)
            except Exception as error:
                return Outcome("failed", f"the solver cannot be built: {describe(error)}", 0.0)
            cls._last.token = token
        return evaluate(cls._last.solver, call, wanted)
