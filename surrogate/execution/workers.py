"""What happens inside a worker process: build the solver once, then answer calls."""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from multiprocessing import parent_process
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from surrogate.execution.answers import Outcome, describe, evaluate
from surrogate.execution.channel import Channel
from surrogate.solver import Output, Solver

#: Seconds of work after which a worker gives the rest of a batch back.
BATCH_SECONDS = 0.1

#: Bytes of a solver's printing that are kept.
PRINTED_BYTES = 1_000_000

#: prctl(2) of Linux.
PR_SET_CHILD_SUBREAPER = 36

THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)


#: What a worker sends: its process, and (number, outcome) of a run, or None twice when it
#: is idle, or None and a text when it cannot build the solver.
Message = tuple[int, int | None, Outcome | str | None]


def work(
    connection: Connection,
    spec: bytes,
    wanted: Mapping[str, Output],
    threads: int,
    place: Path,
    token: bytes,
) -> None:
    """Life of a worker process.

    spec is the pickled (build, options) of the solver, place its temporary folder. Sends
    each `Message` behind `token`; receives batches [(number, call), ...]. None ends it.
    """
    _leave_terminal(place.with_suffix(".txt"))
    _end_with_parent()
    _adopt_orphans()
    _use_for_temporary_files(place)
    threads = limit_threads(threads)
    channel = Channel(connection, token, waits=True)
    process = os.getpid()
    try:
        build, options = pickle.loads(spec)
        solver = build(**options)
    except BaseException as error:
        _only_in(process)
        channel.send((os.getpid(), None, describe(error)))
        return
    _only_in(process)
    with threadpool_limits(threads):
        _answer(channel, solver, wanted)


def _answer(channel: Channel, solver: Solver, wanted: Mapping[str, Output]) -> None:
    channel.send((os.getpid(), None, None))
    while not channel.closed:
        for batch in channel.receive():
            if batch is None:
                return
            until = time.perf_counter() + BATCH_SECONDS
            for number, call in batch:
                outcome = evaluate_here(solver, call, wanted)
                channel.send((os.getpid(), number, outcome))
                if time.perf_counter() > until:
                    break
            _forget_printed()
            channel.send((os.getpid(), None, None))


def evaluate_here(solver: Solver, call: Mapping[str, Any], wanted: Mapping[str, Output]) -> Outcome:
    """`evaluate`, from which only the process that began it returns.

    A solver may fork and let its child return too; the child would answer a second time.
    """
    process = os.getpid()
    outcome = evaluate(solver, call, wanted)
    _only_in(process)
    return outcome


def _only_in(process: int) -> None:
    """End a copy of the process that the solver forked."""
    if os.getpid() != process:
        os._exit(0)


def _leave_terminal(printed: Path) -> None:
    """Print into a file, keep out of the way of Ctrl-C, and lead a session of processes.

    As a session, a worker and the programs that it started can be found and killed together.
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
    """End with the parent, however it ends, where no guardian does that (Windows)."""
    parent = parent_process()
    if parent is None or hasattr(os, "killpg"):
        return

    def watch(sentinel: int) -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=watch, args=(parent.sentinel,), daemon=True).start()


def _adopt_orphans() -> None:
    """Become the parent of processes whose own parent ends, to find them later (Linux)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def _use_for_temporary_files(place: Path) -> None:
    """Let this process, and programs that it starts, put temporary files into `place`."""
    os.environ.update(dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(place)))
    tempfile.tempdir = None


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
    def evaluate(
        cls,
        token: str,
        build: Callable[..., Solver],
        options: Mapping[str, Any],
        call: Mapping[str, Any],
        wanted: Mapping[str, Output],
    ) -> Outcome:
        """Outcome of one call; a solver that cannot be built makes a failed run."""
        if getattr(cls._last, "token", None) != token:
            try:
                cls._last.solver = build(**options)
            except Exception as error:
                return Outcome("failed", f"the solver cannot be built: {describe(error)}", 0.0)
            cls._last.token = token
        return evaluate_here(cls._last.solver, call, wanted)
