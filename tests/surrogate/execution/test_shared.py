"""Workers that share a folder: no run lost, none finished twice, whoever is killed."""

import random
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from misbehaving import Misbehaving

from surrogate.errors import ResultsError
from surrogate.execution.execute import execute
from surrogate.execution.shared.claims import SharedFolder, Watch, at_work
from surrogate.execution.shared.work import work
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import Journal, JournalContents, read
from surrogate.runs.record import Record, from_line
from surrogate.runs.segment import Segment

TESTS = str(Path(__file__).parents[2] / "support")


def spec(**options):
    return SolverSpec("misbehaving", Misbehaving, options)


def calls(path):
    return Counter(float(line.split()[1]) for line in path.read_text().splitlines())


def finished(folder):
    """How often each run stands in all files of the journal."""
    paths = [*folder.glob("segments/*.jsonl"), *folder.glob("runs.jsonl")]
    lines = [line for path in paths for line in path.read_bytes().splitlines()]
    return Counter(from_line(line).inputs["x"] for line in lines)


class Delayed(SharedFolder):
    """The folder as on a network: each file is seen as it was up to `delay` seconds ago.

    What is not there is remembered too, and each file has a delay of its own, so changes come
    late and in another order. Claims are decided by the server at once.
    """

    delay = 0.4

    def _later(self, name, look):
        seen = self.__dict__.setdefault("_seen", {})
        until, value = seen.get(name, (0.0, None))
        if time.monotonic() > until:
            draw = self.__dict__.setdefault("_draw", random.Random(id(self)))
            until, value = time.monotonic() + draw.uniform(0.0, self.delay), look()
            seen[name] = until, value
        return value

    def owner(self, run, generation):
        return self._later(
            ("o", run, generation), lambda: super(Delayed, self).owner(run, generation)
        )

    def sign(self, worker):
        return self._later(("s", worker), lambda: super(Delayed, self).sign(worker))

    def segment_length(self, worker):
        return len(self._later(("f", f"{worker}.jsonl"), lambda: self._bytes(f"{worker}.jsonl")))

    def _bytes(self, name):
        path = self.folder / "segments" / name
        return path.read_bytes() if path.exists() else b""

    def contents(self):
        mirror = self.folder.parent / f"mirror-{id(self)}"
        shutil.rmtree(mirror, ignore_errors=True)
        (mirror / "segments").mkdir(parents=True)
        names = self._later("list", lambda: [p.name for p in (self.folder / "segments").glob("*")])
        for name in names:
            data = self._later(("f", name), lambda name=name: self._bytes(name))
            (mirror / "segments" / name).write_bytes(data)
        return read(mirror)


def test_three_workers_on_a_slow_folder_do_each_run_once(tmp_path):
    """Views that are late and out of order delay runs; they lose and repeat none."""
    log, folder = tmp_path / "diary", tmp_path / "journal"
    columns = {"x": np.arange(40.0)}
    tallies = []

    def one():
        tallies.append(
            work(
                spec(diary=str(log), pause=0.01), columns,
                journal=folder, workers=1, lease=5.0, shared=Delayed(folder),
            )
        )  # fmt: skip

    threads = [threading.Thread(target=one) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert [(t.total, t.done, t.failed) for t in tallies] == [(40, 40, 0)] * 3
    assert set(calls(log).values()) == set(finished(folder).values()) == {1}
    contents = read(folder)
    assert len(contents.records) == 40 and not contents.told
    for record in contents.records.values():
        x = record.inputs["x"]
        assert contents.values(record, "square") == x**2
        assert (contents.values(record, "ramp") == x * np.arange(3.0)).all()
    assert at_work(folder) == []


PROGRAM = textwrap.dedent("""
    import sys
    sys.path.insert(0, {tests!r})
    import numpy as np
    from misbehaving import Misbehaving
    from surrogate.execution.shared.work import work
    from surrogate.runs.identity import SolverSpec
    work(
        SolverSpec("misbehaving", Misbehaving, dict(diary={log!r}, pause={pause})),
        {{"x": np.arange({runs}.0)}}, journal={folder!r}, workers=1, lease=1.5,
    )
""")


@pytest.fixture
def start(tmp_path):
    """Starts workers on one folder; ends those that are left."""
    started = []

    def begin(runs, pause):
        text = PROGRAM.format(
            tests=TESTS, log=str(tmp_path / "diary"), folder=str(tmp_path / "journal"),
            runs=runs, pause=pause,
        )  # fmt: skip
        started.append(subprocess.Popen([sys.executable, "-c", text], stderr=subprocess.PIPE))
        return started[-1]

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def wait_until(fact, seconds=40.0):
    until = time.monotonic() + seconds
    while not fact() and time.monotonic() < until:
        time.sleep(0.02)
    return fact()


def lines(path):
    return len(path.read_text().splitlines()) if path.exists() else 0


def test_the_runs_of_a_killed_worker_are_done_by_others(tmp_path, start):
    log, folder = tmp_path / "diary", tmp_path / "journal"
    workers = [start(60, 0.05) for _ in range(3)]
    assert wait_until(lambda: lines(log) >= 20)
    workers[1].kill()
    assert [worker.wait(60) for worker in workers] == [0, -signal.SIGKILL, 0]
    assert set(finished(folder).values()) == {1} and len(finished(folder)) == 60
    repeated = [x for x, count in calls(log).items() if count > 1]
    assert len(repeated) <= 1  # the one that was under way


def test_a_worker_that_stood_still_drops_what_others_took_over(tmp_path, start):
    log, folder = tmp_path / "diary", tmp_path / "journal"
    still = start(12, 0.15)
    assert wait_until(lambda: lines(log) >= 3)
    still.send_signal(signal.SIGSTOP)
    other = start(12, 0.15)
    assert other.wait(60) == 0
    still.send_signal(signal.SIGCONT)
    assert still.wait(60) == 0
    assert set(finished(folder).values()) == {1} and len(finished(folder)) == 12


def test_runs_done_before_are_known(tmp_path):
    """Journal and segments are one; failed runs are done again when asked, once."""
    log, folder = tmp_path / "diary", tmp_path / "journal"
    one, ways = spec(diary=str(log)), {"way": ["well", "raise", "well", "well"]}
    execute(one, {"x": [0.0, 1.0], "way": ways["way"][:2]}, journal=folder, workers=1)
    columns = {"x": np.arange(4.0), **ways}
    tally = work(one, columns, journal=folder, workers=1)
    assert (tally.reused, tally.done, tally.failed) == (2, 4, 1)
    assert calls(log) == {0.0: 1, 1.0: 1, 2.0: 1, 3.0: 1}
    assert execute(one, columns, journal=folder, workers=1).reused == 4
    for again in (2, 3):
        work(one, columns, journal=folder, workers=1, rerun=["failed"])
        assert calls(log)[1.0] == again
    other = tmp_path / "other" / "journal"
    work(one, columns, journal=other, workers=1, others=[folder])
    assert sum(calls(log).values()) == 7  # the failed one is tried there, the others are copied
    copied = read(other)
    for record in copied.records.values():
        if record.status == "ok":
            values = record.inputs["x"] * np.arange(3.0)
            assert (copied.values(record, "ramp") == values).all()


def test_a_run_that_uses_the_folder_for_itself_keeps_workers_out(tmp_path):
    with Journal(tmp_path):
        with pytest.raises(ResultsError, match="is in use by"):
            work(spec(), {"x": [1.0]}, journal=tmp_path, workers=1)
    SharedFolder(tmp_path).show("laptop-1", "1")
    assert at_work(tmp_path) == ["laptop-1"]
    SharedFolder(tmp_path).show("laptop-1", "ended 0")
    assert at_work(tmp_path) == []


def test_a_sign_counts_by_the_clock_of_the_watcher(tmp_path):
    class Clock:
        seconds = 0.0

        def now(self):
            return self.seconds

    shared, clock = SharedFolder(tmp_path), Clock()
    watch = Watch(shared, lease=10.0, clock=clock)
    shared.show("a", "1")
    assert not watch.is_gone("a", "r.0")
    clock.seconds = 9.0
    shared.show("a", "2")
    assert not watch.is_gone("a", "r.0")
    clock.seconds = 18.0
    assert not watch.is_gone("a", "r.0")
    clock.seconds = 19.5
    assert watch.is_gone("a", "r.0")
    shared.show("a", "ended 5")  # its records are not all to be seen yet
    assert not watch.is_gone("a", "r.0")
    (tmp_path / "segments").mkdir()
    (tmp_path / "segments" / "a.jsonl").write_bytes(b"12345")
    assert watch.is_gone("a", "r.0")


def test_of_several_records_of_a_run_the_answer_counts(tmp_path):
    def record(status, finished, value):
        outputs = {"y": value} if status == "ok" else {}
        return Record("k", {"x": 1.0}, status, "", 0.1, 1, finished, outputs=outputs)

    with Journal(tmp_path) as book:
        book.append(record("failed", 30.0, 0.0))
    for name, one in (("a", record("ok", 10.0, 1.0)), ("b", record("ok", 20.0, 2.0))):
        with Segment(tmp_path, name) as segment:
            segment.append(one, {})
    assert read(tmp_path).records["k"].outputs == {"y": 2.0}


def test_a_damaged_segment_is_told_and_a_torn_one_is_not(tmp_path):
    with Segment(tmp_path, "a") as segment:
        for key in "kl":
            segment.append(Record(key, {"x": 1.0}, "ok", "", 0.1, 1, 1.0, outputs={"y": 1.0}), {})
    path = tmp_path / "segments" / "a.jsonl"
    good = path.read_bytes()
    path.write_bytes(good[:-5])
    contents = read(tmp_path)
    assert (set(contents.records), contents.told) == ({"k"}, [])
    path.write_bytes(good.replace(b'"y": 1.0', b'"y": 1.5', 1))
    contents = read(tmp_path)
    assert set(contents.records) == {"l"}
    assert contents.told[0].startswith(f"{path}, line 1: the record is damaged")
    assert isinstance(contents, JournalContents)
