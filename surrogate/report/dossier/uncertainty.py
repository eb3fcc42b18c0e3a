"""What uncertain inputs and the surrogate itself do to the answer."""

from __future__ import annotations

from collections.abc import Iterator

from surrogate.report import digits
from surrogate.report.content import POOR_COVERAGE
from surrogate.report.dossier.evidence import Chapter, Evidence
from surrogate.report.dossier.known import Known


def uncertainty(known: Known) -> Chapter:
    """What intervals hold, and the indices."""
    covered = [*_of_held_out_runs(known), *_of_cases(known)]
    evidence = [one for one, _ in covered] + [*_indices(known)]
    return Chapter(
        "uncertainty",
        "Uncertainty quantification",
        "What do uncertain inputs and the surrogate itself do to the answer?",
        [],
        evidence,
        [words for _, words in covered if words],
        [] if evidence else ["intervals and indices (designs: test, sensitivity)"],
    )


def _of_held_out_runs(known: Known) -> Iterator[tuple[Evidence, str]]:
    """What the intervals of the best surrogates hold of runs; a finding where it is little."""
    for name, output, i, j in known.best():
        value, place = known.figures.at("comparison", "coverage_95", i, j)
        if value is not None:
            claim = f"{output}, {name}: share of held-out runs inside their 95 % intervals"
            evidence = Evidence(claim, digits.percent(value), known.run, place)
            yield evidence, _holds_little(output, name, "held-out runs", value)


def _of_cases(known: Known) -> Iterator[tuple[Evidence, str]]:
    """What the intervals of each model hold of the cases; a finding where it is little."""
    for k, output in enumerate(known.figures.names("validation", "output")):
        for i, model in enumerate(known.figures.names("validation", "model")):
            value, place = known.figures.at("validation", "coverage_95", i, k)
            if value is not None:
                claim = f"{output}, {model}: share of cases inside their 95 % intervals"
                evidence = Evidence(claim, digits.percent(value), known.validate, place)
                yield evidence, _holds_little(output, model, "cases", value)


def _holds_little(output: str, model: str, what: str, share: float) -> str:
    if share >= POOR_COVERAGE:
        return ""
    return (
        f"{output}, {model}: the 95 % intervals hold {digits.percent(share)} of the {what}; they "
        "are too narrow there."
    )


def _indices(known: Known) -> Iterator[Evidence]:
    """Total indices (or Shapley effects) with their intervals."""
    figures = known.figures
    key = next((k for k in ("total", "shapley") if figures.names("sensitivity", k)), "")
    for j, output in enumerate(figures.names("sensitivity", "output") if key else ()):
        for k, name in enumerate(figures.names("sensitivity", "parameter")):
            value, place = figures.at("sensitivity", key, j, k)
            low, _ = figures.at("sensitivity", f"{key}_low", j, k)
            high, _ = figures.at("sensitivity", f"{key}_high", j, k)
            if value is not None:
                shown = digits.with_interval(value, low, high)
                claim = f"{output}: {key} index of {name}"
                yield Evidence(claim, shown, known.run, place)
