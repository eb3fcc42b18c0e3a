"""The page: sections in order, one template, one file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from surrogate.portable.joined import bare, bare_style
from surrogate.report import digits
from surrogate.report.blocks import Section, anchor
from surrogate.report.content import Content
from surrogate.report.embedding import script_json
from surrogate.report.sections import (
    accuracy,
    adaptive,
    calibration,
    designs,
    effects,
    explore,
    fields,
    indices,
    learning,
    parameters,
    provenance,
    reliability,
    runs,
    screening,
    solve,
    summary,
    validation,
)
from surrogate.runs.files import write_text

_LOADER = PackageLoader("surrogate.report", ".")


@dataclass(frozen=True)
class Page:
    """A finished report: `html` needs nothing but itself."""

    html: str

    def save(self, path: str | Path) -> Path:
        """Write the page whole or not at all, and return its path."""
        write_text(path, self.html)
        return Path(path)


def build(content: Content, only: str = "") -> Page:
    """The report of a study as one HTML page that opens without a network.

    only: anchor of the one section to show; provenance stands under it.
    """
    sections = [
        section
        for section in _sections(content)
        if not only or section.anchor in (only, "provenance")
    ]
    return assembled(content, sections, content.name)


def assembled(content: Content, sections: Sequence[Section], title: str) -> Page:
    """A page of these sections about the runs of a study."""
    return rendered(sections, title, _made(content), runs.for_pointing(content))


def rendered(
    sections: Sequence[Section], title: str, made: str, pointed: Mapping[str, str] | None = None
) -> Page:
    """A page of these sections in the style of the report.

    made: from what, under the title. pointed: run number -> what its marks tell.
    """
    environment = _environment()
    return Page(
        environment.get_template("page.html").render(
            name=title,
            sections=sections,
            anchors={section.anchor for section in sections},
            style=_part(environment, "style.css"),
            script=_part(environment, "behaviour.js"),
            made=made,
            runs=script_json(pointed or {}),
        )
    )


@cache
def _environment() -> Environment:
    """Where the template lies; read and compiled once."""
    environment = Environment(
        loader=_LOADER,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["parted"] = _parted
    return environment


def _sections(content: Content) -> Iterator[Section]:
    """The answer, what it rests on output by output, then the designs and runs behind it."""
    yield summary.section(content)
    yield from explore.sections(content)
    for output in content.outputs:
        blocks = [
            *accuracy.blocks(content, output),
            *fields.blocks(content, output),
            *effects.blocks(content, output),
            *indices.blocks(content, output),
        ]
        title = f"Output {digits.labelled(output, content.unit(output))}"
        if blocks:
            yield Section(anchor("output", output), title, tuple(blocks))
    if content.validation is not None:
        yield validation.section(content.validation)
    yield screening.section(content)
    if content.adaptive:
        yield adaptive.section(content.adaptive)
    if content.learning is not None:
        yield learning.section(content, content.learning)
    if content.solve:
        yield solve.section(content)
    if content.reliability:
        yield reliability.section(content)
    if content.calibration is not None:
        yield calibration.section(content.calibration)
    yield parameters.section(content)
    yield designs.section(content)
    yield runs.section(content)
    yield provenance.section(content)


def _made(content: Content) -> str:
    """From what, and when: `177 runs of leg_bandage, 7 inputs, 28 November 2026`."""
    said = digits.quantity(len(content.ok), "run")
    solver = str(content.runs.attrs.get("solver", ""))
    said += f" of {'table ' if content.recorded else ''}{solver}" if solver else ""
    said += f", {digits.quantity(content.space.size, 'input')}"
    try:
        day = datetime.fromisoformat(str(content.runs.attrs.get("created", "")))
    except ValueError:
        return said
    return f"{said}, {day.day} {day:%B %Y}"


def _part(environment: Environment, name: str) -> Markup:
    """A file of this folder; ours, so nothing in it needs escaping."""
    text = _LOADER.get_source(environment, name)[0]
    return Markup(bare_style(text) if name.endswith(".css") else bare(text))


def _parted(words: str) -> Markup:
    """Words that may be broken behind underscores where there is no room, but not at hyphens."""
    return Markup(" ").join(
        Markup('<span class="one">{}</span>').format(word)
        if "-" in word
        else Markup("_<wbr>").join(word.split("_"))
        for word in words.split(" ")
    )
