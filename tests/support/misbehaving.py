"""A solver that goes wrong in every way a solver can, for tests of execution."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from surrogate.errors import SolverError
from surrogate.solver import Input, Output

WAYS = (
    "well",
    "refuse",
    "raise",
    "sys_exit",
    "nan",
    "nan_field",
    "shape",
    "text",
    "complex",
    "missing",
    "nothing",
    "exit",
    "segfault",
    "kill",
    "hang",
    "hang_in_c",
    "child",
    "greedy",
    "flaky",
)


class Misbehaving:
    """x squared and x times 0, 1, 2; goes wrong in the given `way`.

    diary  a file to which every call appends a line "pid x", None for none
    pause  seconds of sleep in each call
    """

    version = "1"
    inputs = {
        "x": Input(unit="mm", nominal=1.0),
        "offset": Input(unit="mm^2", nominal=0.0),
        "way": Input(levels=WAYS, nominal="well"),
    }
    outputs = {
        "square": Output(unit="mm^2", description="x squared"),
        "ramp": Output(unit="mm", dims=("place",), coordinates={"place": np.arange(3.0)}),
    }

    def __init__(self, diary=None, pause=0.0, deterministic=True):
        self.diary, self.pause, self.deterministic = diary, pause, deterministic

    def __call__(self, x, offset, way):
        if self.diary:
            with open(self.diary, "a") as diary:
                diary.write(f"{os.getpid()} {x!r}\n")
        time.sleep(self.pause)
        return getattr(self, f"_{way}")({"square": x * x + offset, "ramp": x * np.arange(3.0)})

    def _well(self, good):
        return good

    def _refuse(self, good):
        raise SolverError("the bandage is longer than the leg")

    def _raise(self, good):
        raise ZeroDivisionError("no stiffness")

    def _sys_exit(self, good):
        sys.exit("enough")

    def _nan(self, good):
        return {**good, "square": float("nan")}

    def _nan_field(self, good):
        return {**good, "ramp": [0.0, np.inf, np.nan]}

    def _shape(self, good):
        return {**good, "ramp": np.zeros(4)}

    def _text(self, good):
        return {**good, "square": "four"}

    def _complex(self, good):
        return {**good, "square": 1j}

    def _missing(self, good):
        return {"ramp": good["ramp"]}

    def _nothing(self, good):
        return None

    def _exit(self, good):
        print("leaving", flush=True)
        os._exit(3)

    def _segfault(self, good):
        ctypes.string_at(0)

    def _kill(self, good):
        os.kill(os.getpid(), signal.SIGKILL)

    def _hang(self, good):
        time.sleep(1000)

    def _hang_in_c(self, good):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        ctypes.PyDLL(None).sleep(1000)  # keeps the interpreter's lock, so no Python code runs

    def _child(self, good):
        """Hang in a program, whose process id the diary learns."""
        program = subprocess.Popen(["sleep", "1000"])
        Path(self.diary).write_text(str(program.pid))
        program.wait()

    def _greedy(self, good):
        """Hold 400 MB until somebody ends it."""
        kept = np.ones(50_000_000)
        time.sleep(1000)
        return {**good, "square": kept.sum()}

    def _flaky(self, good):
        """Crash in the first attempt of a diary's life, raise in the second, answer then."""
        attempts = len(Path(self.diary).read_text().splitlines())
        if attempts == 1:
            os._exit(1)
        if attempts == 2:
            raise RuntimeError("the licence server is busy")
        return good


class Unbuildable:
    """A solver that builds in the parent only."""

    version, inputs, outputs = "1", {"x": Input()}, {"y": Output()}

    def __init__(self, home, by="raise"):
        if os.getpid() != home and by == "raise":
            raise OSError("mesh.inp is not on this machine")
        if os.getpid() != home:
            os._exit(9)

    def __call__(self, x):
        return {"y": x}


class Threads:
    """How many threads the numerical libraries of the process may use."""

    version, inputs = "1", {"x": Input()}
    outputs = {"limit": Output(), "variable": Output()}

    def __call__(self, x):
        from threadpoolctl import threadpool_info

        limits = [pool["num_threads"] for pool in threadpool_info()]
        return {"limit": max(limits), "variable": float(os.environ["OMP_NUM_THREADS"])}


class Noise:
    """A stochastic solver."""

    version, inputs, outputs = "1", {"x": Input()}, {"y": Output()}
    deterministic = False

    def __call__(self, x):
        return {"y": x + np.random.default_rng().random()}
