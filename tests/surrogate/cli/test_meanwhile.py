"""Loading beside the runs: all that is told goes on, and at the end the analysis is there."""

from __future__ import annotations

import subprocess
import sys

from surrogate.cli.meanwhile import loading
from surrogate.execution.progress import Progress

SCRIPT = """
import sys
from surrogate.cli.meanwhile import loading
from surrogate.execution.progress import Progress

with loading(None) as told:
    assert "surrogate.report.page" not in sys.modules
    told(Progress(3))
assert {"surrogate.report.page", "surrogate.cli.findings", "pint"} <= set(sys.modules)
"""


def test_progress_is_handed_on():
    seen: list[Progress] = []
    words = [Progress(2), Progress(2, done=1)]
    with loading(seen.append) as told:
        for word in words:
            told(word)
    assert seen == words


def test_at_the_end_all_is_loaded():
    subprocess.run([sys.executable, "-c", SCRIPT], check=True)
