"""The command `surrogate` in the process of the tests, which has loaded what it needs."""

import contextlib
import io
import subprocess
import sys
from unittest.mock import patch

from surrogate.cli.verbs import main


def command(*words, cwd, check=None):
    """Carry out `surrogate words` in the folder cwd; returns what `subprocess.run` would.

    The status must be `check` if given. A module that was loaded once is not loaded again, as
    in any Python program: where a file of a solver changes, a new process has to look.
    """
    argv, out, err = ["surrogate", *map(str, words)], io.StringIO(), io.StringIO()
    status = 0
    with (
        contextlib.chdir(cwd),
        patch.object(sys, "argv", argv),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as stop:
            status = stop.code or 0
    done = subprocess.CompletedProcess(argv, status, out.getvalue(), err.getvalue())
    assert "Traceback" not in done.stderr and "internal error" not in done.stderr, done.stderr
    if check is not None:
        assert done.returncode == check, done.stdout + done.stderr
    return done
