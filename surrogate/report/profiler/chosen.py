"""Which surrogate of each output the profiler shows: the best one that has a portable form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from surrogate.errors import FitError
from surrogate.fitting.fit import Fit
from surrogate.report import digits
from surrogate.report.content import Content


@dataclass(frozen=True)
class Chosen:
    """The surrogate shown of an output, its document, and the best one, which may be another."""

    output: str
    surrogate: str
    fit: Fit
    document: dict[str, Any]
    best: str


def chosen(content: Content) -> list[Chosen]:
    """One for each output of which some surrogate has a portable form."""
    return [one for output in content.outputs if (one := _of_output(content, output))]


def _of_output(content: Content, output: str) -> Chosen | None:
    fits, best = content.fits_of(output), content.best(output)
    if best is None:
        return None
    others = sorted(fits, key=lambda name: -np.nan_to_num(content.q2(name, output), nan=-np.inf))
    for name in dict.fromkeys([best, *others]):
        try:
            return Chosen(output, name, fits[name], fits[name].portable(), best)
        except FitError:
            continue
    return None


def notes(content: Content, shown: list[Chosen]) -> list[str]:
    """A sentence for each output that is not shown by its best surrogate, or not at all."""
    known = {one.output: one for one in shown}
    said = []
    for output in content.outputs:
        best, one = content.best(output), known.get(output)
        if one is None and best is not None:
            said.append(f"{output} is not shown: none of its surrogates has a portable form.")
        elif one is not None and one.surrogate != best:
            worth = [digits.score(content.q2(name, output)) for name in (one.surrogate, one.best)]
            said.append(
                f"{output} is shown by {one.surrogate} (Q² {worth[0]}); the best surrogate, {best} "
                f"(Q² {worth[1]}), does not run in a browser."
            )
    return said
