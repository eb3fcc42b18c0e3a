"""What a dossier is made from, and how its parts ask for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.dossier.evidence import Evidence, Figures
from surrogate.space.space import Space


@dataclass(frozen=True)
class Known:
    """What the study has computed, and what only people know.

    file         the study file, as it was given to the command
    credibility  words of its section `credibility:`; `code_verification` and
                 `calculation_verification` are lists of {claim, command, result}
    summary      the content of summary.json
    computed     True when the cases of validation are runs of a solver, not measurements
    """

    name: str
    about: str
    file: str
    credibility: Mapping[str, Any]
    space: Space
    runs: xr.Dataset
    summary: Mapping[str, Any]
    computed: bool = False

    @property
    def content(self) -> Content:
        """The study as a page shows it."""
        return Content(self.name, self.space, self.runs, self.about)

    @property
    def figures(self) -> Figures:
        """The figures of summary.json."""
        return Figures(self.summary)

    @property
    def run(self) -> str:
        """The command that makes the runs and what follows from them."""
        return f"surrogate run {self.file}"

    @property
    def check(self) -> str:
        """The command that reads the study file."""
        return f"surrogate check {self.file}"

    @property
    def validate(self) -> str:
        """The command that compares with measurements."""
        return f"surrogate validate {self.file}"

    @property
    def predict(self) -> str:
        """The command that predicts, amid the ranges of the inputs."""
        middle = self.space.decode(np.zeros((1, self.space.size)))
        words = " ".join(
            f"{name}={digits.number(values[0]) if not isinstance(values[0], str) else values[0]}"
            for name, values in middle.items()
        ).replace(digits.MINUS, "-")
        return f"surrogate predict {self.file} {words}"

    def place(self, key: str) -> str:
        """A place in the study file."""
        return f"{Path(self.file).name}: {key}"

    def told(self, word: str) -> str:
        """What the section `credibility:` says; empty without."""
        return str(self.credibility.get(word) or "").strip()

    def lacks(self, *words: str) -> list[str]:
        """What of these the section does not say, with the words that would."""
        return [_WANTED[word] for word in words if not self.credibility.get(word)]

    def claims(self, word: str) -> tuple[list[str], list[Evidence]]:
        """What the study file says of a verification: plain statements, and claims with figures."""
        listed: Sequence[Mapping[str, str]] = self.credibility.get(word) or ()
        plain = [one["claim"] for one in listed if not (one.get("command") or one.get("result"))]
        checked = [
            Evidence(
                one["claim"],
                one.get("result", ""),
                one.get("command", ""),
                self.place(f"credibility.{word}[{k}]"),
            )
            for k, one in enumerate(listed)
            if one.get("command") or one.get("result")
        ]
        return plain, checked

    def best(self) -> Iterator[tuple[str, str, int, int]]:
        """Best surrogate of each output, with their numbers in the tables."""
        surrogates = self.figures.names("comparison", "surrogate")
        best = self.figures.names("comparison", "best")
        for j, output in enumerate(self.figures.names("comparison", "output")):
            if best[j] in surrogates:
                yield best[j], output, surrogates.index(best[j]), j

    def unit(self, output: str, key: str) -> str:
        """Unit of a figure of an output; none of a share or a count."""
        bare = key.startswith(("q2", "r2", "n", "slope", "mean_error_percent"))
        return "" if bare else self.content.unit(output)


_WANTED = {
    "question": "the question of interest (credibility: question)",
    "context": "the context of use (credibility: context)",
    "influence": "the influence of the model on the decision (credibility: influence)",
    "consequence": "the consequence of a wrong decision (credibility: consequence)",
    "code_verification": "checks of the solver's code (credibility: code_verification)",
    "calculation_verification": "numerical error of the solver "
    "(credibility: calculation_verification)",
}
