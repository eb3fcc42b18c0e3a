"""The command `leg-bandage`: from the scan of a leg to the pressure under its bandage.

Exit status: 0 done; 1 something failed; 2 the input is wrong; 130 interrupted.
"""

from __future__ import annotations

import io
import os
import sys
import traceback
from pathlib import Path

import typer

from surrogate.errors import StudyError, SurrogateError

from .cohort_command import build_cohort_verb
from .fit_scan_command import fit_scan_verb
from .plan_command import plan_verb
from .predict_command import predict_verb
from .prediction import BandageChoiceError
from .scan import ScanError

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="From the scan of a leg to the pressure under its bandage.",
)
app.command("fit-scan")(fit_scan_verb)
app.command("predict")(predict_verb)
app.command("plan")(plan_verb)
app.command("build-cohort")(build_cohort_verb)


def main() -> None:
    """Run the command; people's mistakes end in sentences, never in a traceback."""
    for stream in (sys.stdout, sys.stderr):  # names of files need not be UTF-8
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        app()
    except (ScanError, BandageChoiceError, StudyError) as error:
        _stop(error, 2)
    except KeyboardInterrupt:
        _stop("interrupted", 130)
    except BrokenPipeError:  # the reader of a pipe, such as head, has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except (SurrogateError, OSError) as error:
        _stop(error, 1)
    except Exception as error:  # a mistake of ours, not of the user
        log = Path("leg-bandage-error.log").absolute()
        log.write_text(traceback.format_exc(), encoding="utf-8")
        _stop(f"internal error: {type(error).__name__}: {error}\nPlease report it with {log}", 1)


def _stop(why: object, status: int) -> None:
    print(why, file=sys.stderr)
    sys.exit(status)
