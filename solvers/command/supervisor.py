"""Runs one program and ends with its parent: `supervisor.py DESCRIPTOR PROGRAM ARGUMENT...`.

Started as the leader of its own process group. DESCRIPTOR is the reading end of a pipe
whose writing end only the parent holds: when the parent is gone, whatever killed it, the
pipe closes and the whole group is killed. Uses the standard library only and starts fast.
"""

import os
import signal
import subprocess
import sys
import threading


def end_with_parent(descriptor: int) -> None:
    """Wait until the pipe closes, then kill this process group."""
    os.read(descriptor, 1)
    os.killpg(0, signal.SIGKILL)


def main() -> None:
    """Exit with the program's status; 128 + n when signal n ended it, 127 when not started."""
    threading.Thread(target=end_with_parent, args=(int(sys.argv[1]),), daemon=True).start()
    try:
        status = subprocess.Popen(sys.argv[2:]).wait()
    except OSError as error:
        print(f"{sys.argv[2]} cannot be started: {error.strerror}", file=sys.stderr, flush=True)
        status = 127
    os._exit(status if status >= 0 else 128 - status)


if __name__ == "__main__":
    main()
