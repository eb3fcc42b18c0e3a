"""What the model is for: question of interest, context of use, model risk."""

from __future__ import annotations

from surrogate.report import digits
from surrogate.report.dossier.evidence import Chapter, Evidence
from surrogate.report.dossier.known import Known

LEVELS = ("low", "medium", "high")


def question(known: Known) -> Chapter:
    """The decision that the model is to help with."""
    told = known.told("question")
    asked = [f"The study asks: {known.about}"] if known.about else []
    return Chapter(
        "question",
        "Question of interest",
        "The decision that the model is to help with.",
        [told] * bool(told) + asked,
        missing=known.lacks("question"),
    )


def context(known: Known) -> Chapter:
    """What the model says, and over which ranges."""
    told = known.told("context")
    ranges = [
        Evidence(
            f"{p.name} varies",
            digits.with_unit(p.described, p.unit),
            known.check,
            known.place(f"parameters.{p.name}"),
        )
        for p in known.space.parameters
    ]
    return Chapter(
        "context",
        "Context of use",
        "What the model says, for what and whom, and what else the decision rests on.",
        [told] * bool(told),
        ranges,
        missing=known.lacks("context"),
    )


def risk(known: Known) -> Chapter:
    """Influence times consequence."""
    influence, consequence = known.told("influence"), known.told("consequence")
    said = [f"Influence of the model: {influence}"] * bool(influence)
    said += [f"Consequence of a wrong decision: {consequence}"] * bool(consequence)
    a, b = _level(influence), _level(consequence)
    if a is not None and b is not None:
        said.append(f"Model risk: {a} x {b} = {a * b} of 9 (low 1, high 3).")
    return Chapter(
        "risk",
        "Model risk",
        "Influence of the model on the decision times the consequence of a wrong decision.",
        said,
        missing=known.lacks("influence", "consequence"),
    )


def _level(words: str) -> int | None:
    """1 to 3 for words that begin with low, medium or high."""
    first = words.lower().split(maxsplit=1)[:1]
    word = first[0].strip(".,:;") if first else ""
    return LEVELS.index(word) + 1 if word in LEVELS else None
