"""What is said of an analysis that goes on."""

import re

from surrogate.cli.progress import RunsBar, StagesBar
from surrogate.execution.progress import Progress
from surrogate.stages.stage import Step


def test_a_line_a_minute_where_there_is_no_terminal(capsys):
    """Stage, surrogate, output, count and time left; nothing in the first minute."""
    now = [0.0]
    with StagesBar("mine", clock=lambda: now[0]) as bar:
        bar(Step("fits", "linear of flow", 0, 3))
        now[0] = 61.0
        bar(Step("fits", "gp of flow", 1, 3, 90.0))
        now[0] = 119.0
        bar(Step("reduced_study"))
        now[0] = 122.0
        bar(Step("reduced_study"))
    said = capsys.readouterr().err.splitlines()
    assert said == ["mine: fits: gp of flow (2 of 3), 90 s left", "mine: reduced study"]


def test_the_part_of_a_job_is_told(capsys):
    """Fold and mode with the time left, a line a minute however often it is told."""
    now = [0.0]
    with StagesBar("mine", clock=lambda: now[0]) as bar:
        bar(Step("fits", "gp of field", 1, 3))
        for second in range(180):
            now[0] = second + 0.5
            part = f"fold {second // 18 + 1} of 10, mode 2 of 7"
            bar(Step("fits", "gp of field", 1, 3, 270.0 - second, part))
    assert capsys.readouterr().err.splitlines() == [
        "mine: fits: gp of field (2 of 3), fold 4 of 10, mode 2 of 7, 4 min left",
        "mine: fits: gp of field (2 of 3), fold 7 of 10, mode 2 of 7, 2 min left",
    ]


def test_runs_are_told_first_last_and_once_a_minute(capsys):
    """Ten runs in a second are two lines, and hours of runs a line a minute."""
    now = [0.0]
    with RunsBar("mine", clock=lambda: now[0]) as bar:
        for done in range(11):
            now[0] = done / 10
            bar(Progress(10, done=done))
    assert capsys.readouterr().err.splitlines() == ["0/10 runs", "10/10 runs"]
    with RunsBar("mine", clock=lambda: now[0]) as bar:
        for done in range(8):
            now[0] += 25.0
            bar(Progress(7, done=done))
    said = [line.split("/")[0] for line in capsys.readouterr().err.splitlines()]
    assert said == ["0", "2", "5", "7"]


def test_on_a_terminal_figures_are_never_cut(capsys, monkeypatch):
    """However long names are: counts and time left stay whole within 80 columns."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    name = "a_name_that_somebody_liked_to_be_as_clear_as_it_can_be"
    with RunsBar(name) as bar:
        bar(Progress(1000, reused=30, done=400, failed=20, seconds_left=4000.0))
        bar.bar.refresh()
    with StagesBar(name) as steps:
        steps(Step("fits", f"gp of {name}", 3, 8, 300.0))
        steps.bar.refresh()
    said = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", capsys.readouterr().err)
    lines = [line.rstrip() for line in re.split(r"[\r\n]+", said)]
    assert max(map(len, lines)) <= 80
    assert any("400/1000 30 reused, 20 failed, 67 min left" in line for line in lines)
    assert "stage " in said and "5 min left" in " ".join(said.split())
