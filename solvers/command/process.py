"""One run of an external program, with nothing left behind.

A supervisor runs the program and ends all that it started: when the program has ended,
when the time is over, and when this process dies (see supervisor.py).
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from . import written

STDOUT, STDERR = "stdout.txt", "stderr.txt"
SUPERVISOR = Path(__file__).with_name("supervisor.py")
#: Lines of each stream, and bytes in all, that an error message repeats.
LAST_LINES, LAST_BYTES = 8, 1500
#: Seconds between two looks at the clock. More than twice that between two of them means
#: that nothing ran (a suspended laptop, a stopped job): it does not count.
TICK = 0.2
#: Seconds that the supervisor may take to end a program.
PATIENCE = 10.0


def run(
    arguments: Sequence[str], folder: Path, timeout: float | None, temporary: bool = False
) -> int | None:
    """Run the program in `folder` until it ends; its exit status, None when out of time.

    timeout: seconds, None for any. What it prints goes to stdout.txt and stderr.txt in
    `folder`; it has no standard input. temporary: the folder goes when this process dies.
    """
    with open(folder / STDOUT, "wb") as out, open(folder / STDERR, "wb") as err:
        if not hasattr(os, "killpg"):
            with subprocess.Popen(
                arguments, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err
            ) as process:
                try:
                    return _wait(process, timeout)
                finally:
                    process.kill()
        ours, lifeline = os.pipe()
        try:
            process = subprocess.Popen(
                [
                    *(sys.executable, "-I", "-S", str(SUPERVISOR), str(ours)),
                    *(str(folder) if temporary else "", *arguments),
                ],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=err,
                pass_fds=[ours],
                process_group=0,
            )
            os.close(ours)
            try:
                return _wait(process, timeout)
            finally:
                _end(process, lifeline)
        finally:
            os.close(lifeline)


def _wait(process: subprocess.Popen[bytes], timeout: float | None) -> int | None:
    if timeout is None:
        return process.wait()
    while timeout > 0:
        start = time.monotonic()
        try:
            return process.wait(min(timeout, TICK))
        except subprocess.TimeoutExpired:
            step = time.monotonic() - start
            timeout -= step if step <= 2 * TICK else TICK
    return None


def _end(supervisor: subprocess.Popen[bytes], lifeline: int) -> None:
    """Let the supervisor end the program, if it has not ended; without it if need be."""
    with suppress(BrokenPipeError):
        os.write(lifeline, b".")
    try:
        supervisor.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(supervisor.pid, signal.SIGKILL)
        supervisor.wait()


def status_text(status: int) -> str:
    """`exit status 3`, or also the signal's name for 128 + n."""
    with suppress(ValueError):
        if status > 128:
            return f"exit status {status} ({signal.Signals(status - 128).name})"
    return f"exit status {status}"


def last_words(folder: Path) -> str:
    """The last lines that the program printed, stderr first; empty when it printed nothing."""
    said = []
    for name in (STDERR, STDOUT):
        with suppress(written.Unfit, OSError):
            lines = written.tail(folder / name, LAST_BYTES).splitlines()[-LAST_LINES:]
            said += [f"  {name.removesuffix('.txt')}: {line}" for line in lines if line.strip()]
    return "\n".join(said)
