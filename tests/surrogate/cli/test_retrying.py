"""--retry-failed with and without a choice, and status --watch."""

import io

import pytest
from rich.console import Console

from surrogate import Study
from surrogate.cli.progress import RunsBar
from surrogate.cli.retrying import _joined, chosen
from surrogate.cli.watching import watch
from surrogate.errors import StudyError
from surrogate.execution.progress import Progress
from surrogate.execution.rerun import is_asked, mistakes


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--retry-failed", "s.yaml"], ["--retry-failed=all", "s.yaml"]),
        (["s.yaml", "--retry-failed"], ["s.yaml", "--retry-failed=all"]),
        (["--retry-failed", "timed_out", "s.yaml"], ["--retry-failed=timed_out", "s.yaml"]),
        (["s.yaml", "--retry-failed", "message~no licence", "--json"],
         ["s.yaml", "--retry-failed=message~no licence", "--json"]),
        (["s.yaml", "--retry-failed=failed"], ["s.yaml", "--retry-failed=failed"]),
    ],
)  # fmt: skip
def test_the_option_may_stand_alone(words, expected):
    assert list(_joined(words)) == expected


def test_what_is_done_again():
    assert chosen(None) == ()
    assert chosen(["all"]) == ("failed", "timed_out")
    assert chosen(["timed_out", "message~lic"]) == ("timed_out", "message~lic")
    assert is_asked("failed", "the licence server is busy", ["timed_out", "message~licence"])
    assert not is_asked("failed", "no stiffness", ["timed_out", "message~licence"])
    assert is_asked("timed_out", "", ["timed_out"])
    assert list(mistakes(["failed", "message~x"])) == []
    assert len(list(mistakes(["late", "message~"]))) == 2


STUDY = """\
study: s
solver: 'moody:Moody'
parameters: {x: [-1, 1]}
designs: {train: {method: full_factorial, levels: 2}}
execution: {workers: 1}
"""
MOODY = """\
from pathlib import Path
from surrogate.errors import SolverError
from surrogate.solver import Input, Output

class Moody:
    version, inputs, outputs = "1", {"x": Input()}, {"y": Output()}
    def __call__(self, x):
        with open(Path(__file__).parent / "diary", "a") as diary:
            diary.write(f"{x:g} ")
        raise SolverError("no licence" if x > 0 else "no stiffness")
"""


@pytest.fixture
def moody(tmp_path):
    (tmp_path / "moody.py").write_text(MOODY)
    (tmp_path / "s.yaml").write_text(STUDY)
    return Study.from_yaml(tmp_path / "s.yaml")


def test_runs_are_done_again_by_message(moody, tmp_path):
    moody.run(results=tmp_path / "r")
    moody.run(results=tmp_path / "r", retry_failed=["message~licence"])
    moody.run(results=tmp_path / "r", retry_failed=["timed_out"])
    assert (tmp_path / "diary").read_text() == "-1 1 1 "
    moody.run(results=tmp_path / "r", retry_failed=True)
    assert (tmp_path / "diary").read_text() == "-1 1 1 -1 1 "
    with pytest.raises(StudyError, match="rerun: 'late' is unknown; use failed, timed_out or mes"):
        moody.run(results=tmp_path / "r", retry_failed=["late"])


def test_watching_ends_with_the_last_run(moody, tmp_path):
    """A line a minute where the output is no terminal."""
    text, slept = io.StringIO(), []

    def sleep(seconds):
        slept.append(seconds)
        if len(slept) == 2:
            moody.run(results=tmp_path / "r")

    watch(moody, tmp_path / "r", Console(file=text), sleep)
    assert slept == [60.0, 60.0]
    lines = [line.partition(" ")[2] for line in text.getvalue().splitlines()]
    assert lines[:2] == ["s: 2 left", "s: 2 left"]
    assert lines[2].startswith("s: 2 failed")


def test_a_line_a_minute_without_a_terminal(capsys):
    now = [0.0]
    bar = RunsBar("s", clock=lambda: now[0])
    for done in range(5):
        bar(Progress(1000, done=done))
        now[0] += 30.0
    lines = capsys.readouterr().err.splitlines()
    assert [line.split()[0] for line in lines] == ["0/1000", "2/1000", "4/1000"]
