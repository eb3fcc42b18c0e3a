"""`surrogate dossier`: the evidence of credibility of a study, as a page and as Markdown."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from surrogate.cli.page import Page
from surrogate.cli.results import analyse
from surrogate.report.dossier import Dossier, Known
from surrogate.runs.files import write_text
from surrogate.study.parts.credibility import CredibilityPart
from surrogate.study.study import Study

NAME = "dossier"


def dossier(study: Study, folder: Path, file: Path) -> Page:
    """Write dossier.html and dossier.md from the stored runs; what is missing comes first.

    file: the study file, as the commands of the dossier shall name it. Raises `ResultsError`
    when nothing was run.
    """
    outcome = analyse(study, folder)
    told = CredibilityPart.model_validate(study.words.get("credibility") or {})
    known = Known(
        study.name,
        study.about,
        file.as_posix(),
        told.model_dump(),
        study.space,
        study.stored(folder),
        outcome.summary,
        _computed(study),
    )
    made = Dossier(known)
    page = made.page().save(folder / f"{NAME}.html")
    write_text(folder / f"{NAME}.md", made.markdown())
    chapters = made.chapters
    lacks = [words for words in chapters[-1].missing]
    parts = [f"missing: {words}" for words in lacks]
    parts.append(f"dossier: {page} and {page.with_suffix('.md')}")
    data = {
        "dossier": str(page),
        "missing": lacks,
        "chapters": [asdict(one) for one in chapters],
    }
    return Page(data, parts)


def _computed(study: Study) -> bool:
    """Whether the cases of validation are runs: of another study, or of a file of runs."""
    rule = study.words.get("validation") or {}
    cases = rule if isinstance(rule, str) else str(rule.get("cases", ""))
    return not cases.endswith((".csv", ".tsv", ".xlsx", ".parquet"))
