"""Whether equations are solved, and how well: code and calculation verification."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from surrogate.report import digits
from surrogate.report.content import POOR_Q2
from surrogate.report.dossier.evidence import Chapter, Evidence
from surrogate.report.dossier.known import Known


def code(known: Known) -> Chapter:
    """What was checked of the solver's code, and which code it was."""
    plain, checked = known.claims("code_verification")
    attributes = known.runs.attrs
    versions = json.loads(str(attributes.get("versions", "{}")))
    solver = f"{attributes.get('solver', '')} {attributes.get('solver_version', '')}"
    own = [
        Evidence("solver and its version", solver, known.run, "runs.nc: solver_version"),
        Evidence(
            "versions of the packages",
            ", ".join(f"{name} {version}" for name, version in versions.items()),
            known.run,
            "runs.nc: versions",
        ),
    ]
    return Chapter(
        "code-verification",
        "Code verification",
        "Does the code solve the equations that it says it solves?",
        plain,
        [*checked, *own],
        missing=known.lacks("code_verification"),
    )


def calculation(known: Known) -> Chapter:
    """Errors of the solver and of the surrogate in its place."""
    plain, checked = known.claims("calculation_verification")
    lost = _lost(known.summary["runs"])
    region = known.summary.get("failures")
    findings = [f"{lost} runs have no answer."] if lost else []
    findings += [str(region["sentence"])] if region else []
    return Chapter(
        "calculation-verification",
        "Calculation verification",
        "How far is a computed answer from the exact one: mesh, iterations, and here the "
        "surrogate in place of the solver?",
        plain,
        [*checked, *_history(known), *_held_out(known)],
        [*findings, *_poor(known)],
        known.lacks("calculation_verification"),
    )


def _lost(counts: Mapping[str, int]) -> int:
    return sum(count for status, count in counts.items() if status != "ok")


def _history(known: Known) -> Iterator[Evidence]:
    """Runs by status, seeds, repeatability."""
    again = f"{known.run} --fresh"
    counts = {word: count for word, count in known.summary["runs"].items() if count}
    told = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in counts.items())
    yield Evidence("runs of the solver", told, again, "summary.json: runs")
    seeds = json.loads(str(known.runs.attrs.get("seeds", "{}")))
    if seeds:
        shown = ", ".join(f"{name} {seed}" for name, seed in seeds.items())
        yield Evidence("seeds of the designs", shown, again, "runs.nc: seeds")
    same = known.content.deterministic
    words = "same inputs give the same answer" if same else "answers scatter"
    yield Evidence("repeatability of the solver", words, again, "runs.nc: deterministic")
    for output, scatter in (known.summary.get("replicates") or {}).items():
        place = f"summary.json: replicates.{output}.std"
        std = digits.with_unit(digits.figure(scatter["std"]), known.unit(output, "std"))
        yield Evidence(f"{output}: scatter of replicates", std, again, place)


def _held_out(known: Known) -> Iterator[Evidence]:
    """Errors of the best surrogates on runs that they have not seen."""
    for name, output, i, j in known.best():
        for key, words in _ERRORS.items():
            value, place = known.figures.at("comparison", key, i, j)
            if value is not None:
                claim = f"{output}, surrogate {name}: {words}"
                number = digits.score(value) if key.startswith("q2") else digits.figure(value)
                shown = digits.with_unit(number, known.unit(output, key))
                yield Evidence(claim, shown, known.run, place)


def _poor(known: Known) -> Iterator[str]:
    for name, output, i, j in known.best():
        tested, _ = known.figures.at("comparison", "q2_test", i, j)
        value = known.figures.at("comparison", "q2_cv", i, j)[0] if tested is None else tested
        if value is not None and value < POOR_Q2:
            yield f"{output}: the best surrogate, {name}, is poor (Q2 {digits.figure(value)})."


_ERRORS = {
    "q2_test": "Q2 on held-out runs",
    "rmse_test": "RMSE on held-out runs",
    "max_error_test": "largest error on held-out runs",
    "q2_cv": "Q2, cross-validated",
    "rmse_cv": "RMSE, cross-validated",
}
