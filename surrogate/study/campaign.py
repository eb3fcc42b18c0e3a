"""A study that is driven from outside: ask for points, tell their answers.

::

    with surrogate.Campaign("hardness.yaml") as campaign:
        for point in campaign.ask(4):
            campaign.tell(point, {"hardness": measure(**point.inputs)})

A laboratory, a queue of jobs or somebody else's optimiser does the runs. Answers go into the
study's journal under the identities that `surrogate run` uses, so that `status`, `report` and
all that follows see them, and nothing told is lost whenever the program ends.
"""

from __future__ import annotations

import time
import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.card import Card, Carded
from surrogate.errors import StudyError, nearest
from surrogate.execution.answers import accepted
from surrogate.execution.shared.claims import Presence, SharedFolder, at_work
from surrogate.execution.shared.work import own_name
from surrogate.runs.identity import RunInputs
from surrogate.runs.journal import Journal, JournalContents
from surrogate.runs.record import Record
from surrogate.runs.stored import KnownRuns
from surrogate.study.asked_runs import AskedRuns
from surrogate.study.growing import Growing
from surrogate.study.study import Study

#: How the names of campaigns begin, among those of the workers that share a folder.
CAMPAIGN = "campaign-"

#: Inputs that differ by less than this share of the designs' largest value are one input.
SAME = 1e-9


@dataclass(frozen=True)
class Point:
    """A run that the study asks for.

    key     its identity: tells the run from all others, also in a file or another process
    design  the (first) design that it belongs to
    inputs  a value for every input of the solver, in the solver's units
    """

    key: str
    design: str
    inputs: Mapping[str, float | str]


class Campaign(Carded):
    """The study's runs, handed out by `ask` and answered by `tell`.

    study    a `Study`, or the path of its file
    results  the study's results folder, as in `Study.run`

    It holds the lock of the journal until `close` (or the end of `with`, or of the process,
    however it ends): a second writer gets a sentence, readers may read. Raises `StudyError`
    for a study with mistakes, `ResultsError` when the folder is in use or takes no files.
    """

    def __init__(self, study: Study | str | Path, *, results: Path | str | None = None):
        self.study = study if isinstance(study, Study) else Study.from_yaml(study)
        folder = None if results is None else Path(results)
        self._runs = self.study.found(folder).asked(folder)
        self._wanted = self.study.spec.wanted(self.study.outputs)
        self._runs.keep()
        self._journal = Journal(self._runs.journal).__enter__()
        self._end = weakref.finalize(self, self._journal.__exit__, None, None, None)
        self._shared, self._name = SharedFolder(self._runs.journal), CAMPAIGN + own_name()
        self._seen = self._shared.segment_lengths()
        self._points = _points(self._runs)
        self._open = dict(self._points)
        self._drop_done(self._journal.contents)
        self._growing = Growing(self._runs) if self.study.rules else None
        self._handed_out: set[str] = set()
        self._presence: Presence | None = None

    @property
    def _card(self) -> Card:
        points, out = len(self._points), len(self._handed_out & self._open.keys())
        facts = {
            "points": points,
            "answered": points - self.left,
            "handed out": out,
            "left": self.left,
            "results": str(self._runs.folder),
        }
        return Card("Campaign", self.study.name, facts)

    def __enter__(self) -> Campaign:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Give the folder free; what was told is kept, what was handed out is asked for again."""
        if self._presence is not None:
            self._presence.end()
            self._presence = None
        self._end()

    @property
    def left(self) -> int:
        """Number of points that have no answer yet, those handed out included.

        Of adaptive designs also those that may still be chosen, at most.
        """
        self._look_around()
        return len(self._open) + (self._growing.ahead if self._growing else 0)

    def ask(self, n: int = 1) -> list[Point]:
        """The next `n` points without an answer, in the order of the designs; fewer at the end.

        An adaptive design chooses points when no others are left: from the answers so far, each
        one counting those that are handed out as answered by what is predicted. With `batch` it
        waits until all have an answer.
        This campaign hands out no point twice, and none that a `surrogate work` on the folder
        has done or is at. After a restart, points that were handed out and have no answer are
        handed out again.
        """
        if n < 1:
            raise StudyError(f"n: {n} must be 1 or more")
        self._look_around()
        self._grow(n)
        waiting = (one for key, one in self._open.items() if key not in self._handed_out)
        busy = set(at_work(self._runs.journal, self.study.shared.lease)) - {self._name}
        if busy:
            waiting = (one for one in waiting if self._claim(one.key, busy))
        points = list(islice(waiting, n))
        self._handed_out.update(point.key for point in points)
        return points

    def _grow(self, n: int) -> None:
        """Let adaptive designs choose points, when fewer than `n` wait to be handed out."""
        free = n - len(self._open.keys() - self._handed_out)
        if self._growing is None or free <= 0:
            return
        known = KnownRuns(self._shared.contents(), self._runs.given, self._wanted)
        added = self._growing.more(known.ended, free)
        if added:
            self._runs = self._growing.asked
            self._points = _points(self._runs)
            self._open |= {key: self._points[key] for key in added}
            self._drop_done(known.journal)

    def _claim(self, key: str, busy: set[str]) -> bool:
        """True when this campaign has the point from now on; busy: workers at work.

        Claims of other campaigns are void: the lock of the journal says that they are over.
        """
        generation, owner = self._shared.last_claim(key)
        if owner in busy and not str(owner).startswith(CAMPAIGN):
            return False
        self._presence = self._presence or Presence(
            self._shared, self._name, self.study.shared.lease
        )
        return self._shared.claim(key, generation + 1, self._name)

    def _look_around(self) -> None:
        """Take over what workers that share the folder have finished since."""
        lengths = self._shared.segment_lengths()
        if lengths != self._seen:
            self._seen = lengths
            self._drop_done(self._shared.contents())

    def _drop_done(self, journal: JournalContents) -> None:
        known = KnownRuns(journal, self._runs.given, self._wanted).records
        for key, record in known.items():
            if record.answers(self._wanted) and not record.lost:
                self._open.pop(key, None)

    def tell(
        self,
        points: Point | str | Mapping[str, Any] | Sequence[Point | str | Mapping[str, Any]],
        outputs: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        *,
        failed: str | None = None,
        seconds: float = 0.0,
    ) -> None:
        """Write down the answers of a point, or of a list of points, in any order.

        points   what `ask` gave, their keys, or mappings of input names to values in the
                 solver's units; nobody need have asked for them, but they lie in a design
        outputs  output name -> value, in the solver's units; a list of these for a list
        failed   in place of outputs: why there is no answer
        seconds  how long a point took, for the runs dataset

        The last answer of a point counts. What is told is on the disk when the call returns.
        Raises `StudyError` with all mistakes, and then nothing is written down; `ResultsError`
        when the disk takes no more.
        """
        several = not isinstance(points, Point | str | Mapping)
        given: list[Any] = [points] if isinstance(points, Point | str | Mapping) else list(points)
        answers = self._answers(given, outputs, failed, several)
        mistakes: list[str] = []
        told: dict[str, tuple[Record, dict[str, NDArray[np.float64]]]] = {}
        for number, (one, answer) in enumerate(zip(given, answers, strict=True), start=1):
            try:
                point = self._found(one, told)
                told[point.key] = self._record(point, answer, failed, seconds)
            except StudyError as error:
                where = f"point {number}: " if several else ""
                mistakes += [where + sentence for sentence in error.mistakes]
        if mistakes:
            raise StudyError(*mistakes)
        for record, fields in told.values():
            self._journal.append(record, fields)
            self._open.pop(record.key, None)
        self._journal.sync(now=True)

    def runs(self) -> xr.Dataset:
        """The runs dataset as far as answers go; the rest is 'missing'."""
        return self._runs.dataset()

    def _answers(
        self, given: Sequence[Any], outputs: Any, failed: str | None, several: bool
    ) -> list[Any]:
        """The outputs of each point; None for each that failed."""
        if (outputs is None) == (failed is None):
            raise StudyError("give either outputs or failed='why there is no answer'")
        if failed is not None:
            if not failed.strip():
                raise StudyError("failed: is empty; say why there is no answer")
            return [None] * len(given)
        if not several:
            return [outputs]
        if isinstance(outputs, Mapping) or len(outputs) != len(given):
            count = "one mapping" if isinstance(outputs, Mapping) else f"{len(outputs)}"
            raise StudyError(
                f"outputs: {count} for {len(given)} points; give a list with a mapping for each"
            )
        return list(outputs)

    def _record(
        self, point: Point, answer: Any, failed: str | None, seconds: float
    ) -> tuple[Record, dict[str, NDArray[np.float64]]]:
        """What the journal keeps of an answer; raises `StudyError` when it cannot be used."""
        scalars: dict[str, float] = {}
        fields: dict[str, NDArray[np.float64]] = {}
        if failed is None:
            offered = self.study.spec.solver.outputs
            names = answer if isinstance(answer, Mapping) else ()
            unknown = [name for name in names if name not in offered]
            if unknown:
                raise StudyError(
                    *(f"there is no output '{n}'; {nearest(n, offered)}" for n in unknown)
                )
            try:
                scalars, fields = accepted(answer, self._wanted)
            except ValueError as error:
                raise StudyError(str(error)) from None
        spec = self.study.spec
        record = Record(
            point.key,
            dict(point.inputs),
            "ok" if failed is None else "failed",
            failed or "",
            seconds,
            1,
            time.time(),
            outputs=scalars,
            solver=spec.described,
        )
        return record, fields

    def _found(self, one: Any, taken: Mapping[str, Any]) -> Point:
        """The study's own point for what is told; taken: keys that this call has told already."""
        key = one.key if isinstance(one, Point) else one
        if not isinstance(key, str):
            key = self._key_at(one, taken)
        if key not in self._points:
            raise StudyError(
                f"'{key}' is the key of no point of this study as it is now; ask again"
            )
        if key in taken:
            raise StudyError(f"{_said(self._points[key].inputs)} is told twice in one call")
        return self._points[key]

    def _key_at(self, values: Mapping[str, Any], taken: Mapping[str, Any]) -> str:
        """Key of the point with these inputs; of replicates the first without an answer."""
        mistakes = list(self._input_mistakes(values))
        if mistakes:
            raise StudyError(*mistakes)
        hits = np.ones(len(self._runs.keys), dtype=bool)
        for name, column in self._runs.columns.items():
            hits &= _same(column, values[name])
        found = list(dict.fromkeys(self._runs.keys[row] for row in np.flatnonzero(hits)))
        if not found:
            raise StudyError(
                f"{_said(values)} lies in no design of the study; tell the points that ask() "
                "gave, or add this one to a design {method: csv}"
            )
        waiting = [key for key in found if key in self._open and key not in taken]
        if not waiting and len(found) > 1:
            raise StudyError(
                f"{_said(values)} has {len(found)} replicates, all of which have an answer; "
                "tell the key of the one to correct"
            )
        return waiting[0] if waiting else found[0]

    def _input_mistakes(self, values: Mapping[str, Any]) -> Iterator[str]:
        """What is wrong with the inputs of a point, before it is looked for."""
        inputs = self.study.spec.solver.inputs
        fixed = self._runs.calls[0] if self._runs.calls else RunInputs()
        for name in values:
            if name not in inputs:
                yield f"the solver has no input '{name}'; {nearest(name, inputs)}"
        for name in self._runs.columns:
            if name not in values:
                yield f"there is no value for '{name}'; give one for each parameter"
        for name, value in values.items():
            if name not in inputs:
                continue
            if not inputs[name].levels and not _is_number(value):
                yield f"{name}: {value!r} is not a number; give it in {inputs[name].unit or '1'}"
            elif name not in self._runs.columns and not _same(np.array([fixed[name]]), value).all():
                yield f"{name}: {value} was told, but this study holds it at {fixed[name]}"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _same(column: NDArray[Any], value: Any) -> NDArray[np.bool_]:
    """Which of the values of an input are this one."""
    if column.dtype.kind in "US":
        return np.asarray(column == str(value))
    return np.asarray(np.abs(column - float(value)) <= SAME * np.abs(column).max())


def _points(runs: AskedRuns) -> dict[str, Point]:
    """Every point of every design by its key; equal points of deterministic solvers once."""
    names = np.repeat(list(runs.designs), [len(coded) for coded in runs.points.values()])
    found: dict[str, Point] = {}
    for key, design, call in zip(runs.keys, names, runs.calls, strict=True):
        inputs = {name: call[name] for name in runs.spec.solver.inputs}
        found.setdefault(key, Point(key, str(design), inputs))
    return found


def _said(inputs: Mapping[str, Any]) -> str:
    """A point in a few words."""
    values = [f"{k}={v:g}" if _is_number(v) else f"{k}={v}" for k, v in inputs.items()]
    return ", ".join([*values[:8], *["..."] * (len(values) > 8)])
