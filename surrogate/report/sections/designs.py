"""The designs of experiments: number of runs, points, aliasing."""

from __future__ import annotations

import numpy as np

from surrogate.designs.aliasing import Aliasing
from surrogate.report import digits
from surrogate.report.blocks import (
    Block,
    Cell,
    Figure,
    Figures,
    Fold,
    Head,
    Section,
    Table,
    Text,
    heads,
)
from surrogate.report.content import Content
from surrogate.report.figures.points import mark_of, points_plot
from surrogate.report.parity import rows_learnt

#: Defining words that are written out.
LISTED_WORDS = 7
ROMAN = {3: "III", 4: "IV", 5: "V", 6: "VI", 7: "VII", 8: "VIII"}
SHAPES = {"filled": "filled disc", "hollow": "open disc", "square": "square", "diamond": "diamond"}


def section(content: Content) -> Section:
    """Counts, points, and the alias table of each fraction."""
    blocks: list[Block] = [_counts(content), Figures((_points(content),))]
    for design, aliasing in content.aliasing.items():
        blocks += _aliases(design, aliasing)
    return Section("designs", "Designs of experiments", tuple(blocks))


def roman(resolution: int | float) -> str:
    """A resolution as it is written in the literature."""
    return ROMAN.get(int(resolution), str(int(resolution)))


def _counts(content: Content) -> Table:
    design, ok = content.words("design"), content.ok
    seconds = content.seconds
    rows = []
    for name in content.designs:
        mine = design == name
        spent = np.nansum(seconds[mine]) if np.isfinite(seconds[mine]).any() else np.nan
        rows.append(
            (
                Cell(name),
                Cell(_use(content, mine)),
                Cell(str(mine.sum()), mine.sum()),
                Cell(str((mine & ok).sum())),
                Cell(str((mine & content.failed).sum())),
                Cell(digits.duration(spent)),
            )
        )
    titles = heads("design", "use", "runs", "finished", "failed", "solver time", names=2)
    return Table("Runs of each design.", titles, tuple(rows))


def _use(content: Content, mine: np.ndarray) -> str:
    """`training` or `held out`, told by the fits' own points."""
    from_fits = [fit for by_output in content.fits.values() for fit in by_output.values()]
    if not from_fits:
        return digits.NOTHING
    points = content.coded[mine & content.ok]
    inside = np.any([rows_learnt(fit, points) >= 0 for fit in from_fits], axis=0)
    if not inside.size:
        return digits.NOTHING
    return "training" if inside.all() else "partly training" if inside.any() else "held out"


def _points(content: Content) -> Figure:
    shown = content.shown
    plot = points_plot(
        content.space,
        content.coded[shown],
        content.numbers[shown],
        content.words("design")[shown],
        content.designs,
        content.ok[shown],
    )
    shapes = [f"{SHAPES[mark_of(content.designs, name)]}: {name}" for name in content.designs]
    failed = "; cross: failed run" if content.failed.any() else ""
    return Figure(
        plot,
        "Design points, from the smallest to the largest value of each parameter "
        f"({'; '.join(shapes)}{failed})."
        + f" {shown.sum()} of {len(shown)} runs are drawn."
        * bool(not shown.all()),
        wide=True,
    )


def _aliases(design: str, aliasing: Aliasing) -> list[Block]:
    resolution = aliasing.resolution
    blocks = [
        Text(f"{digits.capital(one.replace(':', ' × '))}.", "note") for one in aliasing.confounded
    ]
    if resolution is None:
        full = Text(f"Design {design} is a full factorial: no effect is aliased.", "note")
        return [full, *blocks]
    chains = tuple(
        (Cell(_effect(first)), Cell(", ".join(map(_effect, others))))
        for first, *others in aliasing.chains
    )
    table = Table(
        f"Alias table of design {design}. Effects in one row are aliased: only their sum can be "
        "estimated. Interactions of three and more parameters are left out.",
        (Head("effect", numeric=False), Head("aliased with", numeric=False)),
        chains,
    )
    words = [
        word.replace("-", digits.MINUS, word.startswith("-"))
        for word in aliasing.defining_words[:LISTED_WORDS]
    ]
    more = len(aliasing.defining_words) - len(words)
    pattern = ", ".join(str(count) for count in aliasing.word_length_pattern)
    told = Text(
        f"Defining relation: I = {' = '.join(words)}{f' = ({more} more)' if more else ''}. "
        f"Defining words of length 3, 4, …: {pattern}."
    )
    return [
        Text(_sentence(design, resolution), "warning" if resolution == 3 else "note"),
        Fold(
            f"Alias table of {design} (resolution {roman(resolution)})",
            (table, told),
            open=len(chains) <= 16,
        ),
        *blocks,
    ]


def _sentence(design: str, resolution: int) -> str:
    named = f"Design {design} has resolution {roman(resolution)}"
    if resolution == 3:
        return (
            f"{named}: main effects are aliased with two-factor interactions. A main effect in "
            "the tables below may be an interaction. A fold-over of the design separates them."
        )
    if resolution == 4:
        return (
            f"{named}: main effects are clear of two-factor interactions. Two-factor "
            "interactions are aliased with one another."
        )
    return f"{named}: main effects and two-factor interactions are clear of one another."


def _effect(effect: str) -> str:
    """An effect as printed: `tension × mu_skin`, with a true minus where the sign turns."""
    return effect.replace("-", digits.MINUS, effect.startswith("-")).replace(":", " × ")
