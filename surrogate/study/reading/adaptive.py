"""From the words of adaptive designs to their rules."""

from __future__ import annotations

import hashlib
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from surrogate.adaptive.aim import ACCURACY, FIGURES, INDEX_WIDTH, Aim, Level, Rule, Until
from surrogate.designs.design import Design
from surrogate.errors import StudyError
from surrogate.runs.identity import SolverSpec, canonical
from surrogate.runs.levels import LevelsSpec
from surrogate.solver import Output, Solver
from surrogate.space import units
from surrogate.space.space import Space
from surrogate.study.parts.adaptive import AdaptivePart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import is_scalar

Signs = tuple[tuple[str, Literal[1, -1]], ...]
#: Keys of an optimum and of a limit, and what they make of `Aim.sign`.
ENDS: Signs = (("minimise", 1), ("maximise", -1))
SIDES: Signs = (("above", 1), ("below", -1))


def rules_of(
    reading: Reading,
    designs: Mapping[str, Design],
    spec: SolverSpec,
    solver: Solver,
    space: Space | None,
    outputs: Iterable[str],
    constants: Mapping[str, float | str],
) -> dict[str, Rule]:
    """The rule of each adaptive design; designs: their initial points. Mistakes are noted."""
    offered = {name: solver.outputs[name] for name in outputs if name in solver.outputs}
    parts = {
        name: part for name, part in reading.part.designs.items() if isinstance(part, AdaptivePart)
    }
    rules = {}
    for name, part in parts.items():
        with reading.mistakes_at("designs", name):
            _check(reading, name, part, designs.get(name), solver)
            aim = _aim(reading, name, part, offered)
            if aim is not None and len(unit := {offered[one].unit for one in aim.outputs}) == 1:
                aim = replace(aim, unit=unit.pop())
            if aim is None or space is None or name not in designs or reading.mistakes:
                continue  # without a sound solver there is no identity
            if aim.kind == INDEX_WIDTH and not space.independent:
                raise StudyError(
                    "aim index_width needs independent parameters; take aim accuracy, or drop "
                    "correlation and constraints"
                )
            seed = part.seed if part.seed is not None else zlib.crc32(name.encode())
            until = _until(part, aim, offered)
            levels = _levels(reading, designs[name], spec, space)
            identity = _identity(designs[name], space, spec, constants, aim, seed, levels)
            rules[name] = Rule(aim, until, part.batch, seed, identity, levels)
    return rules


def _check(
    reading: Reading, name: str, part: AdaptivePart, initial: Design | None, solver: Solver
) -> None:
    if name == "test":
        raise StudyError(
            "design 'test' is held out to judge the surrogates; it cannot be adaptive, because "
            "its points would follow from the answers. Call the adaptive design train"
        )
    if reading.part.replicates > 1:
        raise StudyError(
            "an adaptive design takes each point once; drop replicates. Scatter between runs is "
            "estimated from neighbouring points"
        )
    if getattr(solver, "recorded", False):
        raise StudyError("a table has no further runs; an adaptive design needs a solver")
    if part.until.seconds is not None and getattr(solver, "told", False):
        raise StudyError("answers that are told have no seconds; give until: runs")
    if initial is not None and initial.levels and part.aim != ACCURACY:
        raise StudyError(
            f"aim {part.aim} has runs of the last level only; take aim accuracy, which chooses "
            "levels of fidelity too, or begin with a design that names no levels"
        )
    if initial is not None and part.until.runs is not None and initial.rows > part.until.runs:
        raise StudyError(
            f"until: runs {part.until.runs} is less than the {initial.rows} runs of initial; "
            "raise it, or begin with fewer runs"
        )


def _aim(
    reading: Reading, name: str, part: AdaptivePart, offered: Mapping[str, Output]
) -> Aim | None:
    """The aim, with values in the outputs' units; None when an output is wrong."""
    path = ("designs", name)

    def scalar(output: str, *where: str | int) -> bool:
        return is_scalar(reading, output, offered, "an aim needs a single number", *path, *where)

    for key, sign in ENDS:
        output = getattr(part, key)
        if output is not None:
            return Aim(part.aim, (output,), sign=sign) if scalar(output, key) else None
    for output, value in part.target.items():
        if not scalar(output, "target", output):
            return None
        with reading.mistakes_at(*path, "target", output):
            return Aim(part.aim, (output,), units.quantity(str(value), offered[output].unit))
        return None
    named = [n for index, n in enumerate(part.output) if scalar(n, "output", index)]
    if len(named) < len(part.output):
        return None
    for key, sign in SIDES:
        limit = getattr(part, key)
        if limit is not None:
            with reading.mistakes_at(*path, key):
                value = units.quantity(str(limit), offered[named[0]].unit)
                return Aim(part.aim, (named[0],), value, sign)
            return None
    names = tuple(named) or tuple(n for n, one in offered.items() if not one.dims)
    if not names:
        raise StudyError(
            f"aim {part.aim} needs an output that is a single number; the study keeps fields only"
        )
    return Aim(part.aim, names)


def _until(part: AdaptivePart, aim: Aim, offered: Mapping[str, Output]) -> Until:
    """When it ends, with the goal in the output's unit."""
    given = part.until
    for figure in FIGURES[aim.kind]:
        value = getattr(given, figure)
        if value is None:
            continue
        if figure in ("rmse", "gain"):
            if len({offered[name].unit for name in aim.outputs}) > 1:
                raise StudyError(f"until: {figure} suits one unit; name one output, or give q2")
            value = units.distance(str(value), aim.unit, figure, f"write 2 or '2 {aim.unit}'")
        return Until(given.runs, figure, float(value), given.patience, given.seconds)
    return Until(given.runs, FIGURES[aim.kind][0], None, given.patience, given.seconds)


def _levels(reading: Reading, initial: Design, spec: SolverSpec, space: Space) -> tuple[Level, ...]:
    """The levels of fidelity of a design that begins with runs of all."""
    if not initial.levels or not isinstance(spec, LevelsSpec):
        return ()
    return tuple(
        Level(
            name,
            tuple(k for k, one in enumerate(space.names) if one in level.solver.inputs),
            reading.part.levels[name].seconds,
        )
        for name, level in spec.levels.items()
    )


def _identity(
    initial: Design,
    space: Space,
    spec: SolverSpec,
    constants: Mapping[str, float | str],
    aim: Aim,
    seed: int,
    levels: tuple[Level, ...],
) -> str:
    """Equal for rules that choose the same points from the same answers of the same solver."""
    laws = [[p.name, p.distribution and p.distribution.words, p.levels] for p in space.parameters]
    begun = initial.identity or np.round(initial.coded, 12).tolist()
    said = [begun, laws, space.correlation, [one.text for one in space.constraints]]
    said += [spec.context, dict(constants), vars(aim), seed]
    if isinstance(spec, LevelsSpec) and levels:
        contexts = [one.context for one in spec.levels.values()]
        said += [[vars(one) for one in levels], contexts]
    return "adaptive_" + hashlib.sha256(canonical(said).encode()).hexdigest()[:32]
