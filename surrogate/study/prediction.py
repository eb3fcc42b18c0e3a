"""Predictions of a study's surrogates at points that people write down."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.errors import FitError, ResultsError, StudyError, nearest
from surrogate.fitting.extrapolation import extrapolates
from surrogate.fitting.fit import Fit
from surrogate.space.space import Space
from surrogate.stages.stage import Step
from surrogate.stages.walk import Walk
from surrogate.study.analysis import walk
from surrogate.study.study import Study
from surrogate.validation.cases import Cases, read_table

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Predictions:
    """One row a point, `inside` telling whether the study's ranges cover it.

    A point in the ranges is `extrapolated` too where it lies outside of a table's cloud of rows.

    rows  {"point", "inputs", "inside", "extrapolated",
          "outputs": {name: {"surrogate", "value", "low", "high"}}}
    note  what a reader should know before relying on them; may be empty
    """

    rows: list[dict[str, Any]]
    note: str = ""


def predict(
    study: Study,
    results: Path,
    surrogate: str | None,
    words: Sequence[str],
    points: Path | None,
    *,
    steps: Callable[[Step], None] = lambda step: None,
) -> Predictions:
    """Values and 95 % intervals at `name=value` words, or at the rows of a table.

    surrogate: its name; None for the best of each output. Values are in the solver's
    unit unless they carry one (`tension='98 N/m'`). Raises `StudyError` for points that
    are not understood, `ResultsError` when no runs are stored and `FitError` when nothing
    can be fitted to them.
    """
    space = study.space
    physical = _from_words(space, words) if points is None else _from_table(space, points, words)
    coded = study.space.encode(physical)
    fits, notes = fits_at_hand(study, results, surrogate, steps=steps)
    inside = study.space.contains(coded)
    hidden = _hidden(study, [fit for _, fit in fits.values()], coded)
    outputs = {output: (name, *_with_interval(fit, coded)) for output, (name, fit) in fits.items()}
    return Predictions(
        [_row(study.space, physical, inside, hidden, outputs, i) for i in range(len(coded))],
        "\n".join(notes),
    )


def fits_at_hand(
    study: Study,
    results: Path,
    surrogate: str | None,
    *,
    steps: Callable[[Step], None] = lambda step: None,
) -> tuple[dict[str, tuple[str, Fit]], list[str]]:
    """Output -> (name of the surrogate, its fit), from the runs there are; and what to know.

    surrogate: its name; None for the best of each output. Raises as `predict` does.
    """
    stored, unfound = usable(study, results, surrogate)
    asked = study if surrogate is None else study.with_surrogates([surrogate])
    stages = walk(asked, results, stored, progress=steps)
    fits = stages.value("fits")
    found = {
        output: (name, fits[name][output])
        for output, name in _chosen(study, stages, surrogate).items()
    }
    lost = stages.result("fits").not_done if len(found) < len(study.outputs) else ()
    if not found:
        raise FitError("\n".join(lost))
    return found, [*told(stored, unfound), *lost]


def _row(
    space: Space,
    physical: Mapping[str, Any],
    inside: NDArray[np.bool_],
    hidden: NDArray[np.bool_],
    outputs: Mapping[str, tuple[str, Numbers, Numbers, Numbers]],
    i: int,
) -> dict[str, Any]:
    return {
        "point": i,
        "inputs": {name: np.asarray(physical[name])[i].item() for name in space.names},
        "inside": bool(inside[i]),
        "extrapolated": bool(hidden[i] or not inside[i]),
        "outputs": {
            output: {
                "surrogate": name,
                "value": mean[i].tolist(),
                "low": low[i].tolist(),
                "high": high[i].tolist(),
            }
            for output, (name, mean, low, high) in outputs.items()
        },
    }


def _hidden(study: Study, fits: Iterable[Fit], coded: Numbers) -> NDArray[np.bool_]:
    """Which points lie outside of a table's cloud of training rows, whatever their ranges."""
    found = np.zeros(len(coded), dtype=bool)
    for fit in fits if study.spec.recorded else ():
        found |= extrapolates(study.space, fit.coded, coded)
    return found


def _with_interval(fit: Fit, coded: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    return fit.predict(coded), *fit.interval(coded)


def usable(study: Study, results: Path, surrogate: str | None) -> tuple[xr.Dataset, int]:
    """The runs there are, when the study can predict from them with that surrogate.

    And how many runs more are asked for by designs whose points are not found yet.
    """
    if not study.surrogates:
        raise StudyError("the study has no surrogates to predict with; add surrogates:")
    if surrogate is not None and surrogate not in study.surrogates:
        raise StudyError(
            f"surrogate '{surrogate}' is unknown; {nearest(surrogate, study.surrogates)}"
        )
    stored, unfound = study.stored(results), study.asked(results).waiting
    if not (stored["status"] == "ok").any():
        raise ResultsError(
            f"{results} holds no finished runs of this study; do `surrogate run` first"
        )
    return stored, unfound


def told(stored: xr.Dataset, unfound: int) -> list[str]:
    """What to know of predictions while runs are missing."""
    missing = int((stored["status"] == "missing").sum()) + unfound
    return (
        [f"{missing} runs of the study are not done yet; the surrogates lack them."]
        if missing
        else []
    )


def _chosen(study: Study, stages: Walk, surrogate: str | None) -> dict[str, str]:
    """Which surrogate answers for each output."""
    fits = stages.value("fits")
    if surrogate is not None:
        return {output: surrogate for output in fits[surrogate]}
    best = study.best(stages.value("comparison")) if len(fits) > 1 else {}
    return {
        output: best.get(output, next(iter(fits)))
        for output in study.outputs
        if any(output in by_output for by_output in fits.values())
    }


def _from_words(space: Space, words: Iterable[str]) -> dict[str, np.ndarray]:
    """Columns of one point from `name=value` words; all mistakes at once."""
    mistakes, given = [], {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals:
            mistakes.append(f"'{word}' is not name=value")
        elif name not in space.names:
            mistakes.append(f"parameter '{name}' is unknown; {nearest(name, space.names)}")
        elif name in given:
            mistakes.append(f"parameter '{name}' is given twice")
        else:
            given[name] = np.array([value], dtype=object)
    return _columns(space, Cases("", given, ("",), ("",)), mistakes)


def _from_table(space: Space, path: Path, words: Sequence[str]) -> dict[str, np.ndarray]:
    """Columns of the points in a table whose first line names the parameters."""
    if words:
        raise StudyError("give either name=value words or --points, not both")
    return _columns(space, read_table(path), [])


def _columns(space: Space, given: Cases, mistakes: list[str]) -> dict[str, np.ndarray]:
    missing = [name for name in space.names if name not in given.columns]
    if missing:
        mistakes.append(f"{given.name}: no value for {', '.join(missing)}".removeprefix(": "))
    columns: dict[str, Any] = {}
    for parameter in space.parameters:
        if parameter.name not in missing:
            try:
                columns |= given.inputs({parameter.name: parameter})
                parameter.encode(columns[parameter.name])
            except StudyError as error:
                mistakes += error.mistakes
    if mistakes:
        raise StudyError(*mistakes)
    return columns
