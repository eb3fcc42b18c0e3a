"""What happens inside a worker process: build the solver once, then answer calls.

Also the one place where a solver is called and its answer examined, so that a run
means the same in a local worker, in somebody's executor and in the tests.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections.abc import Mapping
from multiprocessing import parent_process
from multiprocessing.connection import Connection, wait
from typing import Any, NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from surrogate.errors import SolverError
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


class Outcome(NamedTuple):
    """How one attempt of a run ended.

    `answered` is True when the solver itself decided (a result, or a `SolverError`, or a
    result that cannot be used): a deterministic solver would only decide the same again.
    """

    status: str
    message: str
    seconds: float
    outputs: Mapping[str, float] = {}
    fields: Mapping[str, np.ndarray] = {}
    answered: bool = True


def evaluate(solver: Solver, call: Mapping[str, Any], wanted: Mapping[str, Output]) -> Outcome:
    """RunInputs the solver once; whatever it does becomes an `Outcome`."""
    start = time.perf_counter()
    try:
        result = solver(**call)
    except SolverError as error:
        return _failed(str(error) or "the solver has no answer here and does not say why", start)
    except (Exception, SystemExit) as error:
        return _failed(describe(error), start, answered=False)
    seconds = time.perf_counter() - start
    try:
        values = {name: check(name, output, result) for name, output in wanted.items()}
    except ValueError as error:
        return _failed(str(error), start)
    scalars = {name: float(value) for name, value in values.items() if not wanted[name].dims}
    fields = {name: value for name, value in values.items() if wanted[name].dims}
    return Outcome("ok", "", seconds, scalars, fields)


def _failed(message: str, start: float, answered: bool = True) -> Outcome:
    return Outcome("failed", message, time.perf_counter() - start, answered=answered)


def check(name: str, output: Output, result: Any) -> np.ndarray:
    """Output `name` of a solver's result as doubles of the declared shape.

    Raises `ValueError` with a sentence when it is missing, no real number, of another
    shape, or not finite where the solver declares no gaps.
    """
    if not isinstance(result, Mapping):
        raise ValueError(
            f"the solver returned {type(result).__name__}; it must return a mapping "
            "of output names to values"
        )
    if name not in result:
        raise ValueError(
            f"the solver did not return '{name}'; it returned "
            f"{', '.join(map(str, result)) or 'nothing'}"
        )
    try:
        value = np.asarray(result[name])
        if value.dtype.kind == "c":
            raise TypeError
        value = value.astype(float)
    except (TypeError, ValueError):
        raise ValueError(
            f"output '{name}' is {_short(result[name])}; it must be real numbers"
        ) from None
    if value.shape != output.shape:
        raise ValueError(
            f"output '{name}' has shape {value.shape}; the solver declares {output.shape}"
        )
    bad = np.count_nonzero(np.isinf(value) if output.gaps else ~np.isfinite(value))
    if bad and not output.dims:
        raise ValueError(f"output '{name}' is {value}; it must be finite")
    if bad:
        raise ValueError(f"output '{name}' is not finite in {bad} of {value.size} places")
    return value


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def describe(error: BaseException) -> str:
    """Type, message and the line where it was raised, in one sentence."""
    name = type(error).__name__
    text = " ".join(str(error).split())
    frames = traceback.extract_tb(error.__traceback__)
    said = f"{name}: {text}" if text else name
    if not frames:
        return said
    return f"{said} ({os.path.basename(frames[-1].filename)}, line {frames[-1].lineno})"


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
