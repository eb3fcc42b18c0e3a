"""Runs one program and ends all that it started: `supervisor.py DESCRIPTOR FOLDER PROGRAM ...`.

DESCRIPTOR is the reading end of a pipe whose writing end only the caller holds. A byte in
it says that the time is over; its end, that the caller is gone, whatever killed it: then
FOLDER is removed too, when it is not empty. Children of the program that leave its process
group or session become children of this process when their parent ends (Linux). Uses the
standard library only and starts fast.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress

#: prctl(2) of Linux.
PR_SET_CHILD_SUBREAPER = 36

#: Threads of this process, each with its children (Linux).
TASKS = "/proc/self/task"


class Lifeline(threading.Thread):
    """Ends the program when the caller asks for it, or is gone (`gone`)."""

    def __init__(self, descriptor: int):
        super().__init__(daemon=True)
        self.descriptor, self.gone = descriptor, False

    def run(self) -> None:
        """Wait for a byte or the end of the pipe."""
        self.gone = not os.read(self.descriptor, 1)
        while True:  # a program that starts at this moment is found a moment later
            _kill(children())
            time.sleep(0.01)


def children() -> set[int]:
    """Children of this process; on Linux also those that it adopted."""
    found = {_program.pid} if _program is not None and _program.returncode is None else set()
    for task in os.listdir(TASKS) if os.path.isdir(TASKS) else ():
        with suppress(OSError), open(f"{TASKS}/{task}/children") as file:
            found |= {int(child) for child in file.read().split()}
    return found


def _kill(processes: set[int]) -> None:
    for process in processes:
        for kill in (os.killpg, os.kill):
            with suppress(ProcessLookupError, PermissionError):
                kill(process, signal.SIGKILL)


def end_children() -> None:
    """Kill what the program left, generation by generation: orphans become our children."""
    if _program is not None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(_program.pid, signal.SIGKILL)
    while left := children():
        _kill(left)
        for process in left:
            with suppress(ChildProcessError):
                os.waitpid(process, 0)


_program: subprocess.Popen[bytes] | None = None


def main() -> None:
    """Exit with the program's status; 128 + n when signal n ended it, 127 when not started."""
    global _program
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    lifeline = Lifeline(int(sys.argv[1]))
    lifeline.start()
    try:
        _program = subprocess.Popen(sys.argv[3:], process_group=0)
        status = _program.wait()
    except OSError as error:
        print(f"{sys.argv[3]} cannot be started: {error.strerror}", file=sys.stderr, flush=True)
        status = 127
    end_children()
    if lifeline.gone and sys.argv[2]:
        import shutil  # a fifth of the start, and rarely needed

        shutil.rmtree(sys.argv[2], ignore_errors=True)
    os._exit(status if status >= 0 else 128 - status)


if __name__ == "__main__":
    main()
