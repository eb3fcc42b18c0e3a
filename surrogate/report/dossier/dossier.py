"""All chapters of the evidence of credibility, as a page and as Markdown.

What the study has computed is taken from its summary and runs; what only people know, from the
section `credibility:` of the study file. What neither tells is marked as missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from surrogate.report.dossier.evidence import Chapter
from surrogate.report.dossier.known import Known
from surrogate.report.dossier.purpose import context, question, risk
from surrogate.report.dossier.uncertainty import uncertainty
from surrogate.report.dossier.validation import applicability, validation
from surrogate.report.dossier.verification import calculation, code
from surrogate.report.page import Page, assembled

CHAPTERS = (question, context, risk, code, calculation, validation, uncertainty, applicability)


@dataclass(frozen=True)
class Dossier:
    """The evidence of credibility of a study."""

    known: Known

    @cached_property
    def chapters(self) -> list[Chapter]:
        """All headings, in order."""
        before = [chapter(self.known) for chapter in CHAPTERS]
        return [*before, _adequacy(before)]

    @property
    def title(self) -> str:
        """Its name."""
        return f"{self.known.name}: credibility"

    def page(self) -> Page:
        """The dossier as one page that opens without a network."""
        sections = [one.section() for one in self.chapters]
        return assembled(self.known.content, sections, self.title)

    def markdown(self) -> str:
        """The dossier as Markdown."""
        head = f"# {self.title}\n\nHeadings of ASME V&V 40 (2018)."
        return "\n\n".join([head, *(one.markdown() for one in self.chapters)]) + "\n"


def _adequacy(before: Sequence[Chapter]) -> Chapter:
    """What is there, what is missing, and what speaks against the model."""
    said = [
        "Whether this evidence is enough for the risk is decided by people, not by this page.",
        f"{sum(len(one.evidence) for one in before)} figures stand above; "
        f"{sum(len(one.missing) for one in before)} things are missing.",
    ]
    return Chapter(
        "adequacy",
        "Adequacy",
        "Is the evidence sufficient for the context of use and the risk?",
        said,
        findings=[f"{one.title}: {words}" for one in before for words in one.findings],
        missing=[f"{one.title}: {words}" for one in before for words in one.missing],
    )
