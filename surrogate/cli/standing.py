"""How a study stands, before and while its runs are done, as the command prints it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from surrogate.adaptive.outcome import outcome_data
from surrogate.cli import foresight
from surrogate.cli.page import Page
from surrogate.cli.progress import duration
from surrogate.cli.table import Table
from surrogate.execution.fresh import interrupted
from surrogate.runs import dataset as rundata
from surrogate.runs.levels import cost_sentences, costs
from surrogate.study.study import Study


def check(study: Study, results: Path, model: str | None = None, effect: float = 2.0) -> Page:
    """Parameters, designs, aliasing, precision of polynomials, run count, time estimate.

    model, effect: as in `foresight.foreseen`. With a model, designs are searched for.
    """
    study = study.found(results, spread=model is not None)
    precise = foresight.foreseen(study, model, effect)
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
    parts += foresight.pages(precise, effect)
    parts += _constraint_lines(study)
    parts += [f"design {name}: {one}\n" for name, one in study.outcomes(results).items()]
    parts += [f"note: {note}" for note in study.notes]
    parts += [_surrogate_line(study), _runs_line(study, stored, counts, unfound)]
    parts += [*cost_sentences(stored), *study.unused]
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
                "blocks": dict(a.blocks),
            }
            for name, a in aliases.items()
        },
        "precision": foresight.data(precise),
        "broken_constraints": study.broken_constraints,
        "notes": list(study.notes),
        "runs": counts,
        "levels": costs(stored),
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
    grown = study.outcomes(results)
    parts += [f"design {name}: {one}" for name, one in grown.items()]
    files = rundata.described(stored, "stored")
    if counts["missing"] or files:
        parts.append(_runs_line(study, stored, counts, unfound))
    parts += cost_sentences(stored)
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
            "levels": costs(stored),
            "stored": files,
            "unused": study.unused,
            "damaged": rundata.described(stored, "damaged"),
            "adaptive": {name: outcome_data(one) for name, one in grown.items()},
            "fresh": waiting,
            "seconds_left": _seconds_left(study, stored, unfound),
        },
        parts,
    )
