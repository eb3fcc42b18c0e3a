"""From the words of `solve:` to problems."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from surrogate.errors import StudyError, nearest
from surrogate.solver import Output, Solver
from surrogate.solving.goals import Desire, Goal, Objective, Target
from surrogate.solving.problem import Problem
from surrogate.space import units
from surrogate.space.constraint_text import parse
from surrogate.space.constraints import Relation
from surrogate.space.space import Parameter, Space
from surrogate.stages.screening import nominal_values
from surrogate.study.parts.solve import DesirePart, SolvePart, TargetPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import check_surrogate, is_scalar

Values = Mapping[str, float | str]


def problem_of(
    reading: Reading,
    name: str,
    part: SolvePart,
    solver: Solver,
    space: Space,
    outputs: Iterable[str],
    constants: Values,
) -> Problem:
    """The problem that one part states; mistakes are noted in `reading`."""
    offered = {name: solver.outputs[name] for name in outputs if name in solver.outputs}
    return _Problem(reading, name, part, solver, space, offered, constants).read()


def problems_of(
    reading: Reading,
    solver: Solver,
    space: Space | None,
    outputs: Iterable[str],
    constants: Values,
) -> dict[str, Problem]:
    """Every problem of the study; outputs: those that the study keeps."""
    outputs = tuple(outputs)
    if space is None:
        return {}
    return {
        name: problem_of(reading, name, part, solver, space, outputs, constants)
        for name, part in reading.part.solve.items()
    }


class _Problem:
    """One entry of `solve:` on its way to a `Problem`."""

    def __init__(
        self,
        reading: Reading,
        name: str,
        part: SolvePart,
        solver: Solver,
        space: Space,
        offered: Mapping[str, Output],
        constants: Values,
    ):
        self.reading, self.name, self.part, self.solver = reading, name, part, solver
        self.space, self.offered, self.constants = space, offered, constants
        self.path = ("solve", name)

    def read(self) -> Problem:
        """The problem; mistakes are noted, and what is wrong is left out."""
        held = self._held()
        needed = "solve reads a surrogate"
        check_surrogate(self.reading, self.part.surrogate, needed, *self.path)
        limits = self._limits()
        goals = self._goals()
        if not (goals or limits) and not self.reading.mistakes:
            self.reading.wrong("says no goal", *self.path)
        return Problem(
            self.name,
            goals,
            limits,
            tuple(n for n in self.space.names if n not in held and n not in self.part.uncertain),
            tuple(name for name in self.space.names if name in self.part.uncertain),
            held,
            {n: float(v) for n, v in self._fixed.items() if any(n in one.names for one in limits)},
            self.part.probability,
            self.part.candidates,
            self.part.surrogate,
        )

    def _wrong(self, sentence: str, *path: str | int) -> None:
        self.reading.wrong(sentence, *self.path, *path)

    # goals ------------------------------------------------------------------------------------

    def _goals(self) -> tuple[Goal, ...]:
        found: list[Goal] = []
        for output, target in self.part.target.items():
            if self._is_scalar(output, "target", output):
                with self.reading.mistakes_at(*self.path, "target", output):
                    found.append(self._target(output, target))
        for key, sign in (("minimise", 1), ("maximise", -1)):
            for index, output in enumerate(getattr(self.part, key)):
                if self._is_scalar(output, key, index):
                    found.append(Objective(output, 1 if sign > 0 else -1))
        for output, desire in self.part.desirability.items():
            if self._is_scalar(output, "desirability", output):
                with self.reading.mistakes_at(*self.path, "desirability", output):
                    found.append(self._desire(output, desire))
        return tuple(found)

    def _is_scalar(self, output: str, *path: str | int) -> bool:
        needed = "a goal needs a single number"
        return is_scalar(self.reading, output, self.offered, needed, *self.path, *path)

    def _number(self, given: float | str, output: str) -> float:
        return units.quantity(str(given), self.offered[output].unit)

    def _target(self, output: str, part: TargetPart) -> Target:
        if part.range is not None:
            low, high = (self._number(end, output) for end in part.range)
            if not low < high:
                raise StudyError(f"range [{low:g}, {high:g}] is upside down")
            return Target(output, 0.5 * (low + high), low, high)
        value = self._number(part.value if part.value is not None else "", output)
        if part.within is None:
            return Target(output, value)
        unit = self.offered[output].unit
        half = units.distance(str(part.within), unit, "within", f"write 2 or '2 {unit}'")
        return Target(output, value, value - half, value + half)

    def _desire(self, output: str, part: DesirePart) -> Desire:
        words: dict[str, Any] = {"exponent": part.exponent, "importance": part.importance}
        if part.target is not None:
            low, value, high = (self._number(one, output) for one in part.target)
            if not low < value < high:
                raise StudyError(f"target [{low:g}, {value:g}, {high:g}] must rise")
            return Desire(output, "target", low, high, value, **words)
        aim, ends = (
            ("maximise", part.maximise)
            if part.maximise is not None
            else ("minimise", part.minimise)
        )
        assert ends is not None
        low, high = (self._number(one, output) for one in ends)
        if not low < high:
            raise StudyError(f"{aim} [{low:g}, {high:g}] must rise: the smaller value comes first")
        return Desire(output, "maximise" if aim == "maximise" else "minimise", low, high, **words)

    # limits -----------------------------------------------------------------------------------

    @property
    def _fixed(self) -> dict[str, float]:
        """Numbers of inputs that are no parameters."""
        nominal = {name: one.nominal for name, one in self.solver.inputs.items()}
        return {
            name: float(value)
            for name, value in {**nominal, **self.constants}.items()
            if name not in self.space.names
            and isinstance(value, int | float)
            and not self.solver.inputs[name].levels
        }

    def _limits(self) -> tuple[Relation, ...]:
        numeric = {p.name: p.unit for p in self.space.parameters if not p.categorical}
        numeric |= {name: self.solver.inputs[name].unit for name in self._fixed}
        numeric |= {name: one.unit for name, one in self.offered.items() if not one.dims}
        found = []
        for index, text in enumerate(self.part.subject_to):
            with self.reading.mistakes_at(*self.path, "subject_to", index):
                one = parse(text, numeric)
                if one.is_equality:
                    raise StudyError(
                        f"'{text}' is an equality, which no computed output meets; write two "
                        "inequalities, or a target with within"
                    )
                found.append(one)
        return tuple(found)

    # inputs -----------------------------------------------------------------------------------

    def _held(self) -> dict[str, float | str]:
        """Values of the parameters that are neither free nor uncertain."""
        part, names = self.part, self.space.names
        self._check_names()
        fixed = {}
        for name, given in part.fix.items():
            if name in names:
                with self.reading.mistakes_at(*self.path, "fix", name):
                    fixed[name] = _value_of(self.space[name], given)
        if not part.free:
            return fixed
        nominal = nominal_values(self.space, self.solver)
        return {
            name: fixed[name] if name in fixed else nominal.get(name, _middle(self.space[name]))
            for name in names
            if name not in part.free and name not in part.uncertain
        }

    def _check_names(self) -> None:
        part, names, said = self.part, self.space.names, dict[str, str]()
        for key, given in (
            ("free", part.free),
            ("uncertain", part.uncertain),
            ("fix", tuple(part.fix)),
        ):
            for index, name in enumerate(given):
                place = name if key == "fix" else index
                if name not in names:
                    if not self.reading.is_broken("parameters", name):
                        self._wrong(
                            f"parameter '{name}' is unknown; {nearest(name, names)}", key, place
                        )
                elif name in said:
                    also = "twice" if said[name] == key else f"also under {said[name]}"
                    self._wrong(f"'{name}' stands {also}; it can be one of the two", key, place)
                said.setdefault(name, key)
        if names and all(name in (*part.uncertain, *part.fix) for name in names):
            self._wrong("every parameter is uncertain or fixed; leave at least one to choose")
        for one in self.space.constraints:
            joined = [name for name in part.uncertain if name in one.names]
            if joined:
                self._wrong(
                    f"constraint '{one.text}' joins the uncertain {', '.join(joined)} with others; "
                    "choose or fix it",
                    "uncertain",
                )


def _value_of(parameter: Parameter, given: float | str) -> float | str:
    """A value that a parameter is held at, in its unit."""
    if parameter.categorical:
        parameter.encode([str(given)])
        return str(given)
    value = units.quantity(str(given), parameter.unit)
    coded = float(parameter.encode([value])[0])
    if abs(coded) > 1.0 + 1e-9:
        low, high = parameter.law.support
        raise StudyError(
            f"{parameter.name} {given} lies outside of its range [{low:g}, {high:g}] "
            f"{parameter.unit}".rstrip()
        )
    return value


def _middle(parameter: Parameter) -> float | str:
    """The middle of a range, the allowed value next to it, or the first level."""
    if parameter.categorical:
        return parameter.levels[0]
    value: float = parameter.decode(parameter.snap([0.0]))[0].item()
    return value
