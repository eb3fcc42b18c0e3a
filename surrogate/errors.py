"""Exceptions, on one page.

::

    SurrogateError
     |-- StudyError         the study file, or an argument, is wrong: lists every mistake
     |-- PluginError        a named plug-in is unknown or fails to load
     |-- SolverError        a solver has no answer for this point, and says why
     |-- DesignError        a design cannot be built as asked
     |-- FitError           a surrogate cannot be fitted to these runs
     `-- ResultsError       stored results are missing, damaged or of another study

A solver raises `SolverError`; the study turns it into a failed run. Everything
else in this tree ends a command with one sentence per mistake and no traceback.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

#: Keys and indices that lead to a part of a study.
KeyPath = tuple[str | int, ...]


@dataclass(frozen=True)
class Mistake:
    """A sentence about the part of a study at `path` (about its key when `on_key`)."""

    path: KeyPath
    sentence: str
    on_key: bool = False


class SurrogateError(Exception):
    """Root of all errors that this package raises on purpose."""


class StudyError(SurrogateError):
    """One or more mistakes in a study; `mistakes` holds a sentence each.

    A `Mistake` in place of a sentence tells where it stands, below the part that was being
    read: a solver's constructor tells by it in which of its options.
    """

    def __init__(self, *mistakes: str | Mistake):
        self.placed = tuple(m if isinstance(m, Mistake) else Mistake((), m) for m in mistakes)
        self.mistakes = tuple(mistake.sentence for mistake in self.placed)
        super().__init__("\n".join(self.mistakes))


class PluginError(SurrogateError):
    """A plug-in name that is unknown, or whose module does not load."""


class SolverError(SurrogateError):
    """A point for which the solver has no answer; the message says why."""


class DesignError(SurrogateError):
    """A design that cannot be built with these options in this space."""


class FitError(SurrogateError):
    """A surrogate that cannot be fitted to these runs."""


class ResultsError(SurrogateError):
    """Stored results that are missing, damaged, or belong to another study."""


def nearest(word: str, allowed: Iterable[str]) -> str:
    """Sentence part that names what is allowed, with the closest spelling first.

    >>> nearest("tensoin", ["tension", "mu_skin"])
    "did you mean 'tension'? Allowed: mu_skin, tension"
    """
    names = sorted(map(str, allowed))
    listing = f"Allowed: {', '.join(names)}" if names else "Nothing is allowed here"
    close = difflib.get_close_matches(str(word), names, n=1)
    return f"did you mean '{close[0]}'? {listing}" if close else listing
