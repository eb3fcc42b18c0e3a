"""What the bar of the runs says."""

from dataclasses import replace

from surrogate.cli.progress import RunsBar
from surrogate.execution.execute import Progress


def test_a_first_ctrl_c_says_once_what_is_waited_for(capsys):
    now = Progress(10, done=3)
    with RunsBar("beam") as bar:
        bar(now)
        for done in (3, 4):
            bar(replace(now, done=done, finishing=2))
    said = capsys.readouterr().err.splitlines()
    assert (
        said.count(
            "stopping: the 2 runs under way are finished first; press Ctrl-C again to stop at once"
        )
        == 1
    )
    with RunsBar("beam") as bar:
        bar(replace(now, finishing=1))
    assert "the run under way is finished first" in capsys.readouterr().err
