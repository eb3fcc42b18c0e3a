"""What changed in the screening, in the answers to goals, and in solver and packages."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from surrogate.differences.folder import ResultsFolder
from surrogate.differences.part import SIDES, Part, differing, side_by_side


def screening_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Parameters that are kept or frozen."""
    of_a, of_b = (_decisions(one.figures) for one in (a, b))
    rows = [{"parameter": name, **both} for name, both in side_by_side(of_a, of_b)]
    title = "Screening"
    if not rows:
        return Part("screening", title)
    changed = differing(rows)
    said = (
        f"The decision on {', '.join(row['parameter'] for row in changed)} has changed."
        if changed
        else "The decisions are the same."
    )
    return Part("screening", title, (said,), {"parameter": "parameter", **SIDES}, rows, changed)


def _decisions(figures: Mapping[str, Any]) -> dict[str, str]:
    found = figures.get("screening") or {}
    return {name: word for word in ("keep", "freeze") for name in found.get(word, ())}


def goals_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Inputs, predictions and probability of the best candidate of each goal."""
    of_a, of_b = (dict(_candidates(one.figures)) for one in (a, b))
    rows = [{"goal": goal, "what": what, **both} for (goal, what), both in side_by_side(of_a, of_b)]
    if not rows:
        return Part("solve", "Goals")
    changed = differing(rows)
    names = dict.fromkeys(row["goal"] for row in changed)
    said = f"Answers differ: {', '.join(names)}." if names else "The answers are the same."
    columns = {"goal": "goal", "what": "best candidate", **SIDES}
    return Part("solve", "Goals", (said,), columns, rows, changed)


def _candidates(figures: Mapping[str, Any]) -> Iterator[tuple[tuple[str, str], Any]]:
    for goal, found in (figures.get("solve") or {}).items():
        for one in found["candidates"][:1]:
            for name, value in one["inputs"].items():
                yield (goal, name), value
            for name, at in one["predicted"].items():
                yield (goal, name), (at["value"], at["low"], at["high"])
            yield (goal, "probability"), one["probability"]


def versions_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Solver, its version and options, packages and seeds, as the runs datasets tell them."""
    of_a, of_b = (dict(_versions(one)) for one in (a, b))
    rows = [{"what": name, **both} for name, both in side_by_side(of_a, of_b)]
    if not rows:
        return Part("versions", "Solver and packages")
    changed = differing(rows)
    said = (
        f"Different: {', '.join(row['what'] for row in changed)}."
        if changed
        else "Solver and packages are the same."
    )
    columns = {"what": "what", **SIDES}
    return Part("versions", "Solver and packages", (said,), columns, rows, changed)


def _versions(one: ResultsFolder) -> Iterator[tuple[str, str]]:
    attributes = one.runs.attrs if one.runs is not None else {}
    for key in ("solver", "solver_version", "solver_options", "constants"):
        if key in attributes:
            yield key.replace("_", " "), str(attributes[key])
    for key in ("versions", "seeds"):
        for name, value in json.loads(attributes.get(key, "{}")).items():
            yield (name if key == "versions" else f"seed of {name}"), str(value)
