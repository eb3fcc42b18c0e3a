"""What a stage is: what it reads and needs, what it does, what it writes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Result:
    """What a stage gives.

    value     None when there is nothing: not asked for, or not to be had
    not_done  a sentence for each thing that was asked for and could not be had
    """

    value: Any
    not_done: tuple[str, ...] = ()


@dataclass(frozen=True)
class Job:
    """A part of a stage that depends on no other part: `function(**arguments)`.

    label      what people are shown, unique in its stage
    made_from  digest of what its own result depends on, where `Stage.each` asks for it
    Both function and arguments can be pickled. A `SurrogateError` costs this job only.
    """

    label: str
    function: Callable[..., Any]
    arguments: Mapping[str, Any]
    made_from: str = ""


def by_problem(done: Iterable[tuple[Job, Result]]) -> Result:
    """Answers by the name of the problem of their job, and why others could not be had."""
    found: dict[str, Any] = {}
    lost: list[str] = []
    for job, result in done:
        if result.value is not None:
            found[job.arguments["problem"].name] = result.value
        lost += result.not_done
    return Result(found, tuple(lost))


@dataclass(frozen=True)
class Files:
    """What a stage writes.

    pattern   glob of the files, below the results folder, that are this stage's own
    contents  value -> {path below the results folder: bytes}
    """

    pattern: str
    contents: Callable[[Any], Mapping[str, bytes | memoryview]]


@dataclass(frozen=True)
class Stage:
    """A row of the table.

    name     what it gives, for later stages and in summary.json
    reads    parts of the study that it reads, see `surrogate.study.parts`
    needs    results that it needs, of earlier stages or given ("runs", "cases");
             "not_done" are the sentences of all stages before it
    does     does(**parts, **values) -> value; with `jobs`: does([(job, result), ...]) -> Result
    jobs     jobs(**parts, **values) -> list of jobs that can be done side by side
    each     parts that every job depends on besides what it states itself (`Job.made_from`):
             then a job is done again only when its own inputs changed
    files    what is written, or None
    figures  value -> JSON data for summary.json, or None
    kept     its result is kept as a file, so that it need not be done again
    """

    name: str
    reads: tuple[str, ...]
    needs: tuple[str, ...]
    does: Callable[..., Any]
    jobs: Callable[..., list[Job]] | None = None
    each: tuple[str, ...] | None = None
    files: Files | None = None
    figures: Callable[[Any], Any] | None = None
    kept: bool = True


@dataclass(frozen=True)
class Part:
    """A part of a study: the object, and the words of the file that it follows from."""

    value: Any
    words: Any


@dataclass(frozen=True)
class Given:
    """A result that the walk starts from, and the digest of its content."""

    result: Result
    digest: str


@dataclass(frozen=True)
class Step:
    """What the walk is at: a job of a stage, or (`label` empty) the stage is done.

    done, total   jobs of the stage
    seconds_left  of this stage, None when unknown
    part          of the job, such as "fold 3 of 10"; empty when it has just begun
    """

    stage: str
    label: str = ""
    done: int = 0
    total: int = 1
    seconds_left: float | None = field(default=None)
    part: str = ""
