"""A study, from one YAML file or mapping, and the way from it to its report in Python."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from surrogate.adaptive.outcome import Outcome
from surrogate.errors import StudyError
from surrogate.execution.progress import Progress
from surrogate.execution.rerun import STATUSES
from surrogate.execution.shared.work import Shared
from surrogate.fitting.comparison import best
from surrogate.fitting.fit import Fit
from surrogate.sensitivity.screening import Screening
from surrogate.stages import calibration as calibrating
from surrogate.stages import fits as fitting
from surrogate.stages import report as reporting
from surrogate.stages import sensitivity as analysing
from surrogate.stages.aliasing import aliasing
from surrogate.stages.comparison import comparison
from surrogate.stages.failures import failures
from surrogate.stages.fits import Fits
from surrogate.stages.noise import noise
from surrogate.stages.regression import regression
from surrogate.stages.replicates import replicates
from surrogate.stages.scene import scene
from surrogate.stages.screening import screening
from surrogate.stages.suspicious import suspicious
from surrogate.stages.validation import validation
from surrogate.study import reading
from surrogate.study.asked_runs import AskedRuns
from surrogate.study.growing import Growing
from surrogate.study.reading import fields_of
from surrogate.study.source import Source, read_file, read_text
from surrogate.study.verified_points import kept
from surrogate.validation.cases import Cases, from_runs
from surrogate.validation.validation import fixed_inputs

if TYPE_CHECKING:
    from surrogate.calibration.posterior import Posterior
    from surrogate.report import Page
from surrogate.study.description import Description


@dataclass(frozen=True, repr=False)
class Study(Description):
    """A study: what its file says, its runs, and thin calls of what follows from them.

    Build one by `from_yaml`, `from_text` or `from_mapping`.
    """

    @classmethod
    def from_yaml(cls, path: str | Path) -> Study:
        """The study in a file; raises `StudyError` with every mistake and its place."""
        path = Path(path)
        return cls._of(read_file(path), path.resolve().parent)

    @classmethod
    def from_text(cls, text: str, name: str = "study.yaml") -> Study:
        """The study in YAML `text`; `name` stands for the file in messages."""
        return cls._of(read_text(text, name), None)

    @classmethod
    def from_mapping(cls, data: Mapping[str, Any]) -> Study:
        """The study in the words of a study file, as Python data; `module:object` names a class."""
        return cls._of(Source(data=data), None)

    @classmethod
    def _of(cls, source: Source, folder: Path | None) -> Study:
        """The study that a source describes; modules and files are looked for in `folder`."""
        return cls(**fields_of(source, folder, _reference), source=source)

    def asked(self, results: Path | None = None) -> AskedRuns:
        """The runs that the study asks for, and what a results folder holds of them."""
        folder = results or self.folder
        if folder not in self._asked:
            self._asked[folder] = AskedRuns(
                folder,
                self.spec,
                self.space,
                self.constants,
                self.outputs,
                {**kept(folder, self.space), **self.designs},
                self.stored_runs,
                self.text,
                self.notes,
                self.rules,
            ).recalled()
        self._asked[folder] = self._asked[folder].grown()
        return self._asked[folder]

    @cached_property
    def _asked(self) -> dict[Path, AskedRuns]:
        """What `asked` gave for each folder, so that points and keys are found once."""
        return {}

    def recalled(self, results: Path | None = None) -> Study:
        """The same with the points of its designs that an earlier run found."""
        designs = self.asked(results).designs
        return self if designs is self.designs else replace(self, designs=designs)

    def found(self, results: Path | None = None, *, spread: bool = True) -> Study:
        """The same with the points of its designs, searched for where no earlier run did.

        spread: also of designs of which nothing but the number of points can be wrong.
        Raises `StudyError` for a design that cannot be had or is too small for a surrogate.
        """
        study = self.recalled(results)
        sought = [d for d in study.designs.values() if not d.at_hand and (spread or not d.spread)]
        mistakes = reading.searched(sought)
        if sought and not mistakes:
            mistakes = list(reading.too_small(self.surrogates.values(), study.designs, self.space))
        if mistakes:
            raise StudyError(*reading.sentences(self.source, mistakes))
        return study

    def journal(self, results: Path | None = None) -> Path:
        """Where finished runs are written down."""
        return (results or self.folder) / "journal"

    def stored(self, results: Path | None = None) -> xr.Dataset:
        """The runs dataset as far as the journal and the stored files go; the rest is 'missing'.

        Designs whose points no run has searched for yet have no rows. The attribute `stored`
        tells how many runs came from which stored file, `damaged` has a sentence for each
        damaged record of the journal.
        """
        return self.asked(results).at_hand.dataset()

    def to_find(self, results: Path | None = None) -> list[str]:
        """A sentence for each design that has no rows yet, because no run has searched for it."""
        return [
            f"design {name}: its {one.rows} points are not found yet, and none of its runs is "
            "done; do `surrogate run`"
            for name, one in self.asked(results).designs.items()
            if not one.at_hand
        ]

    def outcomes(self, results: Path | None = None) -> dict[str, Outcome]:
        """How far each adaptive design is, or why it ended."""
        return self.asked(results).outcomes

    def begun(self, results: Path | None = None) -> tuple[xr.Dataset, int]:
        """How the runs ended, and the number of runs of designs that have no rows there.

        It is what `stored` gives without the outputs.
        """
        asked = self.asked(results)
        return asked.at_hand.history(), asked.waiting

    @property
    def unused(self) -> list[str]:
        """A sentence for each stored file that holds no run of this study: what differs first.

        A file that may hold runs of a design without points is left out.
        """
        found = self.asked().unused()
        return [self.source.sentence(("stored", index), sentence) for index, sentence in found]

    def run(
        self,
        *,
        workers: int | None = None,
        results: Path | None = None,
        executor: Executor | Shared | None = None,
        retry_failed: bool | Iterable[str] = False,
        fresh: bool = False,
        only: Iterable[str] | None = None,
        progress: Callable[[Progress], None] | None = None,
        tell: Callable[[str], None] = lambda sentence: None,
    ) -> xr.Dataset:
        """Do the runs that neither the journal nor a stored file has; returns the runs dataset.

        Runs of other studies in the same results folder are taken over where they are the
        same. executor: any concurrent.futures executor in place of the study's, or `Shared` to
        share the runs with other processes through the results folder.
        retry_failed: do failed and timed-out runs again, or some: "timed_out",
        "message~text". fresh: do every run again and take
        nothing over; old records count until all is done, and an interrupted call is resumed
        by repeating it. only: names of the designs whose runs are done, None for all. tell:
        hears a sentence of each damaged record of the journal.
        """
        asked = self.found(results).asked(results)
        now = asked if only is None else asked.of_designs(only)
        journal = now.do(
            self.execution,
            workers=workers,
            executor=executor or reading.starter(self.execution, self._beside),
            rerun=STATUSES if retry_failed is True else tuple(retry_failed or ()),
            fresh=fresh,
            progress=progress,
            tell=tell,
            growth=Growing(now) if now.rules else None,
        )
        return asked.grown().dataset(journal)

    def fit(self, runs: xr.Dataset) -> dict[str, dict[str, Fit]]:
        """Every surrogate fitted to every output: surrogate -> output -> Fit.

        An output that a surrogate cannot be fitted to, because too many runs failed,
        is left out; `unfitted` says why.
        """
        return fitting.all_fits(self.space, self.surrogates, self.outputs, runs)

    def unfitted(self, runs: xr.Dataset, fits: Fits) -> list[str]:
        """A sentence for each surrogate and output without a fit."""
        return list(fitting.unfitted(self.space, self.surrogates, self.outputs, runs, fits))

    def compare(self, fits: Fits, runs: xr.Dataset) -> xr.Dataset | None:
        """All surrogates side by side, on common folds and on the test design if there is one."""
        return comparison(self.outputs, runs, fits)

    def best(self, table: xr.Dataset | None) -> dict[str, str]:
        """Best surrogate of each output, by the comparison."""
        return {} if table is None else best(table)

    def regressions(self, fits: Fits) -> dict[str, dict[str, xr.Dataset]]:
        """Regression tables: surrogate -> output -> dataset, for polynomials of scalars."""
        return regression(self.spec.deterministic, fits)

    def sensitivity(
        self, fits: Fits, runs: xr.Dataset, table: xr.Dataset | None = None
    ) -> xr.Dataset | None:
        """Indices of every output, read from the study's surrogate for sensitivity.

        table: the comparison, when it is at hand. Q2 is that of the test design where
        there is one.
        """
        table = self.compare(fits, runs) if table is None else table
        return analysing.all_indices(
            self.sensitivity_method, self.space, self.outputs, runs, fits, table
        )

    def screening(
        self, fits: Fits, table: xr.Dataset | None, indices: xr.Dataset | None
    ) -> Screening | None:
        """Which parameters to keep; None when the study does not ask or nothing could be read.

        Outputs that vote and could not be fitted are left aside; `unfitted` names them.
        """
        return screening(
            self.screening_rule,
            self.sensitivity_method,
            self.space,
            self.outputs,
            self.nominal,
            fits,
            table,
            indices,
        )

    def beside(self, other: Study, results: Path | None = None) -> Path:
        """Where the results of another study lie, when this one's lie in `results`."""
        return (results or self.folder).parent / other.name

    def cases(self, given: Any = None, *, results: Path | None = None) -> Cases | None:
        """The cases of validation, or those `given`: a file, a runs dataset, a study, `Cases`.

        A study's runs are taken as far as they are stored. Raises `StudyError` for cases
        that are not understood, and when there are none.
        """
        found: Any = given
        if given is None:
            found = self.validation and (self.validation.cases or self.validation.reference)
        elif isinstance(given, str | Path):
            found = reading.cases_at(Path(given), str(given), _reference)
        if found is None:
            return None
        if isinstance(found, Study):
            found = from_runs(found.stored(self.beside(found, results)), found.name)
        elif isinstance(found, xr.Dataset):
            found = from_runs(found, "runs")
        units = {**self.spec.solver.inputs, **self.spec.solver.outputs}
        subject = self.validation.subject if self.validation else None
        cases: Cases = found.in_units(units).by_subject(subject)
        reading.check_cases(cases, self.space, self.offered, self._compared)
        return cases

    def validate(
        self, fits: Fits, cases: Any = None, *, results: Path | None = None
    ) -> xr.Dataset | None:
        """Surrogates, and the validation's models, beside cases that they have not seen.

        cases: as in `cases`; default the study's own. Runs no solver but the models.
        """
        return validation(
            self.validation,
            self.space,
            self.offered,
            fixed_inputs(self.spec.solver, self.space, self.constants),
            fits,
            self.cases(cases, results=results),
        )

    def calibrate(self, fits: Fits, table: xr.Dataset | None = None) -> Posterior | None:
        """What the measurements of `calibration:` say about inputs; None when it is not asked.

        table: the comparison, which says which surrogate is best. Runs no solver.
        """
        if self.calibration is None:
            return None
        names = self.best(table)
        return calibrating.posterior(self.calibration, names, fits)

    def report(
        self,
        runs: xr.Dataset,
        fits: Fits,
        table: xr.Dataset | None = None,
        indices: xr.Dataset | None = None,
        *,
        screening: Screening | None = None,
        validation: xr.Dataset | None = None,
        reduced: str = "",
        not_done: Sequence[str] = (),
    ) -> Page:
        """The report as one page; `page.save(path)` writes it."""
        scatter = replicates(self.outputs, self.spec.deterministic, runs)
        return reporting.report(
            runs,
            name=self.name,
            about=self.about,
            space=self.space,
            fits=fits,
            comparison=table,
            regression=self.regressions(fits),
            sensitivity=indices,
            screening=screening,
            validation=validation,
            aliasing=aliasing(self.space, runs),
            failures=failures(self.space, runs),
            replicates=scatter,
            noise=noise(self.outputs, runs, fits, scatter),
            suspicious=suspicious(runs, fits),
            reduced_study=reduced,
            scene=scene(
                getattr(self.spec.solver, "scene", None),
                self.space,
                fixed_inputs(self.spec.solver, self.space, self.constants),
            ),
            not_done=not_done,
        )

    def validation_page(self, runs: xr.Dataset, validation: xr.Dataset) -> Page:
        """The report of a validation alone."""
        return reporting.validation_page(
            runs, name=self.name, about=self.about, space=self.space, validation=validation
        )


def _reference(path: Path) -> Study:
    """A study whose runs are the cases of another; its own validation is left aside."""
    source = read_file(path)
    if isinstance(source.data, dict):
        source.data.pop("validation", None)
    return Study._of(source, path.resolve().parent)
