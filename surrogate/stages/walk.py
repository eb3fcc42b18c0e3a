"""The walk through the stages: each result is taken from where it is kept, or made.

Results are asked for from behind: a file that is missing or out of date asks for its stage,
which asks for the stages that it needs. What nothing asks for is not even read.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from surrogate.counting import Reached
from surrogate.stages import kept, written
from surrogate.stages.digest import digest, environment
from surrogate.stages.labour import carry_out
from surrogate.stages.stage import Given, Job, Part, Result, Stage, Step
from surrogate.stages.table import STAGES

#: What the walk itself knows of all stages, and a stage at the end may need: what could not be
#: done, the figures for summary.json, and the digest of what they were made from.
NOT_DONE, FIGURES, STAMP = "not_done", "figures", "stamp"
OF_ALL = {NOT_DONE, FIGURES, STAMP}


@dataclass
class Walk:
    """The stages of one study, with what is known of them so far.

    parts     parts of the study, by the names that the stages read
    given     results to start from: "runs", "cases"
    folder    results folder of the study
    workers   processes for jobs that can be done side by side
    progress  told of each `Step`
    """

    parts: Mapping[str, Part]
    given: Mapping[str, Given]
    folder: Path
    workers: int = 1
    progress: Callable[[Step], None] = lambda step: None
    stages: tuple[Stage, ...] = STAGES
    _results: dict[str, Result] = field(default_factory=dict)
    _digests: dict[str, str] = field(default_factory=dict)

    def value(self, name: str) -> Any:
        """What the stage of this name gives."""
        return self.result(name).value

    def result(self, name: str) -> Result:
        """What the stage gives, and what could not be done: given, kept, or made now."""
        if name in self.given:
            return self.given[name].result
        if name not in self._results:
            stage = next(stage for stage in self.stages if stage.name == name)
            with threadpool_limits(1):
                self._results[name] = self._of_jobs(stage) if stage.jobs else self._whole(stage)
        return self._results[name]

    def write(self, again: Iterable[str] = ()) -> bool:
        """Write every file that is missing, damaged or out of date; True when there were some.

        again: names of stages whose files are written in any case.
        """
        manifest, fresh, again = written.read(self.folder), False, set(again)
        for stage in self.stages:
            made_from = self.digest(stage.name) if stage.files else ""
            sound = written.sound(self.folder, manifest.get(stage.name), made_from)
            if stage.files is None or (sound and stage.name not in again):
                continue
            contents = stage.files.contents(self.value(stage.name))
            manifest[stage.name] = written.write(self.folder, stage.files, contents, made_from)
            written.record(self.folder, manifest)
            fresh = True
        if fresh:
            self._forget()
        return fresh

    def is_up_to_date(self, name: str) -> bool:
        """True when the files of a stage are there, whole, and made from what is known now."""
        entry = written.read(self.folder).get(name)
        return written.sound(self.folder, entry, self.digest(name))

    def _forget(self) -> None:
        """Delete what is kept of jobs that the study no longer asks for."""
        for stage in self.stages:
            if stage.jobs is not None and stage.name in self._results:
                labels = [job.label for job in self._jobs(stage)]
                paths = {kept.path_of(self.folder, stage.name, label) for label in labels}
                kept.forget(self.folder, stage.name, paths)

    def digest(self, name: str) -> str:
        """Digest of all that the stage's result is made from."""
        if name in self.given:
            return self.given[name].digest
        if name not in self._digests:
            self._digests[name] = self._digest(name)
        return self._digests[name]

    def _digest(self, name: str) -> str:
        if name in OF_ALL:
            before = [stage for stage in self.stages if not OF_ALL & set(stage.needs)]
            return digest(*map(self.digest, (*self.given, *(stage.name for stage in before))))
        stage = next(stage for stage in self.stages if stage.name == name)
        if stage.each is not None:
            jobs = self._jobs(stage)
            return digest(stage.name, [(job.label, self._job_digest(stage, job)) for job in jobs])
        words = [self.parts[part].words for part in stage.reads]
        return digest(environment(), stage.name, words, [self.digest(one) for one in stage.needs])

    def _job_digest(self, stage: Stage, job: Job) -> str:
        if stage.each is None:
            return digest(self.digest(stage.name), job.label)
        words = [self.parts[part].words for part in stage.each]
        return digest(environment(), stage.name, job.label, words, job.made_from)

    def _arguments(self, stage: Stage) -> dict[str, Any]:
        parts = {part: self.parts[part].value for part in stage.reads}
        return parts | {need: self._needed(need) for need in stage.needs}

    def _needed(self, name: str) -> Any:
        if name == STAMP:
            return self.digest(STAMP)
        if name == FIGURES:
            return {s.name: s.figures(self.value(s.name)) for s in self.stages if s.figures}
        return self.not_done if name == NOT_DONE else self.value(name)

    @property
    def not_done(self) -> list[str]:
        """A sentence for each thing that was asked for and could not be had."""
        able = [stage.name for stage in self.stages if stage.jobs is not None]
        return [s for name in (*able, *self.given) for s in self.result(name).not_done]

    def _whole(self, stage: Stage) -> Result:
        """A stage that is done in one piece."""
        path, made_from = kept.path_of(self.folder, stage.name), self.digest(stage.name)
        found = kept.load(path, made_from) if stage.kept else None
        if found is None:
            arguments = self._arguments(stage)
            self.progress(Step(stage.name))
            found = Result(stage.does(**arguments))
            if stage.kept:
                kept.save(path, made_from, found)
            self.progress(Step(stage.name, done=1))
        return found

    def _jobs(self, stage: Stage) -> list[Job]:
        assert stage.jobs is not None
        return stage.jobs(**self._arguments(stage))

    def _of_jobs(self, stage: Stage) -> Result:
        """A stage of several jobs: those that are not kept are done, and kept one by one."""
        jobs = self._jobs(stage)
        made_from = {job.label: self._job_digest(stage, job) for job in jobs}
        paths = {job.label: kept.path_of(self.folder, stage.name, job.label) for job in jobs}
        found = {job.label: kept.load(paths[job.label], made_from[job.label]) for job in jobs}
        left = [job for job in jobs if found[job.label] is None]
        for job, result in self._carried_out(stage.name, left):
            found[job.label] = result
            kept.save(paths[job.label], made_from[job.label], result)
        gathered: Result = stage.does([(job, found[job.label]) for job in jobs])
        return gathered

    def _carried_out(self, name: str, jobs: list[Job]) -> Iterator[tuple[Job, Result]]:
        """Each job with its result; says which one it waits for, and how far that is."""
        start = time.monotonic()
        done: list[Job] = []

        def hear(reached: Reached) -> None:
            k, total = len(done), len(jobs)
            share = k + reached.share
            left = (time.monotonic() - start) / share * (total - share) if share else None
            self.progress(Step(name, jobs[k].label, k, total, left, reached.text))

        going = carry_out(jobs, self.workers, hear)
        for job in jobs:
            hear(Reached("", 0.0))
            yield next(going)
            done.append(job)
        self.progress(Step(name, done=len(jobs), total=len(jobs)))
