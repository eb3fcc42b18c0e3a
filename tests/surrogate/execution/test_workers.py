"""What solvers and the world do to worker processes, and what is left of it: nothing."""

import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time
from multiprocessing import Pipe
from pathlib import Path

import pytest
import unruly
from unruly import KilledAtStart, Large, SlowToBuild, Unruly

from surrogate.errors import PluginError, SurrogateError
from surrogate.execution import clock, pool
from surrogate.execution.channel import TOKEN_BYTES, Channel, Garbled
from surrogate.execution.clock import RunClock
from surrogate.execution.execute import execute
from surrogate.execution.folder import owned_folder
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import read

linux = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def spec(deed, diary=None):
    return SolverSpec("unruly", Unruly, {"deed": deed, "diary": diary and str(diary)})


def by_x(folder):
    return {record.inputs["x"]: record for record in read(folder).records.values()}


def wait_until(condition, seconds=20.0):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


def ended(pid):
    """True when the process is gone or a zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")")[-1].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def written(diary):
    """Processes in a diary."""
    return {int(line.split()[0]) for line in diary.read_text().splitlines()}


def sleepers(place):
    """Programs `sleep` that have `place` as their working folder."""
    found = set()
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if (folder / "comm").read_text() == "sleep\n" and os.readlink(folder / "cwd") == place:
                found.add(int(folder.name))
        except OSError:
            continue
    return {pid for pid in found if not ended(pid)}


@pytest.fixture
def program(tmp_path, temporary):
    """Starts a program that runs an `Unruly` at points x, in a folder of its own."""
    started = []

    def start(deed, points, timeout=None):
        script = tmp_path / "program.py"
        script.write_text(
            textwrap.dedent(f"""
            import sys
            sys.path.insert(0, {str(Path(unruly.__file__).parent)!r})
            from unruly import Unruly
            from surrogate.execution.execute import execute
            from surrogate.runs.identity import SolverSpec
            spec = SolverSpec("unruly", Unruly, {{"deed": {deed!r}, "diary": "diary"}})
            def progress(now):
                if now.finishing is not None:
                    print(f"finishing {{now.finishing}}", flush=True)
            try:
                execute(spec, {{"x": {points}}}, journal="j", workers=2, timeout={timeout},
                        progress=progress)
            except KeyboardInterrupt as stopped:
                print(stopped, flush=True)
                sys.exit(130)
            """)
        )
        started.append(
            subprocess.Popen(
                [sys.executable, str(script)], cwd=tmp_path, stdout=subprocess.PIPE, text=True
            )
        )
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()
        process.stdout.close()


# Answers that are not the worker's


@forks
@pytest.mark.parametrize("deed", ["fork", "raising_fork"])
def test_a_forked_child_of_a_solver_answers_nothing(tmp_path, deed):
    """Each run has the answer of its own worker, once."""
    points = [float(x) for x in range(40)]
    tally = execute(spec(deed), {"x": points}, journal=tmp_path, workers=2)
    assert (tally.done, tally.failed) == (40, 0)
    for x, record in by_x(tmp_path).items():
        assert (record.outputs, record.attempts) == ({"square": x * x}, 1)


@forks
def test_an_answer_of_another_process_ends_the_worker(tmp_path):
    execute(spec("stubborn_fork"), {"x": [2.0]}, journal=tmp_path, workers=1)
    record = by_x(tmp_path)[2.0]
    assert record.status == "failed"
    assert "a copy of it that the solver forked" in record.message


@pytest.mark.skipif(os.name == "nt", reason="descriptors of pipes differ")
def test_garbage_in_the_pipe_costs_one_run(tmp_path):
    tally = execute(spec("garbage"), {"x": [1.0, 2.0, 3.0]}, journal=tmp_path, workers=1)
    records = by_x(tmp_path)
    assert (tally.done, tally.failed) == (3, 1)
    assert records[2.0].message.startswith("the worker sent something that is no answer")
    assert records[3.0].outputs == {"square": 9.0}


@pytest.fixture
def ends():
    """Both ends of a pipe: the program's, which never waits, and the worker's, raw."""
    ours, theirs = Pipe()
    token = b"t" * TOKEN_BYTES
    yield Channel(ours, token, waits=False), theirs, token
    ours.close()
    theirs.close()


def message(token, content):
    packed = pickle.dumps(content)
    return token + len(packed).to_bytes(8, "little") + packed


@pytest.mark.skipif(os.name == "nt", reason="pipes there keep messages whole")
def test_half_a_message_holds_nobody_up(ends):
    channel, theirs, token = ends
    data = message(token, "whole") + message(token, list(range(1000)))
    os.write(theirs.fileno(), data[:-500])
    assert list(channel.receive()) == ["whole"]
    assert list(channel.receive()) == []
    os.write(theirs.fileno(), data[-500:])
    assert list(channel.receive()) == [list(range(1000))]
    theirs.close()
    assert list(channel.receive()) == [] and channel.closed


@pytest.mark.skipif(os.name == "nt", reason="pipes there keep messages whole")
def test_a_message_that_finds_no_room_is_sent_later(ends):
    channel, theirs, token = ends
    content = os.urandom(3_000_000)
    channel.send(content)
    other, received = Channel(theirs, token, waits=True), []
    os.set_blocking(theirs.fileno(), False)
    while not received:
        channel.flush()
        received += other.receive()
    assert received == [content]


@pytest.mark.skipif(os.name == "nt", reason="pipes there keep messages whole")
@pytest.mark.parametrize("data", [b"x" * 100, b"t" * TOKEN_BYTES + b"\x04" + bytes(7) + b"gibb"])
def test_what_is_no_message_is_told(ends, data):
    channel, theirs, _ = ends
    os.write(theirs.fileno(), data)
    with pytest.raises(Garbled):
        list(channel.receive())


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="needs SIGSTOP")
@pytest.mark.parametrize("solver", [spec("stop"), SolverSpec("large", Large)])
def test_a_stopped_worker_is_out_of_time(tmp_path, solver):
    """Stopped in its run, or in the middle of sending 48 MB; the others go on."""
    execute(solver, {"x": [1.0, 2.0, 3.0]}, journal=tmp_path, workers=2, timeout=2.0)
    found = {x: record.status for x, record in by_x(tmp_path).items()}
    assert found[1.0] == found[3.0] == "ok"
    assert found[2.0] == "timed_out" or solver.name == "large"  # it may have been faster


# Time


def test_building_a_solver_has_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(pool, "BUILD_SECONDS", 1.0)
    slow = SolverSpec("slow", SlowToBuild, {"home": os.getpid()})
    with pytest.raises(PluginError, match="slow cannot be built .*: it was not ready after 1 s"):
        execute(slow, {"x": [1.0, 2.0]}, journal=tmp_path, workers=2, timeout=0.5)


def test_time_during_which_nothing_ran_does_not_count(monkeypatch):
    """Looks 0.1 s apart, once 4 s apart: the processes were stopped, or the laptop slept."""
    moments = iter([100.0, 100.1, 100.2, 104.2, 104.3])
    monkeypatch.setattr(clock.time, "monotonic", lambda: next(moments))
    running = RunClock()
    seconds = [running.now() for _ in range(4)]
    assert seconds == pytest.approx([0.1, 0.2, 0.2 + clock.TICK, 0.3 + clock.TICK])


# The machine


def test_workers_killed_while_they_start_count_against_retries(tmp_path):
    """Three of them: with `retries: 3` all runs are done; without, the cause is said."""
    for retries, name in ((3, "more"), (0, "none")):
        diary = tmp_path / name
        options = {"home": os.getpid(), "diary": str(diary), "losses": 3}
        solver = SolverSpec(name, KilledAtStart, options)
        home = {"journal": tmp_path / f"j_{name}", "workers": 1, "retries": retries}
        if retries:
            assert execute(solver, {"x": [1.0, 2.0]}, **home).failed == 0
        else:
            with pytest.raises(SurrogateError, match="3 workers in a row .* SIGKILL") as caught:
                execute(solver, {"x": [1.0, 2.0]}, **home)
            assert not isinstance(caught.value, PluginError)


def test_a_run_lost_to_the_machine_is_done_again(tmp_path):
    """Without retries; one that is lost each time is a failed run in the end."""
    home = {"workers": 1, "retries": 0}
    execute(spec("killed_once", tmp_path / "d"), {"x": [1.0, 2.0]}, journal=tmp_path / "a", **home)
    assert {(r.status, r.attempts) for r in by_x(tmp_path / "a").values()} == {("ok", 2)}
    execute(spec("killed"), {"x": [1.0]}, journal=tmp_path / "b", **home)
    record = by_x(tmp_path / "b")[1.0]
    assert (record.status, record.attempts) == ("failed", 3) and "SIGKILL" in record.message
    assert record.lost
    assert execute(spec("killed"), {"x": [1.0]}, journal=tmp_path / "b", **home).reused == 0


# What is left


def test_temporary_files_of_killed_runs_are_removed(tmp_path, temporary):
    execute(spec("fill"), {"x": [1.0, 2.0]}, journal=tmp_path / "j", workers=2, timeout=1.0)
    assert {record.status for record in by_x(tmp_path / "j").values()} == {"timed_out"}
    assert list(temporary.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="needs process groups")
def test_temporary_files_of_a_killed_program_are_removed(tmp_path, temporary, program):
    running, diary = program("fill", [1.0, 2.0]), tmp_path / "diary"
    assert wait_until(lambda: diary.exists() and len(diary.read_text().splitlines()) == 4)
    assert list(temporary.glob("surrogate-*/*/*/scratch"))
    running.kill()
    assert wait_until(lambda: list(temporary.iterdir()) == [])
    assert wait_until(lambda: all(map(ended, written(diary))))


def test_folders_of_killed_programs_go_at_the_next_start(temporary):
    """Those that nobody holds; not one that is held, or that is none of ours."""
    for name in ("surrogate-old", "surrogate-other"):
        (temporary / name / "1").mkdir(parents=True)
    (temporary / "surrogate-old" / "owner").write_text("process 1")
    (temporary.parent / "theirs").mkdir()
    (temporary.parent / "theirs" / "owner").write_text("precious")
    (temporary / "surrogate-link").symlink_to(temporary.parent / "theirs")
    hold = (
        "import sys; from pathlib import Path; from surrogate.execution.folder import owned_folder"
        "\nwith owned_folder() as folder: print(folder, flush=True); sys.stdin.read()"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", hold], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    held = Path(holder.stdout.readline().strip())
    with owned_folder() as ours, owned_folder() as second:
        left = {temporary / "surrogate-other", temporary / "surrogate-link"}
        assert set(temporary.iterdir()) == {held, ours, second, *left}
    holder.communicate("")
    assert set(temporary.iterdir()) == left
    assert (temporary.parent / "theirs" / "owner").read_text() == "precious"


@linux
def test_a_worker_that_holds_the_interpreter_dies_with_its_program(tmp_path, program):
    running, diary = program("hold", [1.0, 2.0]), tmp_path / "diary"
    assert wait_until(lambda: diary.exists() and len(written(diary)) == 2)
    running.kill()
    assert wait_until(lambda: all(map(ended, written(diary))))


@linux
@pytest.mark.parametrize("deed, timeout", [("daemons", None), ("hung_daemons", 1.5)])
def test_daemons_end_with_their_worker(tmp_path, monkeypatch, deed, timeout):
    """After a good run, and when the run is stopped: sessions of their own do not help them."""
    monkeypatch.chdir(tmp_path)
    diary, home = tmp_path / "diary", {"journal": tmp_path / "j", "workers": 1}
    execute(spec(deed, diary), {"x": [1.0]}, timeout=timeout, **home)
    assert by_x(tmp_path / "j")[1.0].status == ("timed_out" if timeout else "ok")
    assert len(written(diary)) == 2  # the worker and its daemon
    assert wait_until(lambda: all(map(ended, written(diary))))
    assert wait_until(lambda: not sleepers(str(tmp_path)))


@linux
def test_daemons_end_with_a_killed_program(tmp_path, program):
    running, diary = program("hung_daemons", [1.0]), tmp_path / "diary"
    assert wait_until(lambda: diary.exists() and len(written(diary)) == 2)
    assert wait_until(lambda: len(sleepers(str(tmp_path))) == 2)
    running.kill()
    assert wait_until(lambda: all(map(ended, written(diary))))
    assert wait_until(lambda: not sleepers(str(tmp_path)))


# Ctrl-C


def test_a_first_ctrl_c_finishes_the_runs_under_way(tmp_path, program):
    running, diary = program("pause", [float(x) for x in range(20)]), tmp_path / "diary"
    assert wait_until(lambda: diary.exists() and len(written(diary)) == 2)
    running.send_signal(signal.SIGINT)
    out, _ = running.communicate(timeout=30)
    lines = out.splitlines()
    assert running.returncode == 130 and lines[0] == "finishing 2"
    started = len(diary.read_text().splitlines())
    assert len(read(tmp_path / "j").records) == started < 20
    assert lines[-1] == f"stopped: {started} of 20 runs are done and kept; run again to go on"


@linux
def test_a_second_ctrl_c_stops_at_once(tmp_path, program):
    running, diary = program("hold", [1.0, 2.0, 3.0]), tmp_path / "diary"
    assert wait_until(lambda: diary.exists() and len(written(diary)) == 2)
    running.send_signal(signal.SIGINT)
    assert running.stdout.readline() == "finishing 2\n"
    running.send_signal(signal.SIGINT)
    out, _ = running.communicate(timeout=30)
    assert running.returncode == 130
    assert out == "stopped: 0 of 3 runs are done and kept; run again to go on\n"
    assert all(map(ended, written(diary)))


# The start


def test_a_worker_imports_numpy_and_the_solver_only():
    """Heavier packages would cost each worker a second of its processor."""
    imports = (
        "import sys, surrogate.execution.workers, surrogate.study.solver_factory, "
        "surrogate_solvers.textbook; print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", imports], capture_output=True, text=True)
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert "numpy" in loaded
    assert not loaded & {"scipy", "xarray", "pandas", "pydantic", "pint", "yaml", "sklearn"}
