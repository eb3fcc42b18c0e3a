"""External programs: templates, process, outputs, and what is said when something is wrong."""

import json
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

from surrogate.errors import SolverError, StudyError
from surrogate.study.study import Study
from surrogate_solvers.command import Command, process, readers, written

BEAM = """\
import json, sys
values = dict(line.split(" = ") for line in open("beam.inp").read().splitlines())
load, length = float(values["load"]), float(values["length"])
x = [length * i / 4 for i in range(5)]
w = [load * (3 * length * a**2 - a**3) / 6 for a in x]
print("iteration 1: tip = 0.0")
print(f"iteration 2: tip = {w[-1]!r}")
with open("out.csv", "w") as f:
    f.write("# deflection\\nx, w\\n" + "".join(f"{a!r}, {b!r}\\n" for a, b in zip(x, w)))
with open("out.dat", "w") as f:
    f.write("two lines\\nof title\\n" + "".join(f"  {a:.17e}   {b:.17e}\\n" for a, b in zip(x, w)))
json.dump({"result": [{"w/max": max(w), "profile": [[a, b] for a, b in zip(x, w)]}]},
          open("out.json", "w"))
"""
INPUTS = {
    "load": {"unit": "N", "nominal": 10, "range": [0, 100]},
    "length": {"unit": "m", "nominal": 1.0, "range": [0.1, 3]},
}
X = {"x": {"from": 0, "to": 1, "count": 5}}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "beam.py").write_text(BEAM)
    (tmp_path / "beam.template").write_text("load = {{ load }}\nlength = {{length:.17e}}\n")
    return tmp_path


def beam(folder, **changed):
    """A cantilever with a tip load: w(x) = F (3 L x^2 - x^3) / 6, E I = 1."""
    options = {
        "command": [sys.executable, "beam.py"],
        "inputs": INPUTS,
        "files": ["beam.py"],
        "templates": {"beam.inp": "beam.template"},
        "outputs": {"tip": {"unit": "m", "regex": r"tip = (\S+)"}},
        "folder": folder,
    }
    return Command(**{**options, **changed})


def script(folder, text, **changed):
    """A program without inputs that runs the Python `text`."""
    (folder / "program.py").write_text(textwrap.dedent(text))
    options = {
        "command": [sys.executable, "program.py"],
        "files": ["program.py"],
        "inputs": {},
        "outputs": {"y": {"regex": r"y = (\S+)"}},
        "folder": folder,
    }
    return Command(**{**options, **changed})


@pytest.mark.parametrize(
    "output, expected",
    [
        ({"regex": r"tip = (\S+)"}, lambda w, x: w[-1]),
        ({"file": "out.json", "pointer": "/result/0/w~1max"}, lambda w, x: w[-1]),
        ({"file": "out.csv", "csv": {"column": "w", "row": -1}}, lambda w, x: w[-1]),
        ({"file": "out.csv", "csv": {"column": 1, "row": 2}}, lambda w, x: w[2]),
        ({"file": "out.dat", "table": {"column": 1, "skip": 2, "row": 3}}, lambda w, x: w[3]),
        ({"file": "out.csv", "csv": {"column": "w"}, "dims": X}, lambda w, x: w),
        ({"file": "out.dat", "table": {"column": 0, "skip": 2}, "dims": {"x": 5}}, lambda w, x: x),
        (
            {"file": "out.json", "pointer": "/result/0/profile", "dims": {"x": 5, "k": [0, 1]}},
            lambda w, x: np.column_stack([x, w]),
        ),
        ({"regex": r"tip = (\S+)", "dims": {"iteration": 2}}, lambda w, x: [0.0, w[-1]]),
        ({"file": "out.dat", "regex": r"^\s+0\.0+e\+00\s+(\S+)$"}, lambda w, x: 0.0),
    ],
)
def test_every_way_to_read_an_output(folder, output, expected):
    """Each reader gives the closed form to the last digit."""
    load, length = 0.1 + 0.2, 1.7
    x = np.linspace(0, length, 5)
    found = beam(folder, outputs={"y": output})(load=load, length=length)["y"]
    w = load * (3 * length * x**2 - x**3) / 6
    np.testing.assert_allclose(found, expected(w, x), rtol=1e-14, atol=1e-300)
    assert isinstance(found, np.ndarray if "dims" in output else float)


@pytest.mark.parametrize(
    "output",
    [{"file": "out.csv", "csv": {"column": "y", "row": 0}}, {"file": "out.json", "pointer": "/y"}],
)
def test_a_byte_order_mark_is_no_part_of_the_answer(folder, output):
    """Programs on Windows write one before UTF-8."""
    solver = script(
        folder,
        """
        open("out.csv", "w", encoding="utf-8-sig").write("y,z\\n1.5,2\\n")
        open("out.json", "w", encoding="utf-8-sig").write('{"y": 1.5}')
        """,
        outputs={"y": output},
    )
    assert solver() == {"y": 1.5}


def test_declares_the_contract(folder):
    """Inputs, outputs, dims and coordinates as the options say; nominal values fill in."""
    solver = beam(
        folder, outputs={"w": {"unit": "mm", "file": "out.csv", "csv": {"column": "w"}, "dims": X}}
    )
    assert solver.inputs["load"].unit == "N" and solver.inputs["length"].range == (0.1, 3.0)
    assert solver.outputs["w"].dims == ("x",) and solver.outputs["w"].shape == (5,)
    np.testing.assert_array_equal(solver.outputs["w"].coordinates["x"], [0, 0.25, 0.5, 0.75, 1])
    np.testing.assert_allclose(solver()["w"][-1], 10 / 3)


def test_text_command_with_placeholders(folder):
    """A text is split like a shell does; arguments may hold placeholders; no shell runs."""
    solver = Command(
        command=f"'{sys.executable}' -c 'import sys; print(sys.argv[1:])' "
        "--load={{ load:.2f }} '$HOME; ls' {{ kind }}",
        inputs={
            "load": INPUTS["load"],
            "kind": {"levels": ["soft wood", "steel"], "nominal": "steel"},
        },
        outputs={"y": {"regex": r"--load=([\d.]+)', '\$HOME; ls', 'soft wood'"}},
    )
    assert solver(load=2.349, kind="soft wood") == {"y": 2.35}


def test_own_delimiters_and_line_ends(folder):
    """Files that use {{ }} themselves; Windows line ends stay."""
    (folder / "t").write_bytes(b"{{ jinja }} <<load>>\r\nend\r\n")
    solver = script(
        folder,
        "print('y =', open('sub/in.txt', 'rb').read().count(b'\\r\\n'), open('sub/in.txt').read())",
        templates={"sub/in.txt": "t"},
        inputs={"load": INPUTS["load"]},
        delimiters=["<<", ">>"],
        outputs={"y": {"regex": r"y = (\S+)"}, "load": {"regex": r"jinja \}\} (\S+)"}},
    )
    assert solver(load=7) == {"y": 2.0, "load": 7.0}


def test_whole_numbers(folder):
    """`d` writes 3 for 3.0, and a fraction is an error rather than rounded."""
    (folder / "t").write_text("{{ n:d }}")
    solver = script(
        folder,
        "print('y =', open('n').read())",
        templates={"n": "t"},
        inputs={"n": {"nominal": 3.0}},
    )
    assert solver(n=3.0) == {"y": 3.0}
    with pytest.raises(SolverError, match="n: 3.5 cannot be written as 'd'"):
        solver(n=3.5)


def test_runs_are_apart_and_leave_nothing(folder):
    """Each run starts in an empty folder of its own, which is gone afterwards."""
    solver = script(
        folder,
        """
        import os
        assert not os.path.exists("left"), "not empty"
        open("left", "w").close()
        print("y =", len(os.listdir(".")))""",
    )
    before = set(os.listdir(folder))
    assert solver()["y"] == solver()["y"] == 4  # program, left, stdout.txt, stderr.txt
    assert set(os.listdir(folder)) == before


def test_keep(folder):
    """Kept folders hold the inputs, the filled templates and what the program wrote."""
    solver = beam(folder, keep="kept")
    for load in (1.0, 2.0, 2.0):
        solver(load=load, length=1.0)
    kept = sorted((folder / "kept").iterdir())
    assert len(kept) == 3
    for place in kept:
        values = json.loads((place / "inputs.json").read_text())
        assert (place / "beam.inp").read_text().startswith(f"load = {values['load']!r}\n")
        assert {"out.csv", "stdout.txt", "stderr.txt"} <= {p.name for p in place.iterdir()}


def test_program_beside_the_study_and_folders_of_files(folder):
    """A program with a slash is relative to the study; folders are copied whole."""
    program = folder / "run.sh"
    program.write_text("#!/bin/sh\necho y = $(cat mesh/a/points)\n")
    program.chmod(0o755)
    (folder / "mesh" / "a").mkdir(parents=True)
    (folder / "mesh" / "a" / "points").write_text("12")
    solver = Command(
        command="./run.sh",
        inputs={},
        outputs={"y": {"regex": r"y = (\S+)"}},
        files=["mesh"],
        folder=folder,
    )
    assert solver() == {"y": 12.0}


def test_failed_run_says_the_last_words(folder):
    """Exit status, accepted ones, the last lines of both streams; earlier lines are left out."""
    solver = script(
        folder,
        """
        import sys
        print("\\n".join(f"line {i}" for i in range(100)))
        print("Newton diverged", file=sys.stderr)
        sys.exit(3)""",
    )
    with pytest.raises(SolverError) as caught:
        solver()
    said = str(caught.value)
    assert "exit status 3 (accepted: 0)" in said
    assert "stderr: Newton diverged" in said and "stdout: line 99" in said
    assert "line 50" not in said and len(said) < 2000


def test_accepted_exit_codes(folder):
    """A program may end with another status on purpose."""
    text = "import sys; print('y = 1'); sys.exit(2)"
    assert script(folder, text, exit_codes=[0, 2])() == {"y": 1.0}


def test_death_by_signal(folder):
    """A segmentation fault is named."""
    text = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    with pytest.raises(SolverError, match=r"exit status 139 \(SIGSEGV\).*printed nothing"):
        script(folder, text)()


@pytest.mark.parametrize(
    "text, output, said",
    [
        ("print('y = 1')", {"file": "none.txt", "regex": "(.)"}, "did not write none.txt"),
        (
            "print('z = 1')",
            {"regex": r"y = (\S+)"},
            "y: in what the program printed nothing matches",
        ),
        ("print('y = abc')", {"regex": r"y = (\S+)"}, "'abc' is not a number"),
        ("print('y = nan')", {"regex": r"y = (\S+)"}, "not finite"),
        ("print('y = 1e999')", {"regex": r"y = (\S+)"}, "not finite"),
        ("print('{\"a\": [1]}')", {"pointer": "/a/1"}, "no '1' on the way of /a/1; it has 1 items"),
        ("print('{\"tipp\": 1}')", {"pointer": "/tip"}, "did you mean 'tipp'"),
        ("print('{\"a\": 1}')", {"pointer": "/a/b"}, "it holds one value"),
        ("print('{\"a\": null}')", {"pointer": "/a"}, "'None' is not a number"),
        ("print('{')", {"pointer": "/a"}, "it is not JSON"),
        (
            "print('a,b\\n1,2')",
            {"csv": {"column": "c", "row": 0}},
            "no column 'c'; .*Allowed: a, b",
        ),
        ("print('a,b\\n1,2')", {"csv": {"column": "a", "row": 1}}, "no row 1; it has 1 rows"),
        ("print('1 2')", {"table": {"column": 2, "row": 0}}, "no column 2 in the row '1 2'"),
        (
            "print('1\\n2')",
            {"table": {"column": 0}, "dims": {"x": 3}},
            "2 values where \\(3,\\) are",
        ),
        ("print('{\"a\": [1, 2]}')", {"pointer": "/a"}, "2 values where one is expected"),
    ],
)
def test_outputs_that_cannot_be_read(folder, text, output, said):
    """The sentence names the output, the place and what is there instead."""
    with pytest.raises(SolverError, match=said):
        script(folder, text, outputs={"y": output})()


def alive(pid):
    """True when the process runs (a zombie does not)."""
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_until_dead(pid, seconds=5.0):
    end = time.monotonic() + seconds
    while alive(pid) and time.monotonic() < end:
        time.sleep(0.02)
    return not alive(pid)


CHILDREN = """
    import os, subprocess, sys, time
    sleep = [sys.executable, "-c", "import time; time.sleep(60)"]
    child = subprocess.Popen(sleep)
    other = subprocess.Popen(["env", "-i", *sleep], start_new_session=True)
    if os.fork() == 0:
        os.setsid()
        daemon = os.fork()
        if daemon == 0:
            time.sleep(60)
        open({pids!r}, "w").write(f"{{os.getppid()}} {{child.pid}} {{other.pid}} {{daemon}}")
        os._exit(0)
    os.wait()
    print("y = 1", flush=True)
    {last}
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="needs /proc")
@pytest.mark.parametrize("last, timeout", [("time.sleep(60)", 1.5), ("", "1 min")])
def test_nothing_survives_a_run(folder, last, timeout):
    """At the time-out, and also after a good end, all that the program started is killed with
    it: a child, one with a session of its own and no environment, a daemon."""
    pids = folder / "pids"
    solver = script(folder, CHILDREN.format(pids=str(pids), last=last), timeout=timeout)
    start = time.monotonic()
    if last:
        with pytest.raises(
            SolverError,
            match="stopped after 1.5 s; raise timeout and run with --retry-failed(?s:.)*y = 1",
        ):
            solver()
    else:
        assert solver() == {"y": 1.0}
    assert time.monotonic() - start < 15
    assert all(wait_until_dead(int(pid)) for pid in pids.read_text().split())


@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="needs /proc")
def test_nothing_survives_the_death_of_the_caller(folder):
    """When the calling process is killed with -9, the program and its children end too, and
    the working folder goes."""
    pids, temporary = folder / "pids", folder / "tmp"
    temporary.mkdir()
    script(folder, CHILDREN.format(pids=str(pids), last="time.sleep(60)"))
    caller = subprocess.Popen(
        [
            sys.executable,
            "-c",
            textwrap.dedent(f"""
        from surrogate_solvers.command import Command
        Command(command=[{sys.executable!r}, "program.py"], files=["program.py"], inputs={{}},
                outputs={{"y": {{"regex": "y = (.)"}}}}, folder={str(folder)!r})()"""),
        ],
        env={**os.environ, "TMPDIR": str(temporary)},
    )
    end = time.monotonic() + 20
    while not (pids.exists() and pids.read_text().count(" ") == 3) and time.monotonic() < end:
        time.sleep(0.05)
    assert len(list(temporary.iterdir())) == 1
    caller.send_signal(signal.SIGKILL)
    caller.wait()
    assert all(wait_until_dead(int(pid)) for pid in pids.read_text().split())
    end = time.monotonic() + 20
    while list(temporary.iterdir()) and time.monotonic() < end:
        time.sleep(0.02)
    assert list(temporary.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="has no such files")
@pytest.mark.parametrize(
    "make",
    [
        "os.symlink('/dev/zero', 'out')",
        "os.mkfifo('out')",
        "os.mkdir('out')",
        "os.symlink('/dev/zero', 'out'); os.remove('stdout.txt'); os.mkfifo('stdout.txt')",
    ],
)
def test_an_output_that_is_no_regular_file_is_a_sentence(folder, make):
    """Reading a link to /dev/zero, or a pipe, would never end."""
    solver = script(
        folder, f"import os; {make}", outputs={"y": {"file": "out", "regex": r"y = (\S+)"}}
    )
    with pytest.raises(SolverError, match="y: out is no regular file but a folder, a pipe"):
        solver()


def test_of_much_text_the_end_is_read_or_none(folder, monkeypatch):
    """A pattern's last match stands at the end; anything else would need the whole text."""
    monkeypatch.setattr(written, "LARGEST", 10_000)
    much = """
        print("y = 1")
        for i in range(10_000): print("iteration", i)
        print("y = 2")"""
    assert script(folder, much)() == {"y": 2.0}
    with pytest.raises(SolverError, match="what the program printed has 0 MB; at most 0 MB are"):
        script(folder, much, outputs={"y": {"table": {"column": 1, "row": -1}}})()
    with pytest.raises(SolverError, match="nothing matches"):
        script(folder, much, outputs={"y": {"regex": "y = (1)"}})()


def test_time_during_which_nothing_ran_does_not_count(monkeypatch):
    """A laptop that slept for an hour during a program's time of 1 s."""
    moments = iter([0.0, 0.2, 0.2, 3600.0, 3600.0, 3600.2])

    class Program:
        waits = 0

        def wait(self, timeout):
            self.waits += 1
            if self.waits < 4:
                raise subprocess.TimeoutExpired("program", timeout)
            return 0

    monkeypatch.setattr(process.time, "monotonic", lambda: next(moments, 3600.2))
    assert process._wait(Program(), 1.0) == 0


def test_version_follows_what_can_change_an_answer(folder):
    """Template, copied file, command, outputs, program's version; not keep and timeout."""
    versions = [beam(folder).version]
    assert beam(folder, keep="kept", timeout=9).version == versions[0]
    versions.append(beam(folder, program_version="2.1").version)
    versions.append(beam(folder, outputs={"tip": {"regex": r"tip  = (\S+)"}}).version)
    versions.append(beam(folder, command=[sys.executable, "-B", "beam.py"]).version)
    (folder / "beam.template").write_text("load = {{ load }}\nlength = {{ length }}\n")
    versions.append(beam(folder).version)
    (folder / "beam.py").write_text(BEAM + "# changed\n")
    versions.append(beam(folder).version)
    assert len(set(versions)) == len(versions)
    assert "2.1" in versions[1]
    assert beam(folder).version == versions[-1]


def test_version_does_not_follow_the_place_of_the_study(folder, tmp_path_factory):
    """The same files in another folder are the same solver."""
    other = tmp_path_factory.mktemp("other")
    for name in ("beam.py", "beam.template"):
        (other / name).write_bytes((folder / name).read_bytes())
    assert beam(other).version == beam(folder).version


def test_own_program_belongs_to_the_version(folder):
    """Editing the script that a relative command names makes other runs."""
    program = folder / "run.sh"
    program.write_text("#!/bin/sh\necho y = 1\n")
    program.chmod(0o755)
    options = dict(
        command="./run.sh", inputs={}, outputs={"y": {"regex": "y = (.)"}}, folder=folder
    )
    first = Command(**options).version
    program.write_text("#!/bin/sh\necho y = 2\n")
    assert Command(**options).version != first


def test_all_mistakes_at_once(folder):
    """Unknown words, wrong types and what does not fit together in one StudyError."""
    (folder / "bad.template").write_text("a = {{ laod }}\nb = {{ load:q }}\n")
    with pytest.raises(StudyError) as caught:
        Command(
            command="no-such-program --x",
            templates={"in": "bad.template", "b": "none"},
            inputs={
                "load": {"unit": "Nn", "range": [3, 1], "nominall": 2},
                "size": {"nominal": 5, "range": [0, 1]},
                "kind": {"levels": ["a", "b"], "nominal": "c"},
            },
            outputs={
                "y": {"regex": "(", "pointer": "/a"},
                "z": {},
                "w": {"csv": {"column": "w"}},
                "v": {"table": {"column": "v", "row": 0}},
                "u": {"regex": "(a)(b)"},
                "t": {"pointer": "a", "file": "../t"},
            },
            files=["none.msh"],
            exit_codes=[],
            timeout="soon",
            folder=folder,
        )
    said = "\n".join(caught.value.mistakes)
    for part in [
        "program 'no-such-program' is not found or not executable on the PATH",
        "inputs.load.nominall: is unknown; did you mean 'nominal'",
        "inputs.load.unit: 'Nn' is not a unit",
        "inputs.load.range: [3, 1] is upside down",
        "inputs.size.nominal: 5 lies outside range [0, 1]",
        "inputs.kind.nominal: 'c' is not a level",
        "bad.template:1: '{{ laod }}' names no input; did you mean 'load'",
        "bad.template:2: '{{ load:q }}' has a format that does not work",
        "none does not exist",
        "none.msh does not exist",
        "exit_codes: is empty",
        "timeout: 'soon' is not a time",
        "outputs.y: give one of",
        "(2 given)",
        "outputs.z: give one of",
        "(0 given)",
        "is not a regular expression",
        "outputs.w: give either row",
        "outputs.v: column 'v' needs header: true",
        "has 2 groups",
        "outputs.t.pointer: 'a' must start with /",
        "'../t' must lie in the working folder",
    ]:
        assert part in said, part


@pytest.mark.parametrize(
    "changed, said",
    [
        ({"inputs": {**INPUTS, "width": {}}}, "inputs.width: is used nowhere"),
        ({"inputs": {**INPUTS, "a b": {}}}, "inputs.a b: a name has letters"),
        ({"inputs": {"load": {"nominal": "ten"}, "length": {}}}, "'ten' is not a number"),
        ({"command": []}, "command: is empty"),
        ({"command": "echo 'a"}, "cannot be split"),
        ({"command": "./none"}, "'./none' is not found or not executable relative to"),
        ({"outputs": {}}, "outputs: is empty"),
        ({"outputs": {"y": {"regexp": "y"}}}, "outputs.y.regexp: is unknown; did you mean 'regex'"),
        ({"outputs": {"y": {"csv": {"colum": 1}}}}, "outputs.y.csv.column: is needed"),
        ({"outputs": {"y": {"regex": "y", "dims": {"y": 3}}}}, "must be a name of its own"),
        ({"outputs": {"y": {"regex": "y", "dims": {"x": []}}}}, "dims.x: needs at least one"),
        ({"timeout": -1}, "timeout: -1 s must be above 0"),
        ({"timeout": "3 m"}, "timeout: '3 m' is not a time"),
        ({"templates": {"stdout.txt": "beam.template"}}, "the program's own words"),
        ({"templates": {"/etc/x": "beam.template"}}, "must lie in the working folder"),
        ({"files": ["beam.py", "./beam.py"]}, "two of them have the same name"),
        ({"files": {"beam.inp": "beam.py"}}, "'beam.inp' is made from a template already"),
        ({"delimiters": ["", ""]}, "must be two different texts"),
        ({"delimiters": ["|", "|"]}, "must be two different texts"),
        ({"keep": "../../kept"}, "keep: '../../kept' must lie inside the study's folder"),
        ({"keep": "/tmp/kept"}, "keep: '/tmp/kept' must lie inside the study's folder"),
        ({"keep": "away/kept"}, "keep: 'away/kept' must lie inside the study's folder"),
    ],
)
def test_mistakes(folder, changed, said):
    """One sentence each."""
    (folder / "away").symlink_to(folder.parent)
    with pytest.raises(StudyError) as caught:
        beam(folder, **changed)
    assert said in "\n".join(caught.value.mistakes)


@pytest.mark.parametrize(
    "values, said",
    [
        ({"load": 101}, "load: 101 N is not between 0 and 100"),
        ({"load": float("nan")}, "load: nan N is not between"),
        ({"laod": 1}, "input 'laod' is unknown; did you mean 'load'"),
    ],
)
def test_points_without_an_answer(folder, values, said):
    """Outside the declared range, or unknown."""
    with pytest.raises(SolverError, match=said):
        beam(folder)(**values)


def test_picklable(folder):
    """Process workers may receive the solver itself."""
    solver = pickle.loads(pickle.dumps(beam(folder)))
    assert solver(load=3.0, length=1.0)["tip"] == pytest.approx(1.0)


@pytest.mark.parametrize(
    "text, value", [("1.5D+03", 1500.0), ("-2.d-1", -0.2), ("1e5", 1e5), (" 7 ", 7.0), (3, 3.0)]
)
def test_numbers(text, value):
    """Fortran writes D for the exponent."""
    assert readers.number(text) == value


PLACED = """\
study: placed
solver:
  name: command
  options:
    command: echo {{ x }}
    inputs: {x: {nominal: 1, rnage: [0, 2]}}
    keep: ../../kept
    outputs:
      y: {regex: "(.*)"}
      z:
        unit: mm
        json: {a: 1}
      w:
        csv:
          column: 1
          row: 0
          skip: few
parameters: {x: [0, 2]}
designs: {train: {method: sobol, runs: 4}}
"""


def test_mistakes_in_a_study_stand_at_their_own_line_and_column():
    """Each at the key or value itself, however deep inside of the options."""
    with pytest.raises(StudyError) as caught:
        Study.from_text(PLACED, "placed.yaml")
    places = [sentence.split(" ")[:2] for sentence in caught.value.mistakes]
    assert [place for place in places if "study" not in place[1]] == [
        ["placed.yaml:6:30:", "inputs.x.rnage:"],
        ["placed.yaml:7:11:", "keep:"],
        ["placed.yaml:11:9:", "outputs.z:"],
        ["placed.yaml:12:9:", "outputs.z.json:"],
        ["placed.yaml:17:17:", "outputs.w.csv.skip:"],
    ]
