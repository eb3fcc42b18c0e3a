"""What a study file says, as objects: a plain description, and what follows from it alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

import numpy as np

from surrogate.adaptive.aim import Rule
from surrogate.calibration.problem import Problem as Calibration
from surrogate.card import Card, Carded, Rows
from surrogate.designs.aliasing import Aliasing
from surrogate.designs.design import Design
from surrogate.execution.backend import cores
from surrogate.execution.shared.work import Shared
from surrogate.reliability.problem import Failure
from surrogate.runs.assembly import physical_columns
from surrogate.runs.identity import SolverSpec, run_inputs
from surrogate.runs.stored import StoredRuns
from surrogate.solver import Output, broken, constraints_of
from surrogate.solving.problem import Problem
from surrogate.space.space import Space
from surrogate.stages.aliasing import aliases
from surrogate.stages.fits import Surrogate
from surrogate.stages.learning import LearningRule
from surrogate.stages.screening import ScreeningRule, nominal_values
from surrogate.stages.sensitivity import SensitivityMethod
from surrogate.stages.yaml_text import write_yaml
from surrogate.study import reading
from surrogate.study.parts.execution import ExecutionPart
from surrogate.study.source import Source
from surrogate.validation.validation import Validation


@dataclass(frozen=True, repr=False)
class Description(Carded):
    """What a study file says, as objects.

    constants are in the solver's units; inputs that are neither parameters nor
    constants keep the solver's nominal value. rules are those of adaptive designs, by name.
    notes tell what was guessed of the study's data and what was left out.
    """

    name: str
    about: str
    spec: SolverSpec
    space: Space
    constants: Mapping[str, float | str]
    outputs: tuple[str, ...]
    designs: Mapping[str, Design]
    rules: Mapping[str, Rule]
    surrogates: Mapping[str, Surrogate]
    sensitivity_method: SensitivityMethod | None
    screening_rule: ScreeningRule | None
    learning_rule: LearningRule | None
    problems: Mapping[str, Problem]
    limits: Mapping[str, Failure]
    execution: ExecutionPart
    stored_runs: tuple[StoredRuns, ...]
    validation: Validation | None
    calibration: Calibration | None
    notes: tuple[str, ...]
    source: Source = field(repr=False, compare=False)

    @property
    def _card(self) -> Card:
        parameters = self.space.parameters
        rows = [(p.name, p.unit, p.described) for p in parameters]
        designs = [(d.name, d.method, d.runs) for d in self.designs.values()]
        cheap = [(s.name, s.method, " + ".join(s.train)) for s in self.surrogates.values()]
        method = self.sensitivity_method
        facts = {
            "about": self.about,
            "solver": self.spec.name,
            "parameters": ", ".join(p.name for p in parameters),
            "outputs": ", ".join(self.outputs),
            "designs": ", ".join(f"{name} ({runs} runs)" for name, _, runs in designs),
            "surrogates": ", ".join(self.surrogates),
            "sensitivity": f"{method.name} of {method.surrogate}" if method else "",
            "results": self.folder.as_posix(),
        }
        tables = (
            Rows("parameters", ("name", "unit", "values"), rows),
            Rows("designs", ("name", "method", "runs"), designs),
            Rows("surrogates", ("name", "method", "training designs"), cheap),
        )
        return Card("Study", self.name, facts, tables)

    def __repr__(self) -> str:
        return self._card.text()

    @property
    def folder(self) -> Path:
        """Where its results go unless the caller says otherwise."""
        return Path("results") / self.name

    @property
    def place(self) -> Path:
        """Where the study file lies; the current folder for a study without a file."""
        return Path(self.source.name).parent

    @property
    def shared(self) -> Shared:
        """How its runs are shared through the results folder."""
        found = reading.starter(self.execution, self._beside)
        return found if isinstance(found, Shared) else Shared()

    @property
    def _beside(self) -> Path | None:
        """Folder of the study file, where its modules lie; None for a study without a file."""
        return self.place.resolve() if self.source.name else None

    @property
    def workers(self) -> int:
        """Processes of this machine for what follows the runs."""
        here = self.execution.executor in ("local", "threads")
        return self.execution.at_once if here and self.execution.at_once else cores()

    @property
    def places(self) -> int:
        """Runs at once, as far as that is known before they begin."""
        return self.execution.at_once or cores()

    def with_surrogates(self, names: Iterable[str]) -> Self:
        """The same study with only these surrogates."""
        return replace(self, surrogates={name: self.surrogates[name] for name in names})

    @property
    def words(self) -> dict[str, Any]:
        """What the study says, as plain data."""
        if self.source.text or self.spec.recorded:
            return dict(self.source.data)
        solver = {"name": self.spec.name, "options": self.spec.plain_options}
        return {**self.source.data, "solver": solver}

    @property
    def text(self) -> str:
        """The study as written, or as YAML when it came as Python data."""
        return self.source.text or write_yaml(self.words)

    @property
    def aliases(self) -> dict[str, Aliasing]:
        """What is confounded with what, for each design that is a regular two-level fraction.

        Of designs whose points would have to be searched for first nothing is known.
        """
        designs = self.designs.items()
        return aliases(self.space, {name: one.coded for name, one in designs if one.at_hand})

    @property
    def broken_constraints(self) -> dict[str, dict[str, int]]:
        """How many points of each design break a constraint of the solver, by its sentence.

        Designs all of whose points keep all constraints are left out, and those whose points
        would have to be searched for first.
        """
        found = {}
        for name, design in self.designs.items() if constraints_of(self.spec.solver) else ():
            if not design.at_hand:
                continue
            columns = physical_columns(self.space, {name: design.coded})
            calls = run_inputs(self.spec, columns, self.constants)
            found[name] = broken(self.spec.solver, calls)
        return {name: counts for name, counts in found.items() if counts}

    @property
    def points(self) -> dict[str, np.ndarray]:
        """Coded points (run, parameter) of each design."""
        return {name: design.coded for name, design in self.designs.items()}

    @property
    def nominal(self) -> dict[str, float | str]:
        """The solver's nominal values of those parameters whose range holds theirs."""
        return nominal_values(self.space, self.spec.solver)

    @property
    def offered(self) -> dict[str, Output]:
        """The outputs that the study keeps, as the solver describes them."""
        return {name: self.spec.solver.outputs[name] for name in self.outputs}

    @property
    def _compared(self) -> tuple[str, ...]:
        """Outputs that validation names; none for all that the cases have."""
        return self.validation.outputs if self.validation else ()
