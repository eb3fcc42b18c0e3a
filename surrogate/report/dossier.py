"""The evidence of credibility of a study, under the headings of ASME V&V 40 (2018).

What the study has computed is taken from its summary and runs; what only people know, from the
section `credibility:` of the study file. What neither tells is marked as missing.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.report import digits
from surrogate.report.content import POOR_COVERAGE, POOR_Q2, Content
from surrogate.report.evidence import Chapter, Evidence, Figures
from surrogate.report.page import Page, assembled
from surrogate.space.space import Space

LEVELS = ("low", "medium", "high")


@dataclass(frozen=True)
class Dossier:
    """What a dossier is made from.

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
    def chapters(self) -> list[Chapter]:
        """All headings, in order."""
        before = [
            self._question(),
            self._context(),
            self._risk(),
            self._code(),
            self._calculation(),
            self._validation(),
            self._uncertainty(),
            self._applicability(),
        ]
        return [*before, _adequacy(before)]

    def page(self) -> Page:
        """The dossier as one page that opens without a network."""
        title = f"{self.name}: credibility"
        return assembled(self._content, [one.section() for one in self.chapters], title)

    def markdown(self) -> str:
        """The dossier as Markdown."""
        head = f"# {self.name}: credibility\n\nHeadings of ASME V&V 40 (2018)."
        return "\n\n".join([head, *(one.markdown() for one in self.chapters)]) + "\n"

    @property
    def _content(self) -> Content:
        return Content(self.name, self.space, self.runs, self.about)

    @property
    def _figures(self) -> Figures:
        return Figures(self.summary)

    @property
    def _run(self) -> str:
        return f"surrogate run {self.file}"

    @property
    def _validate(self) -> str:
        return f"surrogate validate {self.file}"

    def _told(self, word: str) -> str:
        return str(self.credibility.get(word) or "").strip()

    def _lacks(self, *words: str) -> list[str]:
        return [_WANTED[word] for word in words if not self.credibility.get(word)]

    def _claims(self, word: str) -> tuple[list[str], list[Evidence]]:
        """What the study file says of a verification: plain statements, and claims with figures."""
        listed: Sequence[Mapping[str, str]] = self.credibility.get(word) or ()
        plain = [one["claim"] for one in listed if not (one.get("command") or one.get("result"))]
        checked = [
            Evidence(
                one["claim"],
                one.get("result", ""),
                one.get("command", ""),
                f"{Path(self.file).name}: credibility.{word}[{k}]",
            )
            for k, one in enumerate(listed)
            if one.get("command") or one.get("result")
        ]
        return plain, checked

    def _question(self) -> Chapter:
        told = self._told("question")
        asked = [f"The study asks: {self.about}"] if self.about else []
        return Chapter(
            "question",
            "Question of interest",
            "The decision that the model is to help with.",
            [told] * bool(told) + asked,
            missing=self._lacks("question"),
        )

    def _context(self) -> Chapter:
        told = self._told("context")
        ranges = [
            Evidence(
                f"{p.name} varies",
                digits.with_unit(p.described, p.unit),
                f"surrogate check {self.file}",
                f"{Path(self.file).name}: parameters.{p.name}",
            )
            for p in self.space.parameters
        ]
        return Chapter(
            "context",
            "Context of use",
            "What the model says, for what and whom, and what else the decision rests on.",
            [told] * bool(told),
            ranges,
            missing=self._lacks("context"),
        )

    def _risk(self) -> Chapter:
        influence, consequence = self._told("influence"), self._told("consequence")
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
            missing=self._lacks("influence", "consequence"),
        )

    def _code(self) -> Chapter:
        plain, checked = self._claims("code_verification")
        attributes = self.runs.attrs
        versions = json.loads(str(attributes.get("versions", "{}")))
        solver = f"{attributes.get('solver', '')} {attributes.get('solver_version', '')}"
        own = [
            Evidence("solver and its version", solver, self._run, "runs.nc: solver_version"),
            Evidence(
                "versions of the packages",
                ", ".join(f"{name} {version}" for name, version in versions.items()),
                self._run,
                "runs.nc: versions",
            ),
        ]
        return Chapter(
            "code-verification",
            "Code verification",
            "Does the code solve the equations that it says it solves?",
            plain,
            [*checked, *own],
            missing=self._lacks("code_verification"),
        )

    def _calculation(self) -> Chapter:
        plain, checked = self._claims("calculation_verification")
        lost = _lost(self.summary["runs"])
        region = self.summary.get("failures")
        findings = [f"{lost} runs have no answer."] if lost else []
        findings += [str(region["sentence"])] if region else []
        return Chapter(
            "calculation-verification",
            "Calculation verification",
            "How far is a computed answer from the exact one: mesh, iterations, and here the "
            "surrogate in place of the solver?",
            plain,
            [*checked, *self._history(), *self._held_out()],
            [*findings, *self._poor()],
            self._lacks("calculation_verification"),
        )

    def _history(self) -> Iterator[Evidence]:
        """Runs by status, seeds, repeatability."""
        again = f"{self._run} --fresh"
        counts = {word: count for word, count in self.summary["runs"].items() if count}
        told = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in counts.items())
        yield Evidence("runs of the solver", told, again, "summary.json: runs")
        seeds = json.loads(str(self.runs.attrs.get("seeds", "{}")))
        if seeds:
            shown = ", ".join(f"{name} {seed}" for name, seed in seeds.items())
            yield Evidence("seeds of the designs", shown, again, "runs.nc: seeds")
        same = self._content.deterministic
        words = "same inputs give the same answer" if same else "answers scatter"
        yield Evidence("repeatability of the solver", words, again, "runs.nc: deterministic")
        for output, scatter in (self.summary.get("replicates") or {}).items():
            place = f"summary.json: replicates.{output}.std"
            std = digits.with_unit(digits.figure(scatter["std"]), self._unit(output, "std"))
            yield Evidence(f"{output}: scatter of replicates", std, again, place)

    def _held_out(self) -> Iterator[Evidence]:
        """Errors of the best surrogates on runs that they have not seen."""
        for name, output, i, j in self._best():
            for key, words in _ERRORS.items():
                value, place = self._figures.at("comparison", key, i, j)
                if value is not None:
                    claim = f"{output}, surrogate {name}: {words}"
                    number = digits.score(value) if key.startswith("q2") else digits.figure(value)
                    shown = digits.with_unit(number, self._unit(output, key))
                    yield Evidence(claim, shown, self._run, place)

    def _unit(self, output: str, key: str) -> str:
        """Unit of a figure of an output; none of a share or a count."""
        bare = key.startswith(("q2", "r2", "n", "slope", "mean_error_percent"))
        return "" if bare else self._content.unit(output)

    def _best(self) -> Iterator[tuple[str, str, int, int]]:
        """Best surrogate of each output, with their numbers in the tables."""
        surrogates = self._figures.names("comparison", "surrogate")
        best = self._figures.names("comparison", "best")
        for j, output in enumerate(self._figures.names("comparison", "output")):
            if best[j] in surrogates:
                yield best[j], output, surrogates.index(best[j]), j

    def _poor(self) -> Iterator[str]:
        for name, output, i, j in self._best():
            tested, _ = self._figures.at("comparison", "q2_test", i, j)
            value = self._figures.at("comparison", "q2_cv", i, j)[0] if tested is None else tested
            if value is not None and value < POOR_Q2:
                yield f"{output}: the best surrogate, {name}, is poor (Q2 {digits.figure(value)})."

    def _validation(self) -> Chapter:
        labels = self._figures.names("validation", "model")
        outputs = self._figures.names("validation", "output")
        cases = (self.summary.get("validation") or {}).get("attributes", {}).get("cases", "")
        evidence = [
            item
            for k, output in enumerate(outputs)
            for i, model in enumerate(labels)
            for item in self._agreement(model, output, i, k)
        ]
        said = [f"Cases: {cases}."] * bool(cases)
        return Chapter(
            "validation",
            "Validation",
            "Do the model's answers agree with reality, or with a better model?",
            said,
            evidence,
            [_COMPUTED] if evidence and self.computed else [],
            [] if evidence else [_WANTED["validation"]],
        )

    def _agreement(self, model: str, output: str, i: int, k: int) -> Iterator[Evidence]:
        for key, words in _AGREEMENT.items():
            value, place = self._figures.at("validation", key, i, k)
            low, _ = self._figures.at("validation", f"{key}_low", i, k)
            high, _ = self._figures.at("validation", f"{key}_high", i, k)
            if value is None:
                continue
            shown = digits.number(value) if key == "n" else digits.figure(value)
            if low is not None and high is not None:
                shown += f" [{digits.figure(low)}, {digits.figure(high)}]"
            shown = digits.with_unit(shown, self._unit(output, key))
            yield Evidence(f"{output}, {model}: {words}", shown, self._validate, place)

    def _uncertainty(self) -> Chapter:
        evidence, findings = [], []
        for name, output, i, j in self._best():
            value, place = self._figures.at("comparison", "coverage_95", i, j)
            if value is not None:
                claim = f"{output}, {name}: share of held-out runs inside their 95 % intervals"
                evidence.append(Evidence(claim, digits.percent(value), self._run, place))
                findings += [_holds_little(output, name, "held-out runs", value)]
        for k, output in enumerate(self._figures.names("validation", "output")):
            for i, model in enumerate(self._figures.names("validation", "model")):
                value, place = self._figures.at("validation", "coverage_95", i, k)
                if value is not None:
                    claim = f"{output}, {model}: share of cases inside their 95 % intervals"
                    evidence.append(Evidence(claim, digits.percent(value), self._validate, place))
                    findings += [_holds_little(output, model, "cases", value)]
        evidence += self._indices()
        return Chapter(
            "uncertainty",
            "Uncertainty quantification",
            "What do uncertain inputs and the surrogate itself do to the answer?",
            [],
            evidence,
            [words for words in findings if words],
            [] if evidence else [_WANTED["uncertainty"]],
        )

    def _indices(self) -> Iterator[Evidence]:
        """Total indices (or Shapley effects) with their intervals."""
        key = next((k for k in ("total", "shapley") if self._figures.names("sensitivity", k)), "")
        for j, output in enumerate(self._figures.names("sensitivity", "output") if key else ()):
            for k, name in enumerate(self._figures.names("sensitivity", "parameter")):
                value, place = self._figures.at("sensitivity", key, j, k)
                low, _ = self._figures.at("sensitivity", f"{key}_low", j, k)
                high, _ = self._figures.at("sensitivity", f"{key}_high", j, k)
                if value is not None:
                    shown = digits.with_interval(value, low, high)
                    claim = f"{output}: {key} index of {name}"
                    yield Evidence(claim, shown, self._run, place)

    def _applicability(self) -> Chapter:
        inside = (self.summary.get("validation") or {}).get("inside", {}).get("values", [])
        evidence, findings = [], []
        if inside:
            told = f"{sum(inside)} of {len(inside)}"
            place = "summary.json: validation.inside.values"
            claim = "validation cases inside the ranges"
            evidence.append(Evidence(claim, told, self._validate, place))
            if not all(inside):
                findings.append(
                    f"{len(inside) - sum(inside)} of {len(inside)} cases lie outside the ranges "
                    "and were left out: nothing is known of the model there."
                )
        evidence.append(
            Evidence(
                "a prediction says whether its inputs lie inside the ranges",
                "inside, outside, or far from the rows of a table",
                f"surrogate predict {self.file} {self._middle()}",
                "--json: inside, extrapolated",
            )
        )
        return Chapter(
            "applicability",
            "Applicability",
            "Is the evidence about the conditions of the context of use?",
            [],
            evidence,
            findings,
            [] if inside else [_WANTED["applicability"]],
        )

    def _middle(self) -> str:
        """Inputs amid their ranges, as words of the command."""
        middle = self.space.decode(np.zeros((1, self.space.size)))
        return " ".join(
            f"{name}={digits.number(values[0]) if not isinstance(values[0], str) else values[0]}"
            for name, values in middle.items()
        ).replace(digits.MINUS, "-")


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


def _lost(counts: Mapping[str, int]) -> int:
    return sum(count for status, count in counts.items() if status != "ok")


def _level(words: str) -> int | None:
    """1 to 3 for words that begin with low, medium or high."""
    first = words.lower().split(maxsplit=1)[:1]
    word = first[0].strip(".,:;") if first else ""
    return LEVELS.index(word) + 1 if word in LEVELS else None


def _holds_little(output: str, model: str, what: str, share: float) -> str:
    if share >= POOR_COVERAGE:
        return ""
    return (
        f"{output}, {model}: the 95 % intervals hold {digits.percent(share)} of the {what}; they "
        "are too narrow there."
    )


_COMPUTED = (
    "The cases are computed, not measured: they test the surrogate in the place of the solver, and "
    "not the solver against reality."
)
_ERRORS = {
    "q2_test": "Q2 on held-out runs",
    "rmse_test": "RMSE on held-out runs",
    "max_error_test": "largest error on held-out runs",
    "q2_cv": "Q2, cross-validated",
    "rmse_cv": "RMSE, cross-validated",
}
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
_WANTED = {
    "question": "the question of interest (credibility: question)",
    "context": "the context of use (credibility: context)",
    "influence": "the influence of the model on the decision (credibility: influence)",
    "consequence": "the consequence of a wrong decision (credibility: consequence)",
    "code_verification": "checks of the solver's code (credibility: code_verification)",
    "calculation_verification": "numerical error of the solver "
    "(credibility: calculation_verification)",
    "validation": "a comparison with measurements or a better model (validation: cases)",
    "uncertainty": "intervals and indices (designs: test, sensitivity)",
    "applicability": "cases to tell where the context of use lies (validation: cases)",
}
