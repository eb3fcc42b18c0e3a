"""Node, to run the project's JavaScript without a browser."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

#: Of tests that need Node.
needed = pytest.mark.skipif(shutil.which("node") is None, reason="no node to run JavaScript with")


def answered(script: Path, given: Any) -> Any:
    """What a script writes as JSON when it is given JSON on its standard input."""
    done = subprocess.run(
        ["node", "--no-warnings", str(script)],
        input=json.dumps(given),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
