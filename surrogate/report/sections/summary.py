"""The first screen: the question, the answer for each output, the decision, the warnings."""

from __future__ import annotations

from surrogate.report import digits
from surrogate.report.blocks import Answer, Block, Points, Section, Text
from surrogate.report.content import Content
from surrogate.report.sections import calibration, screening
from surrogate.report.sections.validation import verdicts
from surrogate.report.sections.verdict import verdict
from surrogate.report.sections.warnings import warnings
from surrogate.sensitivity.screening import Screening


def section(content: Content) -> Section:
    """What a meeting needs to decide."""
    blocks: list[Block] = []
    if content.about:
        blocks.append(Text(content.about, "question"))
    warned = warnings(content)
    if content.outputs:
        blocks.append(Answer(tuple(verdict(content, output) for output in content.outputs)))
    if content.screening is not None and len(content.outputs) > 1:
        blocks.append(Text(f"For all outputs: {decided(content.screening)}", "lead"))
    blocks += [
        Text(f"Design {name}: {digits.squared(str(one.outcome))}.", "lead")
        for name, one in content.adaptive.items()
    ]
    blocks += [Text(f"Goal {name}: {found}", "lead") for name, found in content.solve.items()]
    if content.calibration is not None:
        blocks.append(Text(calibration.answer(content.calibration), "lead"))
    if content.validation is not None:
        blocks += [
            Text(f"Validation of {output}: closest is {model}. {how}")
            for output, model, how in verdicts(content.validation)
        ]
    if not content.fits:
        blocks.append(Text("The study asks for no surrogate; the report shows its runs.", "note"))
    if warned:
        blocks.append(Points(tuple(warned), "warning"))
    else:
        blocks.append(
            Text("No warnings: no failed run, no poor surrogate, no refused index.", "good")
        )
    return Section("answer", "Answer", tuple(blocks))


def decided(decision: Screening) -> str:
    """What may be frozen, and the share of the variance that the rest explains."""
    frozen = screening.may_be_frozen(decision)
    if decision.refused or not decision.freeze:
        return f"{frozen}."
    several = len(decision.variance_kept) > 1
    kept = [
        f"{screening.share_kept(kept)} of the variance" + (f" of {kept.output}" if several else "")
        for kept in decision.variance_kept
    ]
    return f"{frozen}; the other inputs explain {digits.listing(kept)}."
