"""Levels of fidelity: several solvers that answer the same question, cheapest first.

To all that runs a solver they are one, with one more input, `level`, whose nominal value is the
last level, the truth. The identity of a run is that of its own level's solver: a study of that
solver alone asks for the same runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.runs.dataset import LEVEL, at_level, counts, level_names
from surrogate.runs.identity import RunInputs, SolverSpec, canonical
from surrogate.solver import Input, Output, Solver


@dataclass(frozen=True)
class LevelsFactory:
    """Builds the solver of all levels in any process; levels: name -> spec, cheapest first."""

    levels: Mapping[str, SolverSpec]

    def __call__(self, **options: Any) -> Solver:
        """The solver; options are those of the levels and are not looked at."""
        return LevelsSolver(self.levels)


class LevelsSolver:
    """The solvers of all levels as one, with the input `level`.

    It has the inputs and outputs of the truth. A cheaper level is called with those inputs that
    it takes.
    """

    def __init__(self, levels: Mapping[str, SolverSpec]) -> None:
        self.levels, names = levels, tuple(levels)
        self.truth = levels[names[-1]].solver
        level = Input(nominal=names[-1], levels=names, description="level of fidelity")
        self.inputs: Mapping[str, Input] = {**self.truth.inputs, LEVEL: level}
        self.outputs: Mapping[str, Output] = self.truth.outputs
        self.version = self.truth.version

    @property
    def deterministic(self) -> bool:
        """Whether all levels are."""
        return all(spec.deterministic for spec in self.levels.values())

    def __getattr__(self, name: str) -> Any:
        """What the truth offers besides, such as constraints; its scene knows no level."""
        if name.startswith("__") or name == "truth":  # not there while it is unpickled
            raise AttributeError(name)
        found = getattr(self.truth, name)
        if name != "scene":
            return found
        return lambda **inputs: found(**{k: v for k, v in inputs.items() if k != LEVEL})

    def __call__(self, **inputs: Any) -> Mapping[str, Any]:
        """The answer of the level that `level` names; of the truth without it."""
        spec = self.levels[inputs.pop(LEVEL, self.inputs[LEVEL].nominal)]
        return spec.solver(**taken(spec, inputs))


def taken(spec: SolverSpec, call: Mapping[str, Any]) -> RunInputs:
    """The inputs of a level's solver: as called, else its nominal values."""
    return {name: call.get(name, one.nominal) for name, one in spec.solver.inputs.items()}


@dataclass(frozen=True)
class LevelsSpec(SolverSpec):
    """The solvers of all levels as one; name and options are those of the truth."""

    levels: Mapping[str, SolverSpec] = field(default_factory=dict)

    @property
    def truth(self) -> str:
        """The name of the last level."""
        return list(self.levels)[-1]

    @property
    def context(self) -> str:
        """That of the truth."""
        return self.levels[self.truth].context

    def parts(
        self, calls: Sequence[RunInputs]
    ) -> Iterator[tuple[SolverSpec, NDArray[np.intp], list[RunInputs]]]:
        """Each level's solver, the numbers of its calls, and the calls as it is called."""
        own = np.array([call.get(LEVEL, self.truth) for call in calls], dtype=str)
        for name, spec in self.levels.items():
            numbers = np.flatnonzero(own == name)
            yield spec, numbers, [taken(spec, calls[number]) for number in numbers.tolist()]

    def told_of(self, parameters: Sequence[str], call: RunInputs) -> str:
        """What a runs dataset keeps of the levels: the identity of each and its fixed inputs."""
        return canonical(
            [
                {
                    "name": name,
                    "identity": spec.context,
                    "parameters": [p for p in parameters if p in spec.solver.inputs],
                    "fixed_inputs": {
                        k: v for k, v in taken(spec, call).items() if k not in parameters
                    },
                }
                for name, spec in self.levels.items()
            ]
        )


def spec_of(levels: Mapping[str, SolverSpec]) -> LevelsSpec:
    """One solver of several, cheapest first."""
    truth = list(levels.values())[-1]
    return LevelsSpec(truth.name, LevelsFactory(levels), truth.options, levels)


def costs(runs: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Of each level: its runs by status, seconds of a run (median; None) and of all; {} without.

    A point in two designs is one run, and is counted once.
    """
    found = {}
    for name in level_names(runs):
        own = at_level(runs, name)
        _, first = np.unique(own["coded"].values.round(12), axis=0, return_index=True)
        own = own.isel(run=np.sort(first))
        seconds = own["seconds"].values[np.isfinite(own["seconds"].values)]
        found[name] = {
            "runs": counts(own),
            "seconds_each": float(np.median(seconds)) if len(seconds) else None,
            "seconds": float(seconds.sum()),
        }
    return found


def cost_sentences(runs: xr.Dataset) -> list[str]:
    """A sentence for each level: its runs and the solver seconds that they took."""
    sentences = []
    for name, cost in costs(runs).items():
        made = sum(n for status, n in cost["runs"].items() if status != "missing")
        each = cost["seconds_each"]
        took = "" if each is None else f", {each:.3g} s each, {cost['seconds']:.4g} s in all"
        left = cost["runs"]["missing"]
        sentences.append(f"level {name}: {made} runs{took}" + (f"; {left} left" if left else ""))
    return sentences
