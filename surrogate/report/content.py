"""What a report is made from: plain datasets, fits and the decisions drawn from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import xarray as xr

from surrogate.adaptive.outcome import Grown
from surrogate.designs.aliasing import Aliasing
from surrogate.fitting.fit import Fit
from surrogate.fitting.geometry import Geometry
from surrogate.fitting.noise import Noise
from surrogate.fitting.replicates import Replicates
from surrogate.runs.names import RESERVED_NAMES
from surrogate.sensitivity.screening import Screening
from surrogate.space.space import Space

#: Below this Q2 a surrogate's predictions are called poor.
POOR_Q2 = 0.9
#: Share of held-out runs inside their 95 % intervals below which the intervals are too narrow.
POOR_COVERAGE = 0.8
#: A page draws and lists so many runs at most.
MOST_RUNS = 1000


if TYPE_CHECKING:
    from surrogate.calibration.posterior import Posterior
    from surrogate.fitting.failures import FailingRegion
    from surrogate.reliability.solution import Reliability
    from surrogate.solving.solution import Solution


class Sentence(Protocol):
    """What is known of something, as a sentence without its full stop."""

    @property
    def sentence(self) -> str: ...


def thinned(count: int, first: np.ndarray | None = None) -> np.ndarray:
    """Which of so many runs a page draws and lists, shape (count,): all up to `MOST_RUNS`.

    Of more it takes `MOST_RUNS`, evenly spaced. first: runs that come before others, such as
    failed ones; they take half of the room at most.
    """
    if count <= MOST_RUNS:
        return np.ones(count, dtype=bool)
    shown = np.zeros(count, dtype=bool)
    ahead = np.flatnonzero(first) if first is not None else np.empty(0, dtype=int)
    room = min(len(ahead), MOST_RUNS // 2)
    if room:
        shown[ahead[np.linspace(0, len(ahead) - 1, room).astype(int)]] = True
    others = np.flatnonzero(~shown)
    shown[others[np.linspace(0, len(others) - 1, MOST_RUNS - room).astype(int)]] = True
    return shown


@dataclass(frozen=True)
class Content:
    """Everything that the page shows; whatever is missing is left out of it, and said so.

    name, about     the study's name and what it asks
    space           the parameters
    runs            the runs dataset, failed runs included
    fits            surrogate -> output -> fit
    comparison      dataset over (surrogate, output)
    regression      surrogate -> output -> regression table
    sensitivity     dataset over (output, parameter)
    screening       which parameters to keep
    adaptive        design whose points followed from answers -> how it went on
    learning        dataset over (surrogate, output, size)
    solve           goal -> inputs that reach it
    reliability     failure -> how probable it is
    calibration     what measurements say about inputs
    validation      dataset over (model, output, case)
    aliasing        design -> aliasing of a two-level fraction
    failures        the region where runs fail
    replicates      output -> scatter at repeated points
    noise           output -> its noise, where that is a large share of the variance
    suspicious      output -> a sentence on runs that a robust surrogate finds too far away
    reduced_study   text of the study file without the frozen parameters
    scene           the solver's geometry over the parameters, or why it is not shown
    not_done        sentences about what the study asked for and could not be done
    known           what sections have worked out of a fit and an output, for those behind them
    """

    name: str
    space: Space
    runs: xr.Dataset
    about: str = ""
    fits: Mapping[str, Mapping[str, Fit]] = field(default_factory=dict)
    comparison: xr.Dataset | None = None
    regression: Mapping[str, Mapping[str, xr.Dataset]] = field(default_factory=dict)
    sensitivity: xr.Dataset | None = None
    screening: Screening | None = None
    adaptive: Mapping[str, Grown] = field(default_factory=dict)
    learning: xr.Dataset | None = None
    solve: Mapping[str, Solution] = field(default_factory=dict)
    reliability: Mapping[str, Reliability] = field(default_factory=dict)
    calibration: Posterior | None = None
    validation: xr.Dataset | None = None
    aliasing: Mapping[str, Aliasing] = field(default_factory=dict)
    failures: FailingRegion | None = None
    replicates: Mapping[str, Replicates] = field(default_factory=dict)
    noise: Mapping[str, Noise] = field(default_factory=dict)
    suspicious: Mapping[str, Sentence] = field(default_factory=dict)
    reduced_study: str = ""
    scene: Geometry | str | None = None
    not_done: Sequence[str] = ()
    known: dict[tuple[int, str], Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs, in the order of the runs dataset."""
        apart = {*RESERVED_NAMES, *self.space.names}
        return [
            str(name)
            for name, values in self.runs.data_vars.items()
            if name not in apart and "run" in values.dims and np.issubdtype(values.dtype, np.number)
        ]

    @property
    def ok(self) -> np.ndarray:
        """Which runs have an answer, shape (run,)."""
        return np.asarray(self.words("status") == "ok")

    @property
    def failed(self) -> np.ndarray:
        """Which runs were made and have no answer, shape (run,)."""
        return np.asarray(~self.ok & ~self.missing)

    @property
    def missing(self) -> np.ndarray:
        """Which runs have not been made yet, shape (run,)."""
        return np.asarray(self.words("status") == "missing")

    @cached_property
    def shown(self) -> np.ndarray:
        """Which runs the page draws and lists, shape (run,)."""
        return thinned(len(self.ok), self.failed)

    @property
    def seconds(self) -> np.ndarray:
        """Time of each run, NaN where unknown, shape (run,)."""
        if "seconds" not in self.runs:
            return np.full(self.runs.sizes["run"], np.nan)
        return np.asarray(self.runs["seconds"].values, dtype=float)

    @property
    def repeated(self) -> np.ndarray:
        """Which rows show again a run that an earlier row has shown, shape (run,).

        Designs that share a point share its run, down to the time that it took.
        """
        again, seen = np.zeros(len(self.coded), dtype=bool), set()
        for k, (point, spent) in enumerate(zip(self.coded, self.seconds, strict=True)):
            key = (*np.round(point, 9), spent)
            again[k] = key in seen and np.isfinite(spent)
            seen.add(key)
        return again

    @property
    def deterministic(self) -> bool:
        """False when the solver gives another answer to the same question."""
        return str(self.runs.attrs.get("deterministic", "true")).lower() != "false"

    @property
    def recorded(self) -> bool:
        """True when the runs are rows of a table, and no solver stands behind them."""
        return str(self.runs.attrs.get("recorded", "false")) == "true"

    @property
    def failing(self) -> str:
        """Where the runs fail, as a sentence; "" when nothing tells."""
        words = "" if self.failures is None else f"{self.failures}."
        return words[:1].upper() + words[1:]

    @property
    def notes(self) -> list[str]:
        """What was guessed of the study's data, and what was left out."""
        return str(self.runs.attrs.get("notes", "")).splitlines()

    def finished(self, output: str) -> np.ndarray:
        """Which runs have a whole answer for this output, shape (run,)."""
        values = self.values(output)
        return np.asarray(self.ok & np.isfinite(values).reshape(len(values), -1).all(axis=1))

    @property
    def numbers(self) -> np.ndarray:
        """Run numbers as the dataset counts them, shape (run,)."""
        return np.asarray(
            self.runs["run"].values
            if "run" in self.runs.coords
            else np.arange(self.runs.sizes["run"])
        )

    @property
    def coded(self) -> np.ndarray:
        """Coded points (run, parameter)."""
        return np.asarray(self.runs["coded"].values, dtype=float)

    @property
    def designs(self) -> list[str]:
        """Names of the designs, in the order in which they appear."""
        return list(dict.fromkeys(self.words("design")))

    def words(self, variable: str) -> np.ndarray:
        """A variable of words, shape (run,); empty words when it is missing."""
        if variable not in self.runs:
            return np.full(self.runs.sizes["run"], "", dtype=object)
        return np.array([str(word) for word in self.runs[variable].values], dtype=object)

    def unit(self, name: str) -> str:
        """Unit of an output or a parameter."""
        if name in self.space.names:
            return self.space[name].unit
        return str(self.runs[name].attrs.get("units", "")) if name in self.runs else ""

    def values(self, output: str) -> np.ndarray:
        """Values of an output, shape (run, ...) with its own dimensions behind."""
        return np.asarray(self.runs[output].transpose("run", ...).values, dtype=float)

    def is_field(self, output: str) -> bool:
        """True when an output has dimensions of its own."""
        return self.runs[output].ndim > 1

    def fits_of(self, output: str) -> dict[str, Fit]:
        """Fits of one output, by surrogate."""
        return {
            name: by_output[output] for name, by_output in self.fits.items() if output in by_output
        }

    def row(self, surrogate: str, output: str) -> dict[str, float]:
        """The comparison's numbers of one surrogate; empty when it has none."""
        table = self.comparison
        if table is None or surrogate not in table["surrogate"].values.astype(str):
            return {}
        if output not in table["output"].values.astype(str):
            return {}
        chosen = table.sel(surrogate=surrogate, output=output)
        return {
            str(name): float(value)
            for name, value in chosen.data_vars.items()
            if value.ndim == 0 and np.issubdtype(value.dtype, np.number)
        }

    def q2(self, surrogate: str, output: str) -> float:
        """Q2 on held-out runs when there are some, otherwise cross-validated; or NaN."""
        return self._score("q2", surrogate, output)

    def rmse(self, surrogate: str, output: str) -> float:
        """RMSE on the runs that `q2` is of; or NaN."""
        return self._score("rmse", surrogate, output)

    def tested(self, surrogate: str, output: str) -> bool:
        """True when Q2 on held-out runs is known."""
        return bool(np.isfinite(self.row(surrogate, output).get("q2_test", np.nan)))

    def _score(self, score: str, surrogate: str, output: str) -> float:
        how = "test" if self.tested(surrogate, output) else "cv"
        return self.row(surrogate, output).get(f"{score}_{how}", np.nan)

    def best(self, output: str) -> str | None:
        """The surrogate that the comparison names best for this output; or the first."""
        names = list(self.fits_of(output))
        table = self.comparison
        if table is not None and output in table["output"].values.astype(str):
            named = str(table["best"].sel(output=output).item())
            if named in names:
                return named
        return next(iter(names), None)
