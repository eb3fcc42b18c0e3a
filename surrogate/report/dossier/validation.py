"""Whether answers agree with reality, and whether that tells of the context of use."""

from __future__ import annotations

from collections.abc import Iterator

from surrogate.report import digits
from surrogate.report.dossier.evidence import Chapter, Evidence
from surrogate.report.dossier.known import Known


def validation(known: Known) -> Chapter:
    """Agreement of each model with the cases."""
    cases = (known.summary.get("validation") or {}).get("attributes", {}).get("cases", "")
    evidence = [
        item
        for k, output in enumerate(known.figures.names("validation", "output"))
        for i, model in enumerate(known.figures.names("validation", "model"))
        for item in _agreement(known, model, output, i, k)
    ]
    return Chapter(
        "validation",
        "Validation",
        "Do the model's answers agree with reality, or with a better model?",
        [f"Cases: {cases}."] * bool(cases),
        evidence,
        [_COMPUTED] if evidence and known.computed else [],
        []
        if evidence
        else ["a comparison with measurements or a better model (validation: cases)"],
    )


def _agreement(known: Known, model: str, output: str, i: int, k: int) -> Iterator[Evidence]:
    for key, words in _AGREEMENT.items():
        value, place = known.figures.at("validation", key, i, k)
        low, _ = known.figures.at("validation", f"{key}_low", i, k)
        high, _ = known.figures.at("validation", f"{key}_high", i, k)
        if value is None:
            continue
        shown = digits.number(value) if key == "n" else digits.figure(value)
        if low is not None and high is not None:
            shown += f" [{digits.figure(low)}, {digits.figure(high)}]"
        shown = digits.with_unit(shown, known.unit(output, key))
        yield Evidence(f"{output}, {model}: {words}", shown, known.validate, place)


def applicability(known: Known) -> Chapter:
    """Which cases lie inside the ranges of the study."""
    inside = (known.summary.get("validation") or {}).get("inside", {}).get("values", [])
    outside = len(inside) - sum(inside)
    evidence = [
        Evidence(
            "validation cases inside the ranges",
            f"{sum(inside)} of {len(inside)}",
            known.validate,
            "summary.json: validation.inside.values",
        )
    ] * bool(inside)
    told = Evidence(
        "a prediction says whether its inputs lie inside the ranges",
        "inside, outside, or far from the rows of a table",
        known.predict,
        "--json: inside, extrapolated",
    )
    findings = [
        f"{outside} of {len(inside)} cases lie outside the ranges "
        "and were left out: nothing is known of the model there."
    ] * bool(outside)
    lacking = "cases to tell where the context of use lies (validation: cases)"
    return Chapter(
        "applicability",
        "Applicability",
        "Is the evidence about the conditions of the context of use?",
        [],
        [*evidence, told],
        findings,
        [] if inside else [lacking],
    )


_COMPUTED = (
    "The cases are computed, not measured: they test the surrogate in the place of the solver, and "
    "not the solver against reality."
)
_AGREEMENT = {
    "n": "cases",
    "mean_error_percent": "mean error (%)",
    "rmse": "RMSE",
    "bias": "bias",
    "lower_limit": "lower limit of agreement",
    "upper_limit": "upper limit of agreement",
    "slope": "slope through the origin",
    "r2": "R2, 1 - SSE/SST",
}
