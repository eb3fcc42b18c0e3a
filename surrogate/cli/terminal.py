"""What the command prints: each function turns a study and its results into a `Page`."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.cli import calibrating
from surrogate.cli.figures import COMPARED, INDICES, figure_tables, validation_tables
from surrogate.cli.outcome import Outcome
from surrogate.cli.page import Page
from surrogate.cli.progress import duration
from surrogate.cli.results import store as store_runs
from surrogate.cli.results import validate as validate_with
from surrogate.cli.table import Table
from surrogate.execution.fresh import interrupted
from surrogate.runs import dataset as rundata
from surrogate.stages.stage import Step
from surrogate.stages.summary import figures_of
from surrogate.study import prediction
from surrogate.study.study import Study


def check(study: Study, results: Path) -> Page:
    """Parameters, designs, aliasing, run count, time estimate."""
    study = study.found(results, spread=False)
    stored, unfound = study.begun(results)
    counts = rundata.counts(stored)
    counts["missing"] += unfound
    parameters = [(p.name, p.unit, p.described) for p in study.space.parameters]
    designs = [
        (d.name, d.method, d.runs, ", ".join(f"{m} {n}" for m, n in d.added))
        for d in study.designs.values()
    ]
    aliases = study.aliases
    parts: list[str | Table] = [
        f"{study.name}: {study.about}\n",
        Table("parameters", ("name", "unit", "values"), parameters),
        "",
    ]
    if study.space.constraints:
        kept = [(one.text,) for one in study.space.constraints]
        parts += [Table("constraints", ("all points keep",), kept), ""]
    if study.constants:
        rows = [
            (name, study.spec.solver.inputs[name].unit, value)
            for name, value in study.constants.items()
        ]
        parts += [Table("constants", ("name", "unit", "value"), rows), ""]
    parts += [Table("designs", ("name", "method", "runs", "of these added"), designs), ""]
    for name, alias in aliases.items():
        parts.append(f"aliasing of {name}: {alias}\n")
    parts += _constraint_lines(study)
    parts += [f"note: {note}" for note in study.notes]
    parts += [_surrogate_line(study), _runs_line(study, stored, counts, unfound), *study.unused]
    parts += rundata.described(stored, "damaged")
    data = {
        "study": study.name,
        "solver": study.spec.name,
        "parameters": [
            dict(zip(("name", "unit", "values"), row, strict=True)) for row in parameters
        ],
        "constants": dict(study.constants),
        "designs": {
            name: {"method": d.method, "runs": d.runs} for name, d in study.designs.items()
        },
        "aliasing": {
            name: {
                "resolution": a.resolution,
                "word_length_pattern": a.word_length_pattern,
                "table": a.table,
            }
            for name, a in aliases.items()
        },
        "broken_constraints": study.broken_constraints,
        "notes": list(study.notes),
        "runs": counts,
        "stored": rundata.described(stored, "stored"),
        "unused": study.unused,
        "damaged": rundata.described(stored, "damaged"),
        "seconds_left": _seconds_left(study, stored, unfound),
    }
    return Page(data, parts)


def _constraint_lines(study: Study) -> list[str]:
    """A line for each design and each constraint of the solver that some of its points break."""
    return [
        f"{count} of {study.designs[name].runs} points of {name} have no answer: {sentence}\n"
        for name, counts in study.broken_constraints.items()
        for sentence, count in counts.items()
    ]


def _surrogate_line(study: Study) -> str:
    named = [
        f"{s.name} ({s.method}, from {' + '.join(s.train)})" for s in study.surrogates.values()
    ]
    return f"surrogates: {', '.join(named) or 'none'}"


def _seconds_left(study: Study, stored: xr.Dataset, unfound: int) -> float | None:
    """Estimated time of the runs to do; None when unknown, as of answers that are told."""
    if study.spec.told:
        return None
    return rundata.seconds_left(stored, study.places, unfound)


def _runs_line(study: Study, stored: xr.Dataset, counts: Mapping[str, int], unfound: int) -> str:
    total, left = sum(counts.values()), counts["missing"]
    files = rundata.described(stored, "stored")
    from_files = f" ({', '.join(f'{n} in {name}' for name, n in files.items())})" * bool(files)
    if not left:
        return f"runs: all {total} are stored{from_files}; nothing is left to run"
    if study.spec.told:
        return (
            f"runs: {total}, of which {total - left} are told{from_files}; {left} wait for their "
            "answers (Python: surrogate.Campaign)"
        )
    seconds = _seconds_left(study, stored, unfound)
    time = (
        "time unknown until the first run is done"
        if seconds is None
        else f"about {duration(seconds)} with {study.places} workers"
    )
    return f"runs: {total}, of which {total - left} are stored{from_files}; {left} to do: {time}"


def status(study: Study, results: Path) -> Page:
    """Runs done, failed, left; time left; why runs failed."""
    study = study.recalled(results)
    stored, unfound = study.begun(results)
    counts = rundata.counts(stored)
    counts["missing"] += unfound
    words = {"ok": "done", "failed": "failed", "timed_out": "timed out", "missing": "left"}
    parts: list[str | Table] = [
        f"{study.name}: "
        + ", ".join(f"{counts[key]} {word}" for key, word in words.items() if counts[key])
    ]
    troubled = rundata.select(stored, statuses=("failed", "timed_out"))
    reasons = dict.fromkeys(
        f"run {run}: {message}"
        for run, message in zip(
            np.flatnonzero(np.isin(stored["status"], ("failed", "timed_out"))),
            troubled["message"].values,
            strict=True,
        )
    )
    parts += [f"  {reason}" for reason in list(reasons)[:10]]
    if len(reasons) > 10:
        parts.append(f"  and {len(reasons) - 10} more; the report lists all")
    files = rundata.described(stored, "stored")
    if counts["missing"] or files:
        parts.append(_runs_line(study, stored, counts, unfound))
    waiting = interrupted(study.journal(results))
    if waiting:
        parts.append(
            f"a recomputation was interrupted after {waiting} runs; "
            "`surrogate run --fresh` goes on with it"
        )
    parts += [*study.unused, *rundata.described(stored, "damaged")]
    return Page(
        {
            "study": study.name,
            "runs": counts,
            "stored": files,
            "unused": study.unused,
            "damaged": rundata.described(stored, "damaged"),
            "fresh": waiting,
            "seconds_left": _seconds_left(study, stored, unfound),
        },
        parts,
    )


def store(study: Study, results: Path, to: Path | None) -> Page:
    """Where the stored runs are, and the line that the study needs."""
    path, runs = store_runs(study, results, to)
    counts = rundata.counts(runs)
    done = runs.sizes["run"] - counts["missing"]
    parts = [f"{path} holds {done} runs ({path.stat().st_size / 1e3:.0f} kB)"]
    if counts["missing"]:
        parts.append(f"{counts['missing']} runs of the study are not done yet and not in it")
    name = Path(os.path.relpath(path, study.place)).as_posix()
    named = name in (file.name for file in study.stored_runs)
    parts.append("the study names it already" if named else f"add to the study:\n\nstored: {name}")
    return Page(
        {"file": str(path), "runs": done, "missing": counts["missing"], "stored": name}, parts
    )


def validate(
    study: Study,
    results: Path,
    cases: Path | None,
    steps: Callable[[Step], None] = lambda step: None,
) -> Page:
    """Figures of agreement, and where the page is."""
    found, page = validate_with(study, results, cases, steps=steps)
    parts = [*validation_tables(figures_of(found)), "", f"page: {page}"]
    return Page({**figures_of(found), "report": str(page)}, parts)


def outcome(study: Study, done: Outcome) -> Page:
    """The findings in a few lines, and where the report is."""
    figures = done.summary
    parts: list[str | Table] = []
    for key, titles in (("comparison", COMPARED), ("sensitivity", INDICES)):
        if figures[key]:
            parts += [part for made in figure_tables(figures[key], titles) for part in (made, "")]
    if figures["validation"]:
        parts += [*validation_tables(figures["validation"]), ""]
    if figures["calibration"]:
        parts += [*calibrating.lines(figures["calibration"]), ""]
    if figures["screening"]:
        parts.append(_screening_line(figures["screening"]))
    if figures["learning"]:
        parts += _learning_lines(figures["learning"], figures["comparison"])
    for name, goal in (figures["solve"] or {}).items():
        parts.append(f"goal {name} ({goal['goal']}): {goal['sentence']}")
    if figures["failures"]:
        parts.append(figures["failures"]["sentence"])
    parts += [
        f"{output}: standard deviation of the replicates {scatter['std']:.3g}"
        for output, scatter in figures["replicates"].items()
    ]
    parts.append(f"report: {done.report}" + ("" if done.fresh else " (was up to date)"))
    return Page({**figures, "report": str(done.report)}, parts)


def _screening_line(screening: Mapping[str, Any]) -> str:
    if screening["refused"]:
        return f"screening: nothing is frozen. {screening['refused']}"
    frozen = ", ".join(screening["freeze"]) or "nothing"
    return f"screening: keep {', '.join(screening['keep']) or 'nothing'}; may be frozen: {frozen}"


def _learning_lines(learning: Mapping[str, Any], comparison: Mapping[str, Any]) -> list[str]:
    """What the curve of each output's best surrogate says; of the first where it has none."""
    outputs, names = learning["output"]["values"], learning["surrogate"]["values"]
    best = dict(zip(comparison["output"]["values"], comparison["best"]["values"], strict=True))
    lines = []
    for k, output in enumerate(outputs):
        said = [row[k] for row in learning["sentence"]["values"]]
        own = names.index(best[output]) if best[output] in names else 0
        text = said[own] or next(filter(None, said))
        lines += [f"{output}: {sentence}" for sentence in text.splitlines()]
    return lines


def _place(row: Mapping[str, Any]) -> str:
    if not row["inside"]:
        return "OUTSIDE"
    return "inside, but FAR FROM THE ROWS (extrapolated)" if row["extrapolated"] else "inside"


def predict(
    study: Study,
    results: Path,
    surrogate: str | None,
    words: Sequence[str],
    points: Path | None,
    steps: Callable[[Step], None] = lambda step: None,
) -> Page:
    """Values with intervals at points given as words or as a CSV file."""
    found = prediction.predict(study, results, surrogate, words, points, steps=steps)
    parts: list[str | Table] = [found.note] if found.note else []
    rows = []
    for row in found.rows:
        for output, answer in row["outputs"].items():
            unit = study.spec.solver.outputs[output].unit
            value = answer["value"]
            shown = (
                f"{value:.5g} {unit}".strip()
                if np.ndim(value) == 0
                else f"field {np.shape(value)} {unit}: mean {np.mean(value):.5g}"
            )
            low, high = answer["low"], answer["high"]
            interval = f"[{low:.5g}, {high:.5g}]" if np.ndim(low) == 0 else "see --json"
            rows.append(
                (
                    row["point"],
                    output,
                    answer["surrogate"],
                    shown,
                    interval,
                    _place(row),
                )
            )
    parts.append(
        Table(
            "",
            ("point", "output", "surrogate", "value", "95 % interval", "range of the study"),
            rows,
        )
    )
    return Page(found.rows, parts)
