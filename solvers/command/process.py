"""One run of an external program, with nothing left behind.

The program and all that it starts form a process group of their own, which is killed when
the time is over, when the program has ended, and when this process dies (see supervisor.py).
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

STDOUT, STDERR = "stdout.txt", "stderr.txt"
SUPERVISOR = Path(__file__).with_name("supervisor.py")
#: Lines of each stream, and characters in all, that an error message repeats.
LAST_LINES, LAST_CHARACTERS = 8, 1500


def run(arguments: Sequence[str], folder: Path, timeout: float | None) -> int | None:
    """Run the program in `folder` until it ends; its exit status, None when out of time.

    timeout: seconds, None for any. What it prints goes to stdout.txt and stderr.txt in
    `folder`; it has no standard input.
    """
    with open(folder / STDOUT, "wb") as out, open(folder / STDERR, "wb") as err:
        process, lifeline = _start(
            arguments, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err
        )
        try:
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
        finally:
            _kill(process)
            process.wait()
            if lifeline is not None:
                os.close(lifeline)


def _start(arguments: Sequence[str], **options) -> tuple[subprocess.Popen, int | None]:
    """The process and the writing end of the pipe by which it notices our death."""
    if not hasattr(os, "killpg"):
        return subprocess.Popen(arguments, **options), None
    ours, lifeline = os.pipe()
    try:
        process = subprocess.Popen(
            [sys.executable, "-I", "-S", str(SUPERVISOR), str(ours), *arguments],
            pass_fds=[ours],
            process_group=0,
            **options,
        )
    except OSError:
        os.close(lifeline)
        raise
    finally:
        os.close(ours)
    return process, lifeline


def _kill(process: subprocess.Popen) -> None:
    """Kill what is left of the group; its leader may have ended already."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()


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
        lines = _tail(folder / name).splitlines()[-LAST_LINES:]
        said += [f"  {name.removesuffix('.txt')}: {line}" for line in lines if line.strip()]
    return "\n".join(said)


def _tail(path: Path) -> str:
    with open(path, "rb") as stream:
        stream.seek(0, os.SEEK_END)
        stream.seek(max(0, stream.tell() - LAST_CHARACTERS))
        return stream.read().decode(errors="replace")
