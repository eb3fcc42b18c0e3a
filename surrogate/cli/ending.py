"""How the command ends: with an exit status and sentences, never with a traceback."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from surrogate.errors import DesignError, PluginError, StudyError, SurrogateError


def carried_out(command: Callable[[], None]) -> None:
    """Call `command`; what goes wrong in it becomes a sentence and an exit status."""
    try:
        try:
            command()
        finally:
            sys.stdout.flush()
    except (StudyError, DesignError, PluginError) as error:
        stop(error, 2)
    except SurrogateError as error:
        stop(error, 1)
    except BrokenPipeError:  # whoever read our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        sys.exit(1)
    except OSError as error:
        stop(_refused(error), 1)
    except Exception as error:  # a mistake of ours, not of the user
        log = Path("surrogate-error.log").absolute()
        with suppress(OSError):
            log.write_text(traceback.format_exc(), encoding="utf-8")
        stop(
            f"internal error: {type(error).__name__}: {error}\nFinished runs are kept. "
            f"Please report it with {log}",
            1,
        )


def stop(why: object, status: int) -> NoReturn:
    """End with a sentence, or with mistakes of a study, each whole on its line as editors read."""
    print(why, file=sys.stderr)
    sys.exit(status)


def _refused(error: OSError) -> str:
    """What the system refused: a file or folder, or, without a name, the output."""
    if error.filename is None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what still waits has nowhere to go
        return f"the output cannot be written: {error.strerror or error}"
    return (
        f"{os.fsdecode(error.filename)}: {error.strerror or error}; make room or choose another "
        "folder with --results, then do it again. Finished runs are kept"
    )
