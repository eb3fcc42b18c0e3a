"""CPU time that running a design costs besides the solver itself.

    python benchmarks/execution_overhead.py [--runs 10000] [--milliseconds 1]

A solver that computes for one millisecond is run 10 000 times, each way in a fresh
process. Overhead = CPU time of parent and workers, starting included, less the
solver's own. `local`, `work` and `dask` are this package's: they keep every run on disk, may
kill a hung run and survive a crash; `work` shares a folder, `dask` runs the solver in a child
of each dask worker. The others hand back values only. About ten minutes.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np

from surrogate.execution.execute import execute
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Input, Output


class Busy:
    """Product of two numbers, after `milliseconds` of computing."""

    version = "1"
    inputs = {"x": Input(), "y": Input()}
    outputs = {"product": Output()}

    def __init__(self, milliseconds: float = 1.0):
        self.milliseconds = milliseconds

    def __call__(self, x, y):
        end = time.thread_time() + self.milliseconds / 1000
        while time.thread_time() < end:
            pass
        return {"product": x * y}


def call(row) -> float:
    """One run, as other tools are given it."""
    return Busy(row[2])(row[0], row[1])["product"]


def with_execute(points, milliseconds, workers) -> None:
    spec = SolverSpec("busy", Busy, {"milliseconds": milliseconds})
    with tempfile.TemporaryDirectory(dir=".") as folder:
        tally = execute(
            spec,
            {"x": points[:, 0], "y": points[:, 1]},
            journal=folder,
            workers=workers,
            timeout=60,
        )
    assert (tally.done, tally.failed) == (len(points), 0)


def with_work(points, milliseconds, workers) -> None:
    from surrogate.execution.shared.work import work

    spec = SolverSpec("busy", Busy, {"milliseconds": milliseconds})
    columns = {"x": points[:, 0], "y": points[:, 1]}
    with tempfile.TemporaryDirectory(dir=".") as folder:
        tally = work(spec, columns, journal=folder, workers=workers, timeout=60)
    assert (tally.done, tally.failed) == (len(points), 0)


def with_dask(points, milliseconds, workers) -> None:
    from execution_overhead import Busy as Importable  # this file, as workers find it

    from surrogate.execution.executors.dask import dask

    spec = SolverSpec("busy", Importable, {"milliseconds": milliseconds})
    columns = {"x": points[:, 0], "y": points[:, 1]}
    with tempfile.TemporaryDirectory(dir=".") as folder:
        executor = partial(dask, workers=workers)
        tally = execute(spec, columns, journal=folder, executor=executor, timeout=60)
    assert (tally.done, tally.failed) == (len(points), 0)


def with_plain_dask(points, milliseconds, workers) -> None:
    from distributed import Client, LocalCluster

    rows = [(x, y, milliseconds) for x, y in points.tolist()]
    options = {"threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    with LocalCluster(n_workers=workers, **options) as cluster, Client(cluster) as client:
        for future in [client.submit(call, row, pure=False) for row in rows]:
            future.result()


def with_futures(points, milliseconds, workers) -> None:
    rows = [(x, y, milliseconds) for x, y in points.tolist()]
    with ProcessPoolExecutor(workers) as executor:
        for future in [executor.submit(call, row) for row in rows]:
            future.result()


def with_joblib(points, milliseconds, workers) -> None:
    from joblib import Parallel, delayed

    rows = [(x, y, milliseconds) for x, y in points.tolist()]
    # Two jobs at least: with one, joblib starts no process and protects from nothing.
    Parallel(n_jobs=max(2, workers))(delayed(call)(row) for row in rows)


def with_pebble(points, milliseconds, workers) -> None:
    from pebble import ProcessPool

    rows = [(x, y, milliseconds) for x, y in points.tolist()]
    with ProcessPool(max_workers=workers) as pool:
        for future in [pool.schedule(call, args=[row], timeout=60) for row in rows]:
            future.result()


WAYS = {
    "local": with_execute,
    "work": with_work,
    "dask": with_dask,
    "plain dask": with_plain_dask,
    "ProcessPoolExecutor": with_futures,
    "joblib": with_joblib,
    "pebble": with_pebble,
}

#: Ways that need no further package.
ALWAYS = ("local", "work", "ProcessPoolExecutor")


def measure(way: str, runs: int, milliseconds: float, workers: int) -> None:
    """Run one way and print [wall, parent, workers] in seconds, as JSON."""
    points = np.random.default_rng(1).random((runs, 2))
    start, before = time.perf_counter(), _cpu(resource.RUSAGE_SELF)
    WAYS[way](points, milliseconds, workers)
    wall = time.perf_counter() - start
    if way == "joblib":  # its workers outlive the call; end and count them
        from joblib.externals.loky import get_reusable_executor

        get_reusable_executor().shutdown(wait=True)
    print(json.dumps([wall, _cpu(resource.RUSAGE_SELF) - before, _cpu(resource.RUSAGE_CHILDREN)]))


def _cpu(who: int) -> float:
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--milliseconds", type=float, default=1.0)
    parser.add_argument("--measure", nargs=2, metavar=("WAY", "WORKERS"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    runs, milliseconds = options.runs, options.milliseconds
    if options.measure:
        measure(options.measure[0], runs, milliseconds, int(options.measure[1]))
        return
    print(f"{runs} runs of {milliseconds:g} ms; CPU milliseconds per run besides the solver's own")
    print(f"{'':22}{'workers':>8}{'parent':>9}{'workers':>9}{'sum':>9}{'wall s':>9}")
    for workers in (1, 2):
        for way in WAYS:
            package = {"dask": "distributed", "plain dask": "distributed"}.get(way, way)
            if way not in ALWAYS and importlib.util.find_spec(package) is None:
                continue
            if way == "joblib" and workers == 1:
                continue
            command = [
                sys.executable,
                __file__,
                "--runs",
                str(runs),
                "--milliseconds",
                str(milliseconds),
                "--measure",
                way,
                str(workers),
            ]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            wall, parent, children = json.loads(done.stdout)
            parent, children = 1000 * parent / runs, 1000 * children / runs - milliseconds
            print(
                f"{way:22}{workers:8}{parent:9.3f}{children:9.3f}{parent + children:9.3f}"
                f"{wall:9.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
