"""The command `surrogate`: verbs only, each imports what it needs and calls one function.

`--help` and the small verbs answer at once: NumPy, SciPy and xarray are loaded by the
verbs that compute.

Exit status: 0 done; 1 ran, but something failed; 2 the input is wrong; 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

from surrogate.cli.ending import carried_out
from surrogate.cli.verbs.app import app

# Each module adds its verbs to the command; --help lists them in this order.
# isort: off
from surrogate.cli.verbs import to_report
from surrogate.cli.verbs import answers
from surrogate.cli.verbs import handing_on
# isort: on

__all__ = ["answers", "app", "handing_on", "main", "to_report"]


def main() -> None:
    """Run the command; people's mistakes end in sentences, never in a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # paths may hold bytes that are no UTF-8
            stream.reconfigure(errors="backslashreplace")
    carried_out(_command)


def _command() -> None:
    completes = "_SURROGATE_COMPLETE" in os.environ  # then the words stand there, not in argv
    if not completes and sys.argv[1:] in ([], ["-h"], ["--help"]):
        from surrogate.cli.overview import overview

        print(overview(app))
    else:
        app(prog_name="surrogate")
