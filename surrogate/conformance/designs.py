"""Does a design method, or an augmentation, keep the contract of `surrogate.designs`?"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import numpy as np

from surrogate.conformance.verdict import attempt, conclude, documented, global_randomness, same
from surrogate.errors import DesignError
from surrogate.space.constraint_text import parse
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

_RANGES = tuple(
    Parameter(name, uniform(low, low + 2.0), unit="mm")
    for name, low in (("length", 1.0), ("width", -3.0), ("height", 0.0))
)
_NAMES = tuple(p.name for p in _RANGES)
#: Spaces that a study may have; on all but the first a method may refuse with DesignError.
SPACES = {
    "three ranges": Space(_RANGES),
    "seven ranges": Space(tuple(Parameter(f"p{i}", uniform(0.0, 1.0)) for i in range(7))),
    "one range": Space(_RANGES[:1]),
    "ranges and levels": Space(
        (
            *_RANGES[:2],
            Parameter("side", levels=("left", "right")),
            Parameter("layer", levels=("one", "two", "three")),
        )
    ),
    "ranges, integers and listed values": Space(
        (
            *_RANGES[:2],
            Parameter("teeth", integers((1, 8))),
            Parameter("pipe", listed([10, 12, 16, 20]), unit="mm"),
        )
    ),
    "a parameter without ends": Space(
        (*_RANGES, Parameter("load", distribution("normal", mean=5.0, std=1.0), unit="N"))
    ),
    "ranges joined by a constraint": Space(
        _RANGES, constraints=(parse("length + height <= 4 mm", dict.fromkeys(_NAMES, "mm")),)
    ),
    "correlated ranges": Space(_RANGES[:2], correlation=((1.0, 0.6), (0.6, 1.0))),
}
_START = np.array([[-1, -1, 1], [1, -1, -1], [-1, 1, -1], [1, 1, 1]], dtype=float)


def check_design(
    method: Callable[..., Any],
    *,
    options: Mapping[str, Any] | None = None,
    space: Space | None = None,
) -> None:
    """Raise `PluginError` with everything about a design method that breaks the contract.

    options  for the method; one called `runs` that has no default is filled in
    space    on which it must work; default three uniform parameters. On others it may also
             raise `DesignError`
    """
    sentences = [*documented(method), *_signature(method, 1)]
    given = _options(method, options, sentences)
    conclude(_name(method), sentences)
    spaces = {**SPACES, "three ranges": space or SPACES["three ranges"]}
    for number, (kind, one) in enumerate(spaces.items()):
        sentences += _checked(partial(_points, method, one, given), kind, one, must=number == 0)
    conclude(_name(method), sentences)


def check_augmentation(
    method: Callable[..., Any], *, options: Mapping[str, Any] | None = None
) -> None:
    """Raise `PluginError` with everything about an augmentation that breaks the contract.

    It is called on the half fraction of three parameters.
    """
    sentences = [*documented(method), *_signature(method, 2)]
    given = _options(method, options, sentences)
    conclude(_name(method), sentences)
    space, coded = SPACES["three ranges"], _START.copy()
    _, sentences = attempt("on three ranges", lambda: method(space, coded, seed=1, **given))
    if not same(coded, _START):
        sentences.append("changes the design that it is given; return new rows only")
    conclude(_name(method), sentences)
    conclude(
        _name(method),
        _checked(
            lambda seed: method(space, _START.copy(), seed=seed, **given),
            "three ranges",
            space,
            must=True,
        ),
    )


def _name(method: Callable[..., Any]) -> str:
    return getattr(method, "__name__", type(method).__name__)


def _signature(method: Callable[..., Any], positional: int) -> Iterable[str]:
    parameters = list(inspect.signature(method).parameters.values())
    expected = ("space", "coded")[:positional]
    if len(parameters) < positional or any(
        p.kind is p.KEYWORD_ONLY for p in parameters[:positional]
    ):
        yield f"takes no {' and '.join(expected)}; start its parameters with {', '.join(expected)}"
        return
    loose = [p.name for p in parameters[positional:] if p.kind is not p.KEYWORD_ONLY]
    if loose:
        yield (
            f"options {', '.join(loose)} are not keyword-only; write * before them, so that a "
            "study can name them"
        )
    if not any(p.name == "seed" and p.default is None for p in parameters):
        yield "takes no `seed`; add the keyword seed=None, also when nothing is random"
    for p in parameters[positional:]:
        if p.annotation is p.empty and p.name != "seed" and p.kind is p.KEYWORD_ONLY:
            yield f"option {p.name} has no type; annotate it, so that a study's value is checked"


def _options(
    method: Callable[..., Any], options: Mapping[str, Any] | None, sentences: list[str]
) -> dict[str, Any]:
    given = dict(options or {})
    for p in inspect.signature(method).parameters.values():
        if p.kind is p.KEYWORD_ONLY and p.default is p.empty and p.name not in given:
            if p.name == "runs":
                given["runs"] = 12
            else:
                sentences.append(f"option {p.name} has no default; give it in `options`")
    return given


def _points(method: Callable[..., Any], space: Space, options: Mapping[str, Any], seed: int) -> Any:
    return method(space, seed=seed, **options)


def _checked(call: Callable[[int], Any], kind: str, space: Space, must: bool) -> list[str]:
    """Sentences about the design of one space; `must`: refusing it is a mistake."""
    where = f"on {kind}"
    found: list[str] = []
    with global_randomness(found):
        coded, sentences = attempt(where, lambda: call(1), () if must else DesignError)
    if coded is None:
        return found + (sentences or ([f"{where} returned None"] if must else []))
    found += _coded(coded, where, space)
    if not found:
        again, _ = attempt(where, lambda: call(1))
        if again is None or not same(coded, again):
            found.append(
                f"{where}: the same seed gave other points; draw from "
                "np.random.default_rng(seed) only"
            )
    return found


def _coded(coded: Any, where: str, space: Space) -> Iterable[str]:
    if not isinstance(coded, np.ndarray) or coded.dtype.kind != "f":
        yield f"{where} returned {type(coded).__name__}; return a NumPy array of floats"
    elif coded.ndim != 2 or coded.shape[1] != space.size or len(coded) == 0:
        yield (
            f"{where} returned shape {coded.shape}; return (run, parameter) with "
            f"{space.size} columns and at least one run"
        )
    elif not np.isfinite(coded).all() or np.abs(coded).max() > 1.0 + 1e-12:
        yield f"{where} leaves [-1, 1]; return coded values"
    else:
        if space.region is not None and not space.region.holds(coded).all():
            yield (
                f"{where} breaks {' and '.join(text for text, _ in space.region.broken(coded))}; "
                "draw with space.sample, or raise DesignError"
            )
        for j, p in enumerate(space.parameters):
            column = coded[:, j]
            if p.categorical and np.abs(column[:, None] - p.coded_levels).min(axis=1).max() > 1e-9:
                yield f"{where}: parameter {p.name} takes values between its levels"
            if np.abs(column - p.snap(column)).max() > 1e-9:
                yield (
                    f"{where}: parameter {p.name} takes values that are not allowed; return "
                    "space.snap(coded)"
                )
            if not p.bounded and np.abs(column).max() >= 1.0:
                yield (
                    f"{where}: parameter {p.name} has no ends, but takes -1 or 1; raise "
                    "DesignError, or stay inside"
                )
