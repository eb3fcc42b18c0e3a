"""The runs that a study asks for: which are there in a results folder, and how to do the rest."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.adaptive.aim import Rule
from surrogate.adaptive.kept import State
from surrogate.adaptive.outcome import ATTRIBUTE, Outcome, outcome, outcome_data
from surrogate.designs.design import Design
from surrogate.errors import ResultsError, StudyError
from surrogate.execution.backend import Start
from surrogate.execution.execute import execute
from surrogate.execution.fresh import execute_fresh
from surrogate.execution.growth import Growth
from surrogate.execution.progress import Progress
from surrogate.execution.shared.claims import at_work
from surrogate.execution.shared.work import Shared, work
from surrogate.runs import stored as storing
from surrogate.runs.assembly import assemble, physical_columns
from surrogate.runs.compaction import JOURNAL, compacted
from surrogate.runs.dataset import LEVEL
from surrogate.runs.identity import RunInputs, SolverSpec, canonical, keys, run_inputs
from surrogate.runs.journal import Journal, JournalContents
from surrogate.runs.journal import digest as journal_digest
from surrogate.runs.journal import read as read_journal
from surrogate.runs.levels import LevelsSpec
from surrogate.runs.stored import KnownRuns, StoredMatches, StoredRuns
from surrogate.space.space import Space
from surrogate.stages import written
from surrogate.study.grown_designs import kept, states
from surrogate.study.kept_designs import RUNS, keep, recall
from surrogate.study.parts.execution import ExecutionPart

#: Random points among those that stand for points not found yet.
SOME = 100


@dataclass(frozen=True, eq=False)
class AskedRuns:
    """Every point of every design, as runs of the solver, with what `folder` holds of them.

    folder   results folder of the study
    designs  with those points that were found by search before, see `kept_designs`
    rules    of adaptive designs, by name
    text     the study as written, for the runs dataset
    notes    what was guessed of the study's data and what was left out
    """

    folder: Path
    spec: SolverSpec
    space: Space
    constants: Mapping[str, float | str]
    outputs: tuple[str, ...]
    designs: Mapping[str, Design]
    stored_runs: tuple[StoredRuns, ...]
    text: str
    notes: tuple[str, ...] = ()
    rules: Mapping[str, Rule] = field(default_factory=dict)

    def recalled(self) -> AskedRuns:
        """The same with the points that were found before: a design does not move once begun."""
        if all(design.at_hand for design in self.designs.values()):
            return self.grown()
        stored = [file.runs for file in self.stored_runs]
        found = recall(self.designs, self.folder, stored, self.spec.solver)
        return replace(self, designs=found).grown()

    @property
    def states(self) -> dict[str, State]:
        """What each adaptive design has chosen and found, as the folder holds it now."""
        if not self.rules:
            return {}
        stored = [file.runs for file in self.stored_runs]
        return states(self.rules, self.designs, self.folder, stored)

    @property
    def outcomes(self) -> dict[str, Outcome]:
        """How far each adaptive design is."""
        return {
            name: outcome(
                self.rules[name], self.designs[name].rows - self.designs[name].chosen, state
            )
            for name, state in self.states.items()
        }

    def grown(self) -> AskedRuns:
        """The same with the points that adaptive designs have chosen since."""
        new = {
            name: self.designs[name].with_chosen(state.points, state.levels)
            for name, state in self.states.items()
            if len(state.points) != self.designs[name].chosen
        }
        return replace(self, designs={**self.designs, **new}) if new else self

    def of_designs(self, names: Iterable[str]) -> AskedRuns:
        """The runs of some designs alone."""
        some = set(names)
        designs = {name: design for name, design in self.designs.items() if name in some}
        rules = {name: rule for name, rule in self.rules.items() if name in some}
        return replace(self, designs=designs, rules=rules)

    @property
    def at_hand(self) -> AskedRuns:
        """The same without the points of designs that would have to be searched for."""
        return self._with(np.empty((0, self.space.size)))

    def _with(self, points: NDArray[np.float64]) -> AskedRuns:
        """The same with these points for each design that would have to be searched for."""
        if all(design.at_hand for design in self.designs.values()):
            return self
        designs = {
            name: design if design.at_hand else _imagined_design(design, points)
            for name, design in self.designs.items()
        }
        return replace(self, designs=designs)

    @property
    def waiting(self) -> int:
        """Runs whose points are not found yet, of adaptive designs at most: none is done."""
        sought = sum(design.rows for design in self.designs.values() if not design.at_hand)
        return sought + sum(one.ahead for one in self.outcomes.values())

    @property
    def journal(self) -> Path:
        """Where finished runs are written down."""
        return self.folder / "journal"

    @property
    def points(self) -> dict[str, np.ndarray]:
        """Coded points (run, parameter) of each design."""
        return {name: design.coded for name, design in self.designs.items()}

    @property
    def levels(self) -> list[str]:
        """Level of fidelity of each row, the truth but for nested designs; [] without levels."""
        if not isinstance(self.spec, LevelsSpec):
            return []
        return [
            level
            for design in self.designs.values()
            for level in design.levels or [self.spec.truth] * len(design.coded)
        ]

    @cached_property
    def columns(self) -> dict[str, NDArray[Any]]:
        """Inputs that vary, name -> (run,), in physical values."""
        columns = physical_columns(self.space, self.points)
        leveled = isinstance(self.spec, LevelsSpec)
        return {**columns, LEVEL: np.array(self.levels, dtype=str)} if leveled else columns

    @cached_property
    def calls(self) -> list[RunInputs]:
        """What the solver is called with, for each row of the runs dataset."""
        return run_inputs(self.spec, self.columns, self.constants)

    @cached_property
    def keys(self) -> list[str]:
        """The identity of each of these runs."""
        return keys(self.spec, self.calls)

    @cached_property
    def given(self) -> StoredMatches:
        """The runs that the study's stored files hold."""
        return self.matching(self.stored_runs)

    def matching(self, files: Iterable[StoredRuns]) -> StoredMatches:
        """The runs that some files hold."""
        wanted = self.spec.wanted(self.outputs)
        return storing.match(files, self.spec, self.calls, self.keys, wanted)

    def unused(self) -> Iterator[tuple[int, str]]:
        """Number and a sentence of each stored file that holds none of the runs.

        Points that are not found yet may be any of the space, those of the file included.
        """
        for index, file in enumerate(self.stored_runs):
            asked = self._with(_imagined(self.space, file))
            if not asked.matching([file]).records:
                why = storing.first_difference(file, self.spec, asked.calls, self.outputs)
                yield index, f"no run in '{file.name}' is one of this study's: {why}"

    def dataset(self, journal: JournalContents | None = None) -> xr.Dataset:
        """The runs dataset as far as journal and stored files go; the rest is 'missing'.

        journal: what it holds, where that is at hand. Attributes of the dataset: `stored` tells
        how many runs came from which stored file, `damaged` has a sentence for each damaged
        record of the journal.
        """
        return self._found(journal, values=True)

    def history(self) -> xr.Dataset:
        """The same without the outputs: how each run ended."""
        return self._found(None, values=False)

    def _found(self, journal: JournalContents | None, values: bool) -> xr.Dataset:
        if journal is None:
            kept = self._compacted(values)
            if kept is not None:
                return kept
            journal = read_journal(self.journal)
        return self._assembled(journal, self.given, self.keys, values)

    def _compacted(self, values: bool) -> xr.Dataset | None:
        """From runs.nc, when it is as it was written and the journal has not changed since."""
        if self.stored_runs or not written.intact(self.folder, RUNS):
            return None
        rows = sum(len(coded) for coded in self.points.values())
        nothing = JournalContents({}, self.journal)
        asked = self._assembled(nothing, StoredMatches(), [""] * rows, values=False)
        asked = asked.assign_attrs({JOURNAL: journal_digest(self.journal)})
        wanted = self.spec.wanted(self.outputs)
        return compacted(self.folder / RUNS, asked, wanted, values=values)

    def _assembled(
        self, journal: JournalContents, given: StoredMatches, run_keys: list[str], values: bool
    ) -> xr.Dataset:
        known = KnownRuns(journal, given, self.spec.wanted(self.outputs))
        runs = assemble(
            self.space,
            self.points,
            self.spec,
            known,
            constants=self.constants,
            outputs=self.outputs,
            study=self.text,
            seeds={
                name: design.options["seed"]
                for name, design in self.designs.items()
                if "seed" in design.options
            },
            run_keys=run_keys,
            values=values,
            levels=self.levels,
        )
        return runs.assign_attrs(
            {JOURNAL: journal.digest},
            stored=canonical(known.origins(run_keys)),
            damaged=canonical(journal.told),
            **({"notes": "\n".join(self.notes)} if self.notes else {}),
            **self._told,
        )

    @property
    def _told(self) -> dict[str, str]:
        """Attributes that tell of adaptive designs."""
        found = {name: outcome_data(one) for name, one in self.outcomes.items()}
        return {ATTRIBUTE: canonical(found)} if found else {}

    def do(
        self,
        execution: ExecutionPart,
        *,
        workers: int | None,
        executor: Executor | Start | Shared | None,
        rerun: tuple[str, ...],
        fresh: bool,
        progress: Callable[[Progress], None] | None,
        tell: Callable[[str], None],
        growth: Growth | None = None,
    ) -> JournalContents:
        """Do the runs that neither journal, nor neighbours, nor stored files have.

        fresh: all of them, taking nothing over but the rows of a table. tell: hears a sentence
        of each damaged record. growth: adds runs of adaptive designs. The other words are
        those of `execute`. Of a solver whose answers are told none is done; raises
        `StudyError` for `fresh` then. A table in place of a solver has all runs that it can
        have. Returns what the journal holds then.
        """
        if self.spec.recorded:
            return read_journal(self.journal)
        if self.spec.told:
            if fresh:
                raise StudyError(
                    f"the answers of {self.spec.name} are told, so no run can be done afresh; "
                    "change its version to ask for all of them again"
                )
            return read_journal(self.journal)
        self.keep()
        how: dict[str, Any] = {
            "constants": self.constants,
            "outputs": self.outputs,
            "workers": workers or execution.at_once,
            "timeout": execution.timeout,
            "memory": execution.memory,
            "retries": execution.retries,
            "progress": progress,
            "rerun": rerun,
        }
        taken: dict[str, Any] = {"others": self._neighbours(), "given": self.given}
        if isinstance(executor, Shared):
            if fresh:
                raise StudyError("--fresh is for one worker; choose executor: local for it")
            how |= {"growth": growth, "lease": executor.lease}
            work(self.spec, self.columns, journal=self.journal, **how, **taken)
            return read_journal(self.journal)
        busy = at_work(self.journal)
        if busy:
            raise ResultsError(
                f"{len(busy)} workers share {self.folder} ({', '.join(busy[:3])}); join them with "
                "`surrogate work`, or wait until they are done"
            )
        with Journal(self.journal) as book:
            for sentence in book.contents.told:
                tell(sentence)
            if fresh:
                tables = self.matching(file for file in self.stored_runs if file.tabulated)
                execute_fresh(self.spec, self.columns, book, **how, given=tables, executor=executor)
            if growth or not fresh:
                how |= {"growth": growth, "executor": executor}
                execute(self.spec, self.columns, journal=book, **how, **taken)
            return book.now

    def keep(self) -> None:
        """Write the points of searches and of adaptive designs into the folder, once."""
        keep(self.designs, self.folder)
        for name, state in self.states.items():
            kept(self.folder, self.rules[name]).write(len(self.designs[name].initial), state)

    def _neighbours(self) -> list[Path]:
        """Journals of other studies beside this one's results."""
        own = Path(os.path.realpath(self.journal))  # a loop of links is no error
        return [
            journal for journal in sorted(own.parent.parent.glob("*/journal")) if journal != own
        ]


def _imagined_design(design: Design, points: NDArray[np.float64]) -> Design:
    """The design with these points, at each of its levels of fidelity if it has some."""
    names = list(dict.fromkeys(design.levels))
    if not names:
        return design.with_points(points)
    options = {**design.options, "runs": dict.fromkeys(names, len(points))}
    return replace(design, options=options).with_points(np.tile(points, (len(names), 1)))


def _imagined(space: Space, file: StoredRuns) -> NDArray[np.float64]:
    """Random coded points (run, parameter), then those of a stored file that lie in the space."""
    some = space.sample(SOME, seed=0)
    known = [
        call
        for call in file.run_inputs
        if all(
            call.get(p.name) in p.levels if p.categorical else isinstance(call.get(p.name), float)
            for p in space.parameters
        )
    ]
    if not known:
        return some
    coded = space.encode({name: np.array([call[name] for call in known]) for name in space.names})
    return np.vstack([some, coded[space.contains(coded)]])
