"""Answers that people or other programs bring: a solver that is told and never called.

::

    solver:
      name: laboratory
      options:
        inputs:
          temperature: {unit: degC, range: [150, 250]}
          pressure:    {unit: bar, nominal: 2}
        outputs:
          strength: {unit: MPa}

`surrogate.Campaign` gives the points to measure and takes the answers.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from surrogate.errors import SolverError, StudyError

from . import declared
from .declared import DeclaredInput, DeclaredOutput
from .validated import Strict, placed, validated


class Options(Strict):
    """The options, as `Laboratory` describes them."""

    inputs: dict[str, DeclaredInput]
    outputs: dict[str, DeclaredOutput]
    deterministic: bool = False
    version: str = "1"


class Laboratory:
    """Tests in a laboratory, or a program that somebody else drives: answers are told.

    inputs         name -> {unit, nominal, range or levels, description, source}
    outputs        name -> {unit, description, dims}
    deterministic  true: equal points have the same answer and are asked for once
    version        any text; change it to tell that answers of before do not count any more

    Units, `deterministic` and `version` belong to a run's identity: changed, or with another
    output, the points are asked for again. Raises `StudyError` with all mistakes.
    """

    told = True

    def __init__(
        self,
        inputs: dict[str, Any],
        outputs: dict[str, Any],
        deterministic: bool = False,
        version: str = "1",
    ):
        given = {
            "inputs": inputs,
            "outputs": outputs,
            "deterministic": deterministic,
            "version": version,
        }
        options, mistakes = validated(
            Options, given, {"inputs": DeclaredInput, "outputs": DeclaredOutput}
        )
        mistakes += _mistakes(options)
        if mistakes:
            raise StudyError(*(placed(sentence, given) for sentence in mistakes))
        self.inputs = declared.inputs(options.inputs)
        self.outputs = declared.outputs(options.outputs)
        self.deterministic, self.version = options.deterministic, options.version
        self.identity_options = {
            "inputs": {name: one.unit for name, one in self.inputs.items()},
            "outputs": {
                name: [one.unit, *({dim: one.coordinates[dim]} for dim in one.dims)]
                for name, one in self.outputs.items()
            },
            "deterministic": self.deterministic,
        }

    def __call__(self, **inputs: Any) -> dict[str, Any]:
        """No answer: raises `SolverError`."""
        raise SolverError(
            "the laboratory answers nobody by itself: its answers are told "
            "(surrogate.Campaign: ask, then tell)"
        )


def _mistakes(options: Options) -> Iterable[str]:
    yield from declared.input_mistakes(options.inputs)
    yield from declared.output_mistakes(options.outputs)
    if not options.outputs:
        yield "outputs: is empty; say what is measured"
