"""What is said of an analysis that goes on."""

from surrogate.cli.progress import StagesBar
from surrogate.stages.stage import Step


def test_a_line_a_minute_where_there_is_no_terminal(capsys):
    """Surrogate, output, count and time left; nothing in the first minute."""
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
