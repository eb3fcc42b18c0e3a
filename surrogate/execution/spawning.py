"""How a worker process comes to life.

Workers are spawned, not forked: a fork copies the locks of the parent's threads
in whatever state they are (BLAS, progress bar), which hangs now and then, and
limits of threads have to be set before libraries load. Spawning costs an
interpreter start per worker, once.
"""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import sys
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from surrogate.errors import StudyError
from surrogate.runs.identity import SolverSpec

if sys.platform != "win32":
    from multiprocessing import resource_tracker


@dataclass(frozen=True)
class PickledSolver:
    """A solver's (build, options), pickled, and whether unpickling runs the main script again."""

    content: bytes
    needs_main: bool


def parcel(spec: SolverSpec) -> PickledSolver:
    """What a worker needs to build the solver; `StudyError` when it could not import it."""
    cure = (
        "workers cannot import it; put it into a module file, or pass an executor "
        "of threads: executor=ThreadPoolExecutor()"
    )
    needs_main = getattr(spec.build, "__module__", None) == "__main__"
    if needs_main and not hasattr(sys.modules["__main__"], "__file__"):
        raise StudyError(f"solver {spec.name} is defined in an interactive session, and {cure}")
    try:
        return PickledSolver(pickle.dumps((spec.build, dict(spec.options))), needs_main)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise StudyError(
            f"solver {spec.name} cannot be sent to workers ({error}): {cure}"
        ) from error


def start(
    life: Callable[..., None], sent: PickledSolver, *arguments: Any
) -> tuple[BaseProcess, Connection]:
    """A new process that runs life(connection, sent.content, *arguments); our end of its pipe."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(
        target=life, args=(theirs, sent.content, *arguments), name="surrogate worker"
    )
    main = nullcontext() if sent.needs_main else _main_module_left_alone()
    with main, _interrupts_held_back():
        process.start()
    theirs.close()
    return process, ours


@contextmanager
def _main_module_left_alone() -> Iterator[None]:
    """Start a process that does not run the program's main module again.

    multiprocessing would import it into every worker: slow for a command, and wrong for
    a script without `if __name__ == "__main__"`.
    """
    main: Any = sys.modules["__main__"]
    sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Start a process that Ctrl-C does not reach before it has left the terminal.

    It inherits the blocked signal; this process hears of a Ctrl-C a moment later.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # else process.start does, and lets signals through
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
