"""Solvers that do to their processes what no solver should, for tests of workers."""

import ctypes
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from surrogate.solver import Input, Output

LARGE = 6_000_000  # doubles: 48 MB


class Unruly:
    """x squared; does `deed` on the way.

    diary  a file to which every call appends a line "pid x", and processes that it starts too
    """

    version = "1"
    inputs = {"x": Input(nominal=1.0)}
    outputs = {"square": Output()}

    def __init__(self, deed, diary=None):
        self.deed, self.diary = deed, diary

    def __call__(self, x):
        self._write(x)
        getattr(self, f"_{self.deed}")(x)
        return {"square": x * x}

    def _write(self, x):
        with open(self.diary or os.devnull, "a") as diary:
            diary.write(f"{os.getpid()} {x!r}\n")

    def _fork(self, x):
        """Let the forked child return as well, sooner than its parent."""
        child = os.fork()
        if child:
            os.waitpid(child, 0)

    def _raising_fork(self, x):
        if os.fork() == 0:
            raise RuntimeError("the child has no answer")
        os.wait()

    def _stubborn_fork(self, x):
        """As `_fork`, from which no check in the worker keeps the child."""
        child = os.fork()
        if child:
            os.waitpid(child, 0)
        else:
            os._exit = lambda status: None
            signal.alarm(5)  # it would wait for work with its parent

    def _garbage(self, x):
        """Write into every pipe and socket that is open."""
        if x == 2.0:
            for number in range(3, 64):
                try:
                    os.write(number, b"Licence expires in 3 days. " * 100)
                except OSError:
                    continue

    def _stop(self, x):
        if x == 2.0:
            os.kill(os.getpid(), signal.SIGSTOP)

    def _fill(self, x):
        """Hang with a large temporary file open, as a program does that is never done."""
        with open(Path(tempfile.mkdtemp()) / "scratch", "wb") as file:
            file.write(b"0" * 1_000_000)
            file.flush()
            self._write(x)
            time.sleep(1000)

    def _hold(self, x):
        """Sleep in C code that keeps the interpreter's lock."""
        ctypes.PyDLL(None).sleep(1000)

    def _daemons(self, x):
        """Leave a program with a session of its own, a daemon, and one that knows nobody."""
        subprocess.Popen(["sleep", "1000"], start_new_session=True)
        subprocess.Popen(["env", "-i", "sleep", "1000"], start_new_session=True)
        middle = os.fork()
        if middle == 0:
            os.setsid()
            if os.fork() == 0:
                self._write(x)
                time.sleep(1000)
            os._exit(0)
        os.waitpid(middle, 0)

    def _hung_daemons(self, x):
        self._daemons(x)
        time.sleep(1000)

    def _killed_once(self, x):
        """Killed from outside at the first call of this point."""
        calls = [line.split()[1] for line in Path(self.diary).read_text().splitlines()]
        if calls.count(repr(x)) == 1:
            os.kill(os.getpid(), signal.SIGKILL)

    def _killed(self, x):
        os.kill(os.getpid(), signal.SIGKILL)

    def _pause(self, x):
        time.sleep(1.0)


class Large:
    """An output of 48 MB; the worker is stopped while it sends it where x is 2."""

    version, inputs = "1", {"x": Input()}
    outputs = {"field": Output(dims=("i",), coordinates={"i": np.arange(float(LARGE))})}

    def __call__(self, x):
        if x == 2.0:
            stop = f"import os, time; time.sleep(0.03); os.kill({os.getpid()}, {signal.SIGSTOP})"
            subprocess.Popen([sys.executable, "-I", "-S", "-c", stop])
        return {"field": np.full(LARGE, x)}


class SlowToBuild(Unruly):
    """Builds in the program `home`, and sleeps in every other."""

    def __init__(self, home):
        super().__init__("fork")
        if os.getpid() != home:
            print("waiting for the licence server", flush=True)
            time.sleep(1000)


class KilledAtStart(Unruly):
    """The first `losses` workers are killed while they build it."""

    def __init__(self, home, diary, losses):
        super().__init__("no_deed", diary)
        if os.getpid() != home:
            self._write("start")
            if len(Path(diary).read_text().splitlines()) <= losses:
                os.kill(os.getpid(), signal.SIGKILL)

    def _no_deed(self, x):
        pass
