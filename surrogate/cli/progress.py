"""The progress bar of a study's runs, on the terminal's error stream."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
)
from rich.table import Column
from rich.text import Text

from surrogate.execution.progress import Progress as Tally
from surrogate.stages.stage import Step
from surrogate.stages.table import STAGES

#: Seconds between two lines where there is no terminal.
A_LINE = 60.0


#: Longest name of a study in front of a bar.
NAME = 20
#: A column that is never cut.
_WHOLE = Column(no_wrap=True)


class RunsBar:
    """Shows a `Tally` after each run: a bar on a terminal, else the first, the last and a line a
    minute.

    Use as `with RunsBar(name) as bar: execute(..., progress=bar)`.
    """

    def __init__(
        self, name: str, clock: Callable[[], float] = time.monotonic, *, hidden: bool = False
    ):
        self.console, self.minutes = Console(stderr=True, quiet=hidden), Minutes(clock)
        self.bar = Progress(
            TextColumn(_short(name), markup=False),
            BarColumn(None, table_column=Column(ratio=1)),
            MofNCompleteColumn(table_column=_WHOLE),
            _Note(table_column=_WHOLE),
            console=self.console,
            refresh_per_second=5,
            disable=hidden or not self.console.is_terminal,
            expand=True,
        )
        self.task: TaskID | None = None
        self.finishing = False

    def __enter__(self) -> RunsBar:
        return self

    def __exit__(self, *error: object) -> None:
        self.bar.stop()

    def __call__(self, tally: Tally) -> None:
        """Show how far the runs are."""
        first = self.task is None
        if self.task is None:
            self.task = self.bar.add_task("runs", total=tally.total)
            self.bar.start()
        self.bar.update(self.task, completed=tally.done, tally=tally, at=time.monotonic())
        if tally.finishing is not None and not self.finishing:
            self.finishing = True
            self.bar.console.print(
                f"stopping: {_waited_for(tally.finishing)}; press Ctrl-C again to stop at once",
                highlight=False,
            )
        if self.bar.disable and (self.minutes.due() or first or tally.done == tally.total):
            line = f"{tally.done}/{tally.total} runs {_note(tally)}".rstrip()
            self.console.print(line, highlight=False, markup=False)


class _Note(ProgressColumn):
    """What is behind the bar: the time left goes down between two runs."""

    def render(self, task: Task) -> Text:
        tally: Tally | None = task.fields.get("tally")
        if tally is None:
            return Text()
        return Text(_note(tally, time.monotonic() - task.fields["at"]))


class Minutes:
    """Says when a minute has passed since it said so last, or since it was made."""

    def __init__(self, clock: Callable[[], float]):
        self.clock, self.said = clock, clock()

    def due(self) -> bool:
        """Whether a line may be printed again."""
        if self.clock() - self.said < A_LINE:
            return False
        self.said = self.clock()
        return True


class StagesBar:
    """Shows the `Step` that the analysis is at: a line that changes on a terminal, else a line
    a minute.

    Use as `with StagesBar(name) as bar: analyse(..., steps=bar)`.
    """

    def __init__(
        self, name: str, clock: Callable[[], float] = time.monotonic, *, hidden: bool = False
    ):
        self.console = Console(stderr=True, quiet=hidden)
        self.name, self.minutes = name, Minutes(clock)
        self.bar = Progress(
            SpinnerColumn(),
            TextColumn(_short(name), markup=False),
            TextColumn("{task.fields[stage]}"),
            BarColumn(8),
            TextColumn("{task.description}", markup=False, table_column=Column(ratio=1)),
            TimeElapsedColumn(table_column=_WHOLE),
            console=self.console,
            transient=True,
            expand=True,
            disable=hidden or not self.console.is_terminal,
        )
        self.task: TaskID | None = None
        self.job = ("", "")

    def __enter__(self) -> StagesBar:
        self.bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        self.bar.stop()

    def __call__(self, step: Step) -> None:
        """Show what is done now."""
        text = _said(step)
        if self.task is not None and self.job == (step.stage, step.label):
            self.bar.update(self.task, description=text)
        else:
            if self.task is not None:
                self.bar.remove_task(self.task)
            self.job = (step.stage, step.label)
            self.task = self.bar.add_task(
                text, total=step.total, completed=step.done, stage=_number(step.stage)
            )
        if self.bar.disable and self.minutes.due():
            self.console.print(f"{self.name}: {text}", highlight=False, markup=False)


def _short(name: str) -> str:
    """A name that leaves room for figures beside it."""
    return name if len(name) <= NAME else f"{name[: NAME - 3]}..."


def _number(stage: str) -> str:
    """`stage 3 of 14`, as the table counts."""
    names = [one.name for one in STAGES]
    return f"stage {names.index(stage) + 1} of {len(names)}" if stage in names else ""


def _said(step: Step) -> str:
    """`fits: gp of flow (3 of 8), fold 2 of 10, 12 s left`."""
    stage = step.stage.replace("_", " ")
    if not step.label:
        return stage
    left = f", {duration(step.seconds_left)} left" if step.seconds_left is not None else ""
    part = f", {step.part}" if step.part else ""
    return f"{stage}: {step.label} ({step.done + 1} of {step.total}){part}{left}"


def _waited_for(runs: int) -> str:
    return (
        "the run under way is finished first"
        if runs == 1
        else (f"the {runs} runs under way are finished first")
    )


def _note(tally: Tally, since: float = 0.0) -> str:
    """Runs reused and failed, and the time left; since: seconds from when it was told."""
    parts = [f"{tally.reused} reused"] if tally.reused else []
    parts += [f"{tally.failed} failed"] if tally.failed else []
    if tally.seconds_left is not None and tally.done < tally.total:
        parts.append(f"{duration(max(tally.seconds_left - since, 0.0))} left")
    return ", ".join(parts)


def duration(seconds: float) -> str:
    """Seconds as people say them: 0.8 s, 42 s, 12 min, 3.5 h, 2.1 days."""
    if seconds < 10:
        return f"{seconds:.1f} s"
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * size:
            return f"{seconds / size:.1f} {unit}" if unit != "min" else f"{seconds / size:.0f} min"
    return f"{seconds:.0f} s"
