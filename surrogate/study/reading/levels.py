"""From the words of `levels:` to the solvers of several levels of fidelity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from surrogate.designs.design import Design
from surrogate.errors import KeyPath, nearest
from surrogate.runs.dataset import LEVEL
from surrogate.runs.identity import SolverSpec
from surrogate.runs.levels import spec_of
from surrogate.solver import Solver
from surrogate.study.parts.adaptive import AdaptivePart
from surrogate.study.parts.inputs import SolverPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.solver import solver_of


def levels_of(
    reading: Reading, spec: SolverSpec, solver: Solver | None
) -> tuple[SolverSpec, Solver | None]:
    """One solver of all levels, and that of the truth; those given without `levels:`."""
    base, parts = reading.part.solver, reading.part.levels
    if not parts or base is None:
        return spec, solver
    before = len(reading.mistakes)
    specs, solvers = {}, {}
    for name, part in parts.items():
        options = part.options if part.solver else {**base.options, **part.options}
        own = SolverPart(name=part.solver or base.name, options=options)
        specs[name], built = solver_of(reading, own, ("levels", name))
        if built is not None:
            solvers[name] = built
    if len(parts) < 2 and not any(reading.is_broken("levels", name) for name in parts):
        reading.wrong("name at least two levels, cheapest first", "levels", on_key=True)
    if reading.part.data is not None:
        reading.wrong(
            "levels are of solvers, and data: has rows of the truth only; leave one out",
            "levels",
            on_key=True,
        )
    if len(solvers) < len(parts):
        return spec, solver
    truth = list(parts)[-1]
    for name in parts:
        for sentence in _disagreements(name, solvers[name], solvers[truth], reading):
            reading.wrong(sentence, "levels", name)
    if len(reading.mistakes) > before:
        return spec, solvers[truth]
    return spec_of(specs), solvers[truth]


def _disagreements(name: str, one: Solver, truth: Solver, reading: Reading) -> Iterator[str]:
    """What keeps a level from answering in place of the truth."""
    if LEVEL in one.inputs:
        yield f"its solver has an input '{LEVEL}', which is the word for levels of fidelity"
    if getattr(one, "told", False) or getattr(one, "recorded", False):
        yield "its answers are told, not computed; levels need solvers that run"
    for what, own, known in (
        ("input", one.inputs, truth.inputs),
        ("output", one.outputs, truth.outputs),
    ):
        for key in own.keys() & known.keys():
            if own[key].unit != known[key].unit:
                yield (
                    f"{what} '{key}' is in {own[key].unit or '1'}, of the last level in "
                    f"{known[key].unit or '1'}; levels must use the same units"
                )
    for key in reading.part.outputs or tuple(truth.outputs):
        if key in truth.outputs and key not in one.outputs:
            yield (
                f"its solver has no output '{key}'; name under outputs: only those that all "
                "levels have"
            )


def check_nested(reading: Reading, designs: Mapping[str, Design]) -> None:
    """Levels that a nested design names must be those of the study, in their order."""
    known = list(reading.part.levels)
    for name in designs:
        part = reading.part.designs.get(name)
        path: KeyPath = ("designs", name)
        if isinstance(part, AdaptivePart):
            part, path = part.initial, (*path, "initial")
        named = None if part is None else part.options.get("runs")
        if not isinstance(named, Mapping) or reading.is_broken("levels"):
            continue
        path = (*path, "runs")
        if not known:
            reading.wrong("runs name levels of fidelity, but the study has no levels:", *path)
            continue
        unknown = [level for level in named if level not in known]
        for level in unknown:
            reading.wrong(f"level '{level}' is unknown; {nearest(level, known)}", *path)
        if not unknown and list(named) != known:
            reading.wrong(
                f"runs name {', '.join(named)}; name all levels as under levels:, "
                f"{', '.join(known)}",
                *path,
            )
    if known and reading.part.replicates > 1:
        reading.wrong("levels of fidelity have no replicates; leave one out", "replicates")
