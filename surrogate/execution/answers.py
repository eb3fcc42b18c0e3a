"""One call of a solver, and what its answer is worth.

The one place where a solver is called and its answer examined, so that a run means
the same in a local worker, in somebody's executor and in the tests. An answer is
numbers in the units that the solver declares, or a failed run with a sentence.
"""

from __future__ import annotations

import os
import reprlib
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import SolverError, StudyError
from surrogate.solver import Output, Solver

#: Characters of a solver's own sentence that are kept.
LONGEST_MESSAGE = 2000

_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = 60


class Outcome(NamedTuple):
    """How one attempt of a run ended.

    `answered` is True when the solver itself decided (a result, or a `SolverError`, or a
    result that cannot be used): a deterministic solver would only decide the same again.
    `lost` is True when the machine ended the attempt (no memory, a node that failed).
    """

    status: str
    message: str
    seconds: float
    outputs: Mapping[str, float] = {}
    fields: Mapping[str, NDArray[np.float64]] = {}
    answered: bool = True
    lost: bool = False


def evaluate(solver: Solver, call: Mapping[str, Any], wanted: Mapping[str, Output]) -> Outcome:
    """Call the solver once; whatever it does becomes an `Outcome`."""
    start = time.perf_counter()
    try:
        result = solver(**call)
    except SolverError as error:
        why = message_of(error) or "the solver has no answer here and does not say why"
        return _failed(why, start)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # SystemExit, a cancelled task of asyncio: one row each
        return _failed(describe(error), start, answered=False)
    seconds = time.perf_counter() - start
    try:
        return Outcome("ok", "", seconds, *accepted(result, wanted))
    except ValueError as error:
        return _failed(str(error), start)


def _failed(message: str, start: float, answered: bool = True) -> Outcome:
    return Outcome("failed", message, time.perf_counter() - start, answered=answered)


def accepted(
    result: Any, wanted: Mapping[str, Output]
) -> tuple[dict[str, float], dict[str, NDArray[np.float64]]]:
    """The scalars and the arrays of an answer; raises `ValueError` when it cannot be used."""
    values = {name: check(name, output, result) for name, output in wanted.items()}
    scalars = {name: float(value) for name, value in values.items() if not wanted[name].dims}
    fields = {name: value for name, value in values.items() if wanted[name].dims}
    return scalars, fields


def check(name: str, output: Output, result: Any) -> NDArray[np.float64]:
    """Output `name` of a solver's result as doubles of the declared shape and unit.

    Quantities of pint, astropy or unyt and labelled arrays of xarray are converted; what is
    masked is a gap. Raises `ValueError` with a sentence when it is missing, no real number,
    of another shape or dimension, or not finite where the solver declares no gaps.
    """
    try:
        value = _numbers(_entry(name, result), output, output.shape)
    except _Unusable as error:
        raise ValueError(f"output '{name}' {error}") from None
    except (_Absent, KeyboardInterrupt):
        raise
    except BaseException as error:  # reading an object of the solver's may do anything
        raise ValueError(f"output '{name}' cannot be read: {describe(error)}") from None
    bad = int(np.count_nonzero(np.isinf(value) if output.gaps else ~np.isfinite(value)))
    if bad and not output.dims:
        raise ValueError(f"output '{name}' is {value}; it must be finite")
    if bad:
        raise ValueError(f"output '{name}' is not finite in {bad} of {value.size} places")
    return value


class _Absent(ValueError):
    """An answer without the output."""


class _Unusable(Exception):
    """An output that is no numbers as declared: the sentence after its name."""


def _entry(name: str, result: Any) -> Any:
    if not isinstance(result, Mapping):
        raise _Absent(
            f"the solver returned {type(result).__name__}; it must return a mapping "
            "of output names to values"
        )
    if name not in result:
        raise _Absent(
            f"the solver did not return '{name}'; it returned "
            f"{', '.join(map(str, islice(result, 20))) or 'nothing'}"
        )
    return result[name]


def _numbers(value: Any, output: Output, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """`value` as doubles of `shape` (the output's, or its last sizes inside a list)."""
    if hasattr(type(value), "dims") and hasattr(type(value), "attrs"):  # xarray's DataArray
        return _labelled(value, output, shape)
    value = _magnitude(value, output.unit)
    if isinstance(value, list | tuple):
        return _listed(value, output, shape)
    masked = np.ma.getmaskarray(value) if isinstance(value, np.ma.MaskedArray) else None
    array = np.asarray(value)
    if array.shape != shape:
        raise _Unusable(f"has shape {array.shape}; the solver declares {shape}")
    if masked is not None and masked.any() and not output.gaps:
        raise _Unusable(f"is masked in {np.count_nonzero(masked)} of {masked.size} places")
    if array.dtype.kind == "O":
        numbers = np.array([_number(one, output) for one in array.flat]).reshape(shape)
    elif array.dtype.kind in "iuf":
        with np.errstate(over="ignore"):
            numbers = array.astype(float)
    else:
        raise _unreal(value)
    return numbers if masked is None else np.where(masked, np.nan, numbers)


def _listed(value: Sequence[Any], output: Output, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """A list, entry by entry: NumPy would take [1.0, True] and a list of quantities as numbers."""
    if not shape:
        raise _Unusable(f"is {shown(value)}; the solver declares one number")
    if len(value) != shape[0]:
        raise _Unusable(f"has {len(value)} entries where the solver declares {shape[0]}")
    if len(shape) == 1 and set(map(type, value)) == {float}:
        return np.array(value)
    return np.array([_numbers(one, output, shape[1:]) for one in value]).reshape(shape)


def _labelled(value: Any, output: Output, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """A labelled array: its dimensions by name, in the unit that it states."""
    if set(value.dims) == set(output.dims):
        value = value.transpose(*output.dims)
    numbers = _numbers(value.data, output, shape)
    stated = str(value.attrs.get("units", output.unit))
    if stated == output.unit:
        return numbers
    from surrogate.space.units import conversion  # brings pint, which few workers need

    try:
        change = conversion(stated, output.unit)
    except StudyError as error:
        raise _Unusable(f"is in another unit: {error}") from None
    return change.slope * numbers + change.offset


def _magnitude(value: Any, unit: str) -> Any:
    """The number or array in `unit` of a quantity (pint, astropy, unyt); others as they are."""
    kind = type(value)
    if not hasattr(kind, "to") or not (hasattr(kind, "units") or hasattr(kind, "unit")):
        return value
    try:
        converted = value.to(unit)
        return converted.magnitude if hasattr(kind, "magnitude") else converted.value
    except Exception as error:
        wanted = f"'{unit}'" if unit else "a number without unit"
        raise _Unusable(
            f"is {shown(value, str)}; it does not convert to {wanted}, as the solver "
            f"declares ({type(error).__name__})"
        ) from None


def _number(value: Any, output: Output) -> float:
    """One entry of an array of objects."""
    value = _magnitude(value, output.unit)
    if isinstance(value, bool) or not hasattr(type(value), "__float__"):
        raise _unreal(value)
    if isinstance(value, np.generic | np.ndarray):
        return float(_numbers(value, output, ()))
    try:
        return float(value)
    except OverflowError:
        raise _Unusable(f"is {shown(value)}; it is too large for a double") from None
    except TypeError:
        raise _unreal(value) from None


def _unreal(value: Any) -> _Unusable:
    return _Unusable(f"is {shown(value)}; it must be real numbers")


def shown(value: Any, form: Callable[[Any], str] = _short.repr) -> str:
    """A value in at most some 60 characters, whatever its own text does."""
    try:
        text = "".join(form(value))
    except Exception:
        return f"an object of type {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:57]}..."


def message_of(error: BaseException) -> str:
    """The error's own sentence, as far as it can be shown."""
    try:
        return "".join(str(error))[:LONGEST_MESSAGE]
    except Exception:
        return "its message cannot be shown"


def describe(error: BaseException) -> str:
    """Type, message and the line where it was raised, in one sentence."""
    name = type(error).__name__
    text = " ".join(message_of(error).split())
    said = f"{name}: {text}" if text else name
    places = [(frame.f_code, line) for frame, line in traceback.walk_tb(error.__traceback__)]
    if not places:
        return said
    code, line = places[-1]
    return f"{said} ({os.path.basename(code.co_filename)}, line {line})"
