import multiprocessing
import os
import re
import signal
import subprocess
import sys
import textwrap
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import misbehaving
import numpy as np
import pytest
from misbehaving import WAYS, Misbehaving, Noise, Threads, Unbuildable

from surrogate.errors import PluginError, ResultsError, StudyError, SurrogateError
from surrogate.execution.backend import cores
from surrogate.execution.execute import execute
from surrogate.execution.progress import Progress
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import Journal, read


def spec(**options):
    return SolverSpec("misbehaving", Misbehaving, options)


def by_x(folder):
    """Records of a journal by the first input."""
    return {record.inputs["x"]: record for record in read(folder).records.values()}


def diary(path):
    """x of every call that was made, in order."""
    return [float(line.split()[1]) for line in path.read_text().splitlines()]


SENTENCES = {
    "refuse": r"^the bandage is longer than the leg$",
    "raise": r"^ZeroDivisionError: no stiffness \(misbehaving.py, line \d+\)$",
    "sys_exit": r"^SystemExit: enough \(misbehaving.py, line \d+\)$",
    "nan": r"^output 'square' is nan; it must be finite$",
    "nan_field": r"^output 'ramp' is not finite in 2 of 3 places$",
    "shape": r"^output 'ramp' has shape \(4,\); the solver declares \(3,\)$",
    "text": r"^output 'square' is 'four'; it must be real numbers$",
    "complex": r"^output 'square' is 1j; it must be real numbers$",
    "missing": r"^the solver did not return 'square'; it returned ramp$",
    "nothing": r"^the solver returned NoneType; it must return a mapping",
    "exit": r"^the worker ended by itself with exit code 3; it printed last: leaving$",
    "segfault": r"^the worker was killed by SIGSEGV",
    "kill": r"^the worker was killed by SIGKILL, which the system sends when memory runs out$",
    "hang": r"^stopped after 1.5 s, the time limit of a run$",
    "hang_in_c": r"^stopped after 1.5 s, the time limit of a run$",
}


def test_each_mishap_costs_its_own_run_and_says_what_happened(tmp_path, capfd):
    """Between any two misbehaving runs lie good ones, in the same batches; all of them live."""
    ways = [way for bad in SENTENCES for way in ["well", bad, "well", "well"]]
    x = np.arange(len(ways), dtype=float)
    tally = execute(
        spec(), {"x": x, "way": np.array(ways)}, journal=tmp_path, workers=2, timeout=1.5
    )
    assert (tally.done, tally.failed) == (len(ways), len(SENTENCES))
    contents, records = read(tmp_path), by_x(tmp_path)
    for number, way in zip(x, ways, strict=True):
        record = records[number]
        if way == "well":
            assert (record.status, record.message, record.attempts) == ("ok", "", 1)
            assert record.outputs == {"square": number**2}
            assert (contents.values(record, "ramp") == number * np.arange(3)).all()
        else:
            assert record.status == ("timed_out" if "hang" in way else "failed")
            assert re.search(SENTENCES[way], record.message), record.message
            assert not record.outputs and not record.fields
    assert capfd.readouterr() == ("", "")
    assert set(SENTENCES) | {"well", "child", "greedy", "flaky"} == set(WAYS)


def test_runs_only_what_the_journal_lacks(tmp_path):
    log = tmp_path / "diary"
    one = spec(diary=str(log))
    execute(one, {"x": [1.0, 2.0, 1.0]}, journal=tmp_path / "j", workers=1)
    assert sorted(diary(log)) == [1.0, 2.0]
    seen = []
    tally = execute(
        one, {"x": [3.0, 2.0, 1.0]}, journal=tmp_path / "j", workers=1, progress=seen.append
    )
    assert sorted(diary(log)) == [1.0, 2.0, 3.0]
    assert (tally.total, tally.reused, tally.done, tally.failed) == (3, 2, 3, 0)
    earlier = [r.seconds for r in read(tmp_path / "j").records.values() if r.inputs["x"] < 3]
    assert seen[0] == Progress(3, reused=2, done=2, seconds_left=pytest.approx(sum(earlier) / 2))
    assert seen[-1] == tally and tally.seconds_left == 0.0 and tally.last.inputs["x"] == 3.0


def test_constants_and_nominal_values_are_part_of_a_run(tmp_path):
    """Freezing a parameter at a value keeps its runs; another value, option or version does not."""
    one, home = spec(), {"journal": tmp_path, "workers": 1}
    assert execute(one, {"x": [1.0, 2.0], "offset": [0.0, 5.0]}, **home).reused == 0
    assert execute(one, {"x": [1.0]}, **home).reused == 1
    assert execute(one, {"x": [2.0]}, constants={"offset": 5}, **home).reused == 1
    assert execute(one, {"x": [2.0]}, **home).reused == 0
    assert execute(spec(pause=1e-3), {"x": [2.0]}, **home).reused == 0
    assert execute(SolverSpec("other", Misbehaving), {"x": [2.0]}, **home).reused == 0
    assert execute(one, {"x": [np.nextafter(2.0, 3.0)]}, **home).reused == 0
    assert execute(one, {"x": [-0.0]}, **home).reused == 0
    assert execute(one, {"x": [0.0]}, **home).reused == 1


def test_other_studies_journals_are_used_again(tmp_path):
    """A renamed study finds its runs, arrays included, and keeps them in its own journal."""
    execute(spec(), {"x": [1.0, 2.0]}, journal=tmp_path / "old", workers=1)
    tally = execute(
        spec(),
        {"x": [2.0, 3.0]},
        journal=tmp_path / "new",
        workers=1,
        others=[tmp_path / "none", tmp_path / "old"],
    )
    assert (tally.reused, tally.done) == (1, 2)
    contents = read(tmp_path / "new")
    assert (contents.values(by_x(tmp_path / "new")[2.0], "ramp") == [0, 2, 4]).all()


def test_an_output_that_was_not_kept_is_computed_and_the_old_one_stays(tmp_path):
    for outputs, reused in ((["square"], 0), (["ramp"], 0), (["square"], 1), (None, 1)):
        tally = execute(spec(), {"x": [3.0]}, journal=tmp_path, outputs=outputs, workers=1)
        assert tally.reused == reused


def test_retries_until_it_works(tmp_path):
    """A crash, then an exception, then an answer: three attempts, one good run."""
    log = tmp_path / "diary"
    execute(
        spec(diary=str(log)),
        {"x": [1.0], "way": ["flaky"]},
        journal=tmp_path / "j",
        workers=1,
        retries=2,
    )
    (record,) = read(tmp_path / "j").records.values()
    assert (record.status, record.attempts, record.outputs["square"]) == ("ok", 3, 1.0)
    assert diary(log) == [1.0, 1.0, 1.0]


def test_does_not_ask_again_what_a_deterministic_solver_answered(tmp_path):
    """`SolverError` and NaN are answers; an exception may be a passing fault."""
    for deterministic, attempts in ((True, [1, 1, 3]), (False, [3, 3, 3])):
        folder = tmp_path / str(deterministic)
        execute(
            spec(deterministic=deterministic),
            {"x": [1.0, 2.0, 3.0], "way": ["refuse", "nan", "raise"]},
            journal=folder,
            workers=1,
            retries=2,
        )
        assert [by_x(folder)[x].attempts for x in (1.0, 2.0, 3.0)] == attempts


def test_failed_runs_are_done_again_only_when_asked(tmp_path):
    columns, home = {"x": [1.0, 2.0, 3.0], "way": ["raise", "hang", "well"]}, {"journal": tmp_path}
    assert execute(spec(), columns, timeout=0.6, **home).failed == 2
    assert execute(spec(), columns, timeout=0.6, **home).reused == 3
    assert execute(spec(), columns, timeout=0.6, rerun=["failed"], **home).reused == 2
    assert execute(spec(), columns, timeout=0.8, **home).reused == 2
    assert execute(spec(), columns, timeout=0.6, rerun=["timed_out"], **home).reused == 2


def test_a_stochastic_solver_repeats_equal_points(tmp_path):
    """Each repetition is a run of its own, and is found again."""
    noise = SolverSpec("noise", Noise)
    execute(noise, {"x": [1.0, 1.0, 2.0]}, journal=tmp_path, workers=2)
    drawn = sorted(r.outputs["y"] for r in read(tmp_path).records.values())
    assert len(set(drawn)) == 3
    tally = execute(noise, {"x": [1.0, 2.0, 1.0, 1.0]}, journal=tmp_path, workers=2)
    assert (tally.total, tally.reused) == (4, 3)


@pytest.mark.parametrize("workers", [2, 3])
def test_the_number_of_workers_changes_nothing(tmp_path, workers):
    columns = {"x": np.random.default_rng(5).random(60), "way": ["well", "raise", "nan"] * 20}
    found = []
    for count in (1, workers):
        folder = tmp_path / str(count)
        execute(spec(), columns, journal=folder, workers=count)
        contents = read(folder)
        found.append(
            {
                key: (
                    r.status,
                    r.message,
                    r.outputs,
                    r.attempts,
                    r.status == "ok" and contents.values(r, "ramp").tobytes(),
                )
                for key, r in contents.records.items()
            }
        )
    assert found[0] == found[1] and len(found[0]) == 60


def test_a_hung_run_takes_its_programs_along(tmp_path):
    """A program that the solver waits for ends with the worker that is stopped."""
    execute(
        spec(diary=str(tmp_path / "pid")),
        {"x": [1.0], "way": ["child"]},
        workers=1,
        journal=tmp_path / "j",
        timeout=1.0,
    )
    assert by_x(tmp_path / "j")[1.0].status == "timed_out"
    assert wait_until(lambda: ended(int((tmp_path / "pid").read_text())))


def test_threads_of_numerical_libraries_are_limited(tmp_path, monkeypatch):
    """Libraries already loaded, and the variables that later ones read."""
    for threads, stated in ((1, "64"), (2, "64"), (2, "1")):
        monkeypatch.setenv("OMP_NUM_THREADS", stated)
        execute(
            SolverSpec(f"threads {threads} {stated}", Threads),
            {"x": [1.0]},
            workers=1,
            threads=threads,
            journal=tmp_path,
        )
    limits = {r.solver["solver"][8:]: r.outputs for r in read(tmp_path).records.values()}
    assert limits["1 64"] == limits["2 1"] == {"limit": 1.0, "variable": 1.0}
    assert limits["2 64"] == {"limit": min(2.0, cores()), "variable": 2.0}


@pytest.mark.parametrize(
    "by, sentence",
    [
        ("raise", "cannot be built in a worker process: OSError: mesh.inp is not on this machine"),
        (
            "exit",
            "cannot be built in a worker process: the worker ended by itself with exit code 9",
        ),
    ],
)
def test_a_solver_that_workers_cannot_build_is_one_sentence(tmp_path, by, sentence):
    broken = SolverSpec("broken", Unbuildable, {"home": os.getpid(), "by": by})
    with pytest.raises(PluginError, match=sentence):
        execute(broken, {"x": [1.0, 2.0]}, journal=tmp_path, workers=2)


def test_a_solver_that_cannot_be_imported_is_one_sentence(tmp_path):
    local = SolverSpec("local", lambda: Misbehaving())
    with pytest.raises(StudyError, match="executor=ThreadPoolExecutor"):
        execute(local, {"x": [1.0]}, journal=tmp_path)
    with ThreadPoolExecutor(2) as threads:
        assert execute(local, {"x": [1.0, 2.0]}, journal=tmp_path, executor=threads).failed == 0


def test_wrong_arguments_are_reported_together(tmp_path):
    with pytest.raises(StudyError) as caught:
        execute(
            spec(),
            {"x": [1.0]},
            journal=tmp_path,
            workers=0,
            timeout=-1,
            retries=-1,
            rerun=["broken"],
        )
    assert len(caught.value.mistakes) == 4
    for columns, constants, sentence in [
        ({"y": [1.0]}, {}, "misbehaving has no input 'y'"),
        ({"x": [np.inf]}, {}, "x: inf is not finite"),
        ({"x": ["a"]}, {}, "x: 'a' is not a number"),
        ({"x": [1.0]}, {"way": "wel"}, "did you mean 'well'"),
        ({}, {}, "needs a value for 'x'"),
    ]:
        solver = SolverSpec(
            "misbehaving",
            Misbehaving if columns else Unbuildable,
            {} if columns else {"home": os.getpid()},
        )
        with pytest.raises(StudyError, match=sentence):
            execute(solver, columns, constants=constants, journal=tmp_path)
    with pytest.raises(StudyError, match="output 'sqare' is unknown; did you mean 'square'"):
        execute(spec(), {"x": [1.0]}, outputs=["sqare"], journal=tmp_path)


def test_a_full_disk_stops_with_a_sentence_and_no_worker_left(tmp_path, monkeypatch):
    append, made = Journal.append, []

    def full(book, record, fields):
        if len(made) == 5:
            raise ResultsError("cannot write: No space left on device")
        made.append(append(book, record, fields))

    monkeypatch.setattr(Journal, "append", full)
    log = tmp_path / "diary"
    with pytest.raises(ResultsError, match="No space left"):
        execute(
            spec(diary=str(log), pause=0.02),
            {"x": np.arange(50.0)},
            workers=2,
            journal=tmp_path / "j",
        )
    assert len(read(tmp_path / "j").records) == 5
    assert wait_until(lambda: all(map(ended, pids(log))))


# Executors of the user


@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_any_executor_gives_the_same_runs(tmp_path, kind):
    columns = {"x": np.arange(20.0), "way": ["well", "raise", "nan", "refuse"] * 5}
    execute(spec(), columns, journal=tmp_path / "local", workers=1)
    options = {} if kind is ThreadPoolExecutor else {"mp_context": spawning()}
    with kind(2, **options) as executor:
        execute(spec(), columns, journal=tmp_path / "theirs", executor=executor, workers=2)
    local, theirs = by_x(tmp_path / "local"), by_x(tmp_path / "theirs")
    assert len(local) == 20
    for x, record in local.items():
        assert theirs[x].key == record.key
        assert (theirs[x].status, theirs[x].message) == (record.status, record.message)
        assert theirs[x].outputs == record.outputs


def spawning():
    return multiprocessing.get_context("spawn")


def test_a_run_over_time_in_an_executor_is_given_up(tmp_path):
    with ThreadPoolExecutor(2) as executor:
        tally = execute(
            spec(pause=0.05),
            {"x": [1.0, 2.0, 3.0]},
            executor=executor,
            workers=2,
            journal=tmp_path,
            timeout=20,
        )
        assert tally.failed == 0
        execute(
            spec(pause=1.5),
            {"x": [4.0]},
            executor=executor,
            workers=2,
            journal=tmp_path,
            timeout=0.3,
        )
    assert by_x(tmp_path)[4.0].status == "timed_out"
    assert "the executor cannot stop it" in by_x(tmp_path)[4.0].message


def test_an_executor_full_of_hung_runs_is_a_sentence(tmp_path):
    with ThreadPoolExecutor(1) as executor:
        with pytest.raises(SurrogateError, match="all 1 places of the executor are taken"):
            execute(
                spec(pause=1.5),
                {"x": [1.0, 2.0, 3.0]},
                executor=executor,
                workers=2,
                journal=tmp_path,
                timeout=0.3,
            )
    assert by_x(tmp_path)[1.0].status == "timed_out"


def test_an_executor_that_breaks_is_a_sentence_and_keeps_the_rest(tmp_path):
    columns = {"x": [1.0, 2.0, 3.0, 4.0], "way": ["well", "well", "exit", "well"]}
    with ProcessPoolExecutor(1, mp_context=spawning()) as executor:
        with pytest.raises(SurrogateError, match="the executor stopped working"):
            execute(spec(), columns, executor=executor, workers=1, journal=tmp_path)
    assert [record.status for record in by_x(tmp_path).values()] == ["ok", "ok"]


# Programs that end before their time

PROGRAM = textwrap.dedent("""
    import sys
    sys.path.insert(0, {tests!r})
    import numpy as np
    from misbehaving import Misbehaving
    from surrogate.execution.execute import execute
    from surrogate.runs.identity import SolverSpec

    # No `if __name__ == "__main__"`: workers do not run this file again.
    spec = SolverSpec("misbehaving", Misbehaving, {{"diary": {diary!r}, "pause": 0.05}})
    try:
        execute(spec, {{"x": np.arange(60.0)}}, journal={journal!r}, workers=2)
    except KeyboardInterrupt as stopped:
        print(stopped)
        sys.exit(130)
    """)


def wait_until(condition, seconds=10.0):
    """True as soon as the condition holds."""
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


def ended(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    status = Path(f"/proc/{pid}/stat")
    return status.exists() and status.read_text().rsplit(")")[-1].split()[0] == "Z"


def pids(log):
    return {int(line.split()[0]) for line in log.read_text().splitlines()}


def start_program(tmp_path):
    """A program half-way through its sixty runs."""
    script, log, folder = tmp_path / "program.py", tmp_path / "diary", tmp_path / "j"
    script.write_text(
        PROGRAM.format(
            tests=str(Path(misbehaving.__file__).parent), diary=str(log), journal=str(folder)
        )
    )
    program = subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert wait_until(lambda: len(read(folder).records) >= 20, 30.0)
    return program, log, folder


def resume(log, folder):
    """Do the rest; no run that was finished is called again, and none is missing."""
    kept = {record.inputs["x"] for record in read(folder).records.values()}
    assert 20 <= len(kept) < 60
    assert wait_until(lambda: all(map(ended, pids(log))))
    before = diary(log)
    assert len(before) - len(kept) <= 2  # at most the two that were under way are lost
    tally = execute(
        SolverSpec("misbehaving", Misbehaving, {"diary": str(log), "pause": 0.05}),
        {"x": np.arange(60.0)},
        journal=folder,
        workers=2,
    )
    assert (tally.done, tally.reused, tally.failed) == (60, len(kept), 0)
    assert Counter(diary(log)[len(before) :]) == Counter(set(np.arange(60.0)) - kept)


def test_kill_9_loses_only_what_was_under_way(tmp_path):
    program, log, folder = start_program(tmp_path)
    program.send_signal(signal.SIGKILL)
    assert program.wait() == -signal.SIGKILL
    program.communicate()
    resume(log, folder)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_cleanly_and_goes_on_later(tmp_path, number):
    program, log, folder = start_program(tmp_path)
    program.send_signal(number)
    out, err = program.communicate(timeout=10)
    assert (program.returncode, err) == (130, "")
    assert (
        out == f"stopped: {len(read(folder).records)} of 60 runs are done and kept; "
        "run again to go on\n"
    )
    resume(log, folder)


def children(pid):
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs Linux's /proc")
@pytest.mark.parametrize("delay", [0.0, 0.05, 0.15, 0.3])
def test_ctrl_c_while_workers_start_leaves_no_tracebacks(tmp_path, delay):
    """A terminal sends Ctrl-C to all processes of the group, newborn workers included."""
    script = tmp_path / "program.py"
    script.write_text(
        PROGRAM.format(
            tests=str(Path(misbehaving.__file__).parent),
            diary=str(tmp_path / "diary"),
            journal=str(tmp_path / "j"),
        )
    )
    program = subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert wait_until(lambda: len(children(program.pid)) >= 2, 30.0)
    time.sleep(delay)
    os.killpg(program.pid, signal.SIGINT)
    out, err = program.communicate(timeout=10)
    assert (program.returncode, err) == (130, "") and out.startswith("stopped: ")


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="needs process groups")
def test_kill_9_of_the_parent_ends_programs_that_runs_started(tmp_path):
    script, log = tmp_path / "program.py", tmp_path / "pid"
    script.write_text(
        PROGRAM.format(
            tests=str(Path(misbehaving.__file__).parent),
            diary=str(log),
            journal=str(tmp_path / "j"),
        ).replace("np.arange(60.0)}", "[1.0], 'way': ['child']}")
    )
    program = subprocess.Popen([sys.executable, str(script)])
    assert wait_until(lambda: log.exists() and log.read_text().isdigit(), 30.0)
    program.kill()
    program.wait()
    assert wait_until(lambda: ended(int(log.read_text())))


def test_killed_workers_cost_their_run_only(tmp_path):
    """Workers killed from outside at random times: their runs are done again, all are good."""
    program, log, folder = start_program(tmp_path)
    killed = 0
    while program.poll() is None and killed < 3:
        pid = int(log.read_text().splitlines()[-1].split()[0])
        if not ended(pid):
            os.kill(pid, signal.SIGKILL)
            killed += 1
        time.sleep(0.3)
    program.communicate(timeout=60)
    records = by_x(folder)
    assert len(records) == 60 and killed
    assert {record.status for record in records.values()} == {"ok"}
    assert sum(record.attempts for record in records.values()) <= 60 + killed
