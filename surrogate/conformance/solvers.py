"""Does a solver keep the contract of `surrogate.solver`?"""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from surrogate.conformance.scenes import scene_mistakes
from surrogate.conformance.verdict import attempt, conclude, documented, same
from surrogate.errors import SolverError, nearest
from surrogate.solver import Constraint, Input, Output
from surrogate.space.units import known

Values = Mapping[str, Any]


def check_solver(
    solver: Any,
    *,
    runs: int = 6,
    seed: int = 0,
    impossible: Sequence[Values] = (),
    picklable: bool = True,
) -> None:
    """Raise `PluginError` with everything about `solver`, an instance, that breaks the contract.

    runs        how often it may be called: the nominal point twice, corners and random points
                of its ranges. 0 checks the declarations only, for a solver that takes hours
    impossible  points that have no answer: for each, `SolverError` must say why
    picklable   whether it must survive pickling, as process pools of one's own need
    """
    name = type(solver).__name__
    conclude(name, _declarations(solver))
    conclude(name, [*documented(solver), *(_answers(solver, runs, seed) if runs else ())])
    conclude(name, scene_mistakes(solver, _points(solver, max(runs, 2), seed)))
    conclude(
        name, [*(_pickled(solver, runs) if picklable else ()), *_impossible(solver, impossible)]
    )


def _declarations(solver: Any) -> Iterable[str]:
    for attribute in ("inputs", "outputs"):
        declared = getattr(solver, attribute, None)
        if not isinstance(declared, Mapping) or (attribute == "outputs" and not declared):
            yield (
                f"has no `{attribute}`; give a mapping from names to "
                f"surrogate.solver.{attribute[:-1].title()}"
            )
            continue
        kind = Input if attribute == "inputs" else Output
        for name, one in declared.items():
            if not isinstance(one, kind):
                yield f"{attribute}['{name}'] is a {type(one).__name__}; make it a {kind.__name__}"
            elif not isinstance(name, str) or not name.isidentifier():
                yield f"{attribute}['{name}']: a name has letters, digits and _ only"
            else:
                yield from _input(name, one) if isinstance(one, Input) else _output(name, one)
    if not isinstance(getattr(solver, "version", None), str) or not solver.version:
        yield "has no `version`; give a text, and change it when answers change"
    if not callable(solver):
        yield "cannot be called; write __call__(self, **inputs)"
    yield from _clashes(solver)
    yield from _constraints(solver)


def _constraints(solver: Any) -> Iterable[str]:
    """Each is a `Constraint` on inputs that are there, and the nominal point keeps it."""
    declared, inputs = getattr(solver, "constraints", ()), getattr(solver, "inputs", None) or {}
    if not isinstance(declared, tuple) or not all(isinstance(one, Constraint) for one in declared):
        yield "`constraints` is not a tuple of surrogate.solver.Constraint; make it one"
        return
    for number, one in enumerate(declared):
        name = f"constraints[{number}]"
        if not isinstance(one.sentence, str) or not one.sentence:
            yield f"{name} has no sentence; say what must hold and what to change"
        unknown = [joined for joined in one.inputs if joined not in inputs]
        if unknown or not one.inputs:
            yield f"{name}: {unknown} are no inputs; name the inputs that it joins"
            continue
        nominal = [inputs[joined].nominal for joined in one.inputs]
        if None in nominal:
            continue
        kept, sentences = attempt(f"{name} at the nominal point", partial(one.holds, *nominal))
        yield from sentences
        if not sentences and not kept:
            yield f"{name}: the nominal point breaks it; choose nominal values that keep it"


def _input(name: str, given: Input) -> Iterable[str]:
    if not isinstance(given.unit, str) or not known(given.unit):
        yield f"input {name}: pint does not know the unit {given.unit!r}; write N/mm, kPa, mm, ..."
    if given.levels:
        if given.nominal is not None and given.nominal not in given.levels:
            yield (
                f"input {name}: nominal {given.nominal!r} is not a level; "
                f"{nearest(str(given.nominal), given.levels)}"
            )
        return
    low, high = given.range
    if not low < high:
        yield f"input {name}: range ({low}, {high}) is upside down or empty"
    elif isinstance(given.nominal, str):
        yield f"input {name}: nominal {given.nominal!r} is no number; or give levels"
    elif given.nominal is not None and not low <= given.nominal <= high:
        yield f"input {name}: nominal {given.nominal} lies outside its range ({low:g}, {high:g})"


def _output(name: str, given: Output) -> Iterable[str]:
    if not isinstance(given.unit, str) or not known(given.unit):
        yield f"output {name}: pint does not know the unit {given.unit!r}; write mmHg, kPa, mm, ..."
    if set(given.dims) != set(given.coordinates):
        yield (
            f"output {name}: dims {list(given.dims)} and coordinates "
            f"{list(given.coordinates)} differ; give coordinate values for each dimension"
        )
    for dim, values in given.coordinates.items():
        values = np.asarray(values)
        if values.ndim != 1 or len(values) == 0 or len(np.unique(values)) < len(values):
            yield f"output {name}: coordinates of {dim} must be different values, shape (size,)"


def _clashes(solver: Any) -> Iterable[str]:
    """Inputs, outputs and dimensions become variables of one dataset."""
    inputs = getattr(solver, "inputs", None) or {}
    outputs = {
        name: one
        for name, one in (getattr(solver, "outputs", None) or {}).items()
        if isinstance(one, Output)
    }
    for name in set(inputs) & set(outputs):
        yield f"'{name}' is both an input and an output; rename one"
    places: dict[str, np.ndarray] = {}
    for output, given in outputs.items():
        for dim, values in given.coordinates.items():
            if dim in inputs or dim in outputs:
                yield f"output {output}: dimension '{dim}' is also an input or output; rename it"
            if not np.array_equal(places.setdefault(dim, values), values):
                yield (
                    f"output {output}: dimension '{dim}' has other coordinates than in another "
                    "output; give it another name"
                )


def _answers(solver: Any, runs: int, seed: int) -> Iterable[str]:
    declared = _described(solver)
    nominal, *others = _points(solver, runs, seed)
    answer, sentences = attempt("the nominal point", lambda: solver(**nominal))
    sentences = [s + "; choose nominal values that have an answer" for s in sentences]
    sentences = sentences or list(_answer(solver, answer, nominal))
    yield from sentences
    if runs > 1 and not sentences:
        yield from _repeated(solver, nominal, answer)
    for point in others:
        answer, sentences = attempt(
            f"the point {_written(point)}", partial(solver, **point), SolverError
        )
        yield from sentences if answer is None else _answer(solver, answer, point)
    if declared != _described(solver):
        yield "its inputs or outputs changed during a call; they must be known before it"


def _repeated(solver: Any, point: Values, answer: Values) -> Iterable[str]:
    """The same point once more."""
    if not getattr(solver, "deterministic", True):
        return
    again, sentences = attempt("the second call of the nominal point", lambda: solver(**point))
    yield from sentences
    if again is not None and any(not same(answer[name], again[name]) for name in answer):
        yield (
            "two calls with the same inputs differ; fix its seed, or say `deterministic = False`"
        )


def _described(solver: Any) -> str:
    """Inputs and outputs as text, to see whether a call changes them."""
    coordinates = {
        name: {dim: np.asarray(values).tolist() for dim, values in given.coordinates.items()}
        for name, given in solver.outputs.items()
    }
    return repr((dict(solver.inputs), dict(solver.outputs), coordinates))


def _points(solver: Any, runs: int, seed: int) -> list[dict[str, Any]]:
    """The nominal point, then corners and random points of the finite ranges."""
    rng = np.random.default_rng(seed)
    nominal = {name: _middle(given) for name, given in solver.inputs.items()}
    points = [nominal]
    for number in range(max(0, runs - 2)):
        share = rng.integers(2, size=len(nominal)) if number % 2 else rng.random(len(nominal))
        points.append(
            {
                name: _between(given, nominal[name], float(s))
                for (name, given), s in zip(solver.inputs.items(), share, strict=True)
            }
        )
    return points


def _middle(given: Input) -> Any:
    if given.nominal is not None:
        return given.nominal
    return _between(given, 1.0, 0.5)


def _between(given: Input, otherwise: Any, share: float) -> Any:
    """A value this far along the range or levels; `otherwise` where the range has no ends."""
    if given.levels:
        return given.levels[min(int(share * len(given.levels)), len(given.levels) - 1)]
    low, high = given.range
    return low + share * (high - low) if math.isfinite(low) and math.isfinite(high) else otherwise


def _written(point: Values) -> str:
    return ", ".join(
        f"{name}={value if isinstance(value, str) else format(value, '.6g')}"
        for name, value in point.items()
    )


def _answer(solver: Any, answer: Any, point: Values) -> Iterable[str]:
    where = f"at {_written(point)}"
    if not isinstance(answer, Mapping):
        yield (
            f"{where} returned a {type(answer).__name__}; return a mapping from output names "
            "to values"
        )
        return
    missing, extra = set(solver.outputs) - set(answer), set(answer) - set(solver.outputs)
    if missing or extra:
        yield (
            f"{where} returned {sorted(answer)}; it declares {sorted(solver.outputs)}: "
            "return exactly these"
        )
    for name in set(solver.outputs) & set(answer):
        yield from _value(name, solver.outputs[name], answer[name], where)


def _value(name: str, declared: Output, value: Any, where: str) -> Iterable[str]:
    try:
        value = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        yield f"output {name} {where} is {value!r}; return a float or an array of them"
        return
    if value.shape != declared.shape:
        yield (
            f"output {name} {where} has shape {value.shape}; its dims {list(declared.dims)} "
            f"say {declared.shape}"
        )
    if np.isinf(value).any() or (np.isnan(value).any() and not declared.gaps):
        yield (
            f"output {name} {where} is not finite; raise SolverError with a sentence that says "
            "why there is no answer, or declare Output(gaps=True)"
        )


def _pickled(solver: Any, runs: int) -> Iterable[str]:
    copied, sentences = attempt("pickling", lambda: pickle.loads(pickle.dumps(solver)))
    if sentences:
        yield sentences[0] + "; keep open files, locks and lambdas out of its attributes"
    elif runs > 1:
        nominal = _points(solver, 1, 0)[0]
        mine, failed = attempt("the nominal point", lambda: solver(**nominal))
        its, sentences = attempt("a pickled copy", lambda: copied(**nominal))
        yield from sentences
        if (
            getattr(solver, "deterministic", True)
            and not failed
            and not sentences
            and any(not same(mine[name], its[name]) for name in solver.outputs)
        ):
            yield "a pickled copy answers differently; keep all that matters in attributes"


def _impossible(solver: Any, points: Sequence[Values]) -> Iterable[str]:
    for point in points:
        answer, sentences = attempt(
            f"the point {_written(point)}", partial(solver, **point), SolverError
        )
        yield from sentences
        if answer is not None:
            yield f"the point {_written(point)} has an answer; raise SolverError that says why not"
