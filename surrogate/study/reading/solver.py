"""From the words of a study to its solver and the outputs that are kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from surrogate.errors import nearest
from surrogate.runs.identity import SolverSpec
from surrogate.runs.names import name_mistakes
from surrogate.solver import Input, Output, Solver
from surrogate.space.space import Space
from surrogate.stages.plugin import call
from surrogate.study import plugins
from surrogate.study.kinds import check_kind
from surrogate.study.options import option_mistakes
from surrogate.study.parts.inputs import SolverPart
from surrogate.study.reading.building import limited
from surrogate.study.reading.mistakes import Reading
from surrogate.study.solver_factory import SolverFactory

#: Parameters of a solver's constructor that the framework fills in; they are not options.
GIVEN_TO_SOLVERS = ("self", "folder")


def solver_of(
    reading: Reading, part: SolverPart | None = None, path: tuple[str, ...] = ("solver",)
) -> tuple[SolverSpec, Solver | None]:
    """The study's solver, or that of `part`, built once here to learn its inputs and outputs."""
    part = part or reading.part.solver or SolverPart(name="unnamed", options={})
    spec = SolverSpec(part.name, SolverFactory(part.name, reading.folder), part.options)
    if reading.is_broken(*path):
        return spec, None
    with reading.mistakes_at(*path, "name"):
        found = plugins.load(plugins.SOLVERS, part.name, reading.folder)
        check_kind(plugins.SOLVERS, part.name, found)
        path_of_found = plugins.path_of(plugins.SOLVERS, part.name)
        spec = replace(spec, build=SolverFactory(path_of_found, reading.folder))
        mistakes = option_mistakes(found, part.options, GIVEN_TO_SOLVERS)
        reading.add(mistakes, *path, "options")
        solver = None if mistakes else _built(spec, reading, path)
        if solver is not None:
            return spec, solver
        # Options that are right, or none, may build a solver to check the rest of the study with.
        wrong = {mistake.path[0] for mistake in mistakes if mistake.path}
        sound = {name: value for name, value in part.options.items() if name not in wrong}
        aside = replace(reading, mistakes=[])
        for options in (sound, {}) if mistakes else ({},) if part.options else ():
            solver = _built(replace(spec, options=options), aside, path)
            if solver is not None:
                return spec, solver
    return spec, None


def _built(spec: SolverSpec, reading: Reading, path: tuple[str, ...]) -> Solver | None:
    with reading.mistakes_at(*path, "options"):
        failure = f"solver '{spec.name}' cannot be built"
        with limited(failure, reading.part.execution.timeout):
            solver = call(failure, lambda: spec.solver)
        if isinstance(solver, Solver):
            described = (("inputs", solver.inputs, Input), ("outputs", solver.outputs, Output))
            mistakes = [
                f"'{spec.name}' is not a solver: its {what} must map names to "
                f"surrogate.solver.{kind.__name__}"
                for what, given, kind in described
                if not isinstance(given, Mapping)
                or not all(isinstance(one, kind) for one in given.values())
            ]
            for sentence in mistakes:
                reading.wrong(sentence, *path, "name")
            return None if mistakes else solver
        lacking = [name for name in ("inputs", "outputs", "version") if not hasattr(solver, name)]
        reading.wrong(
            f"'{spec.name}' is not a solver: it has no {', '.join(lacking) or '__call__'}",
            *path,
            "name",
        )
    return None


def owner(solver: Solver) -> str:
    """Who has the inputs and outputs that messages speak of."""
    return "the table" if getattr(solver, "recorded", False) else "the solver"


def outputs_of(reading: Reading, solver: Solver, space: Space | None) -> tuple[str, ...]:
    """Names of the outputs that are kept."""
    names = reading.part.outputs or tuple(solver.outputs)
    for index, name in enumerate(names):
        if name not in solver.outputs:
            reading.wrong(
                f"{owner(solver)} has no output '{name}'; {nearest(name, solver.outputs)}",
                "outputs",
                index,
            )
    kept = {name: solver.outputs[name] for name in names if name in solver.outputs}
    if space is not None:
        for sentence in name_mistakes(space, kept):
            reading.wrong(sentence, "outputs", on_key=True)
    return tuple(kept)
