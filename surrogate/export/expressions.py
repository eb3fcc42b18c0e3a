"""Codings and factors as expressions, in the words that C and NumPy have in common.

`x[i]` is a physical input, `t[i]` its coded value, `level[i]` the number of its level, `f[k]` a
factor. Both languages add `erf`, rounding to the number of a level, and a logarithm that is
-inf where there is none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from surrogate.export.description import Description
from surrogate.export.factors import Contrast, Coordinate, Factor, Product, Recurrence

ROOT2 = math.sqrt(2.0)


def assignments(description: Description, erf: str, level: str, log: str) -> Iterator[str]:
    """`t[0] = ...` of the inputs that are used, then `f[0] = ...`, as both languages write them.

    erf, level, log: names of the functions.
    """
    factors = description.formula.factors
    steps = {one.input: len(one.values) for one in factors if isinstance(one, Contrast)}
    for i in sorted({one.input for one in factors if not isinstance(one, Product)}):
        coding = description.inputs[i].coding
        if coding["kind"] == "levels":  # only contrasts need it
            yield f"level[{i}] = {level}(x[{i}], {steps[i] - 1.0!r})"
            continue
        yield f"t[{i}] = {_coded(i, coding, erf, log)}"
        if i in steps:
            last = steps[i] - 1.0
            yield f"level[{i}] = {level}((t[{i}] + 1.0) / 2.0 * {last!r}, {last!r})"
    yield "f[0] = 1.0"
    for k, factor in enumerate(factors, start=1):
        yield f"f[{k}] = {_factor(factor)}"


def _coded(i: int, coding: Mapping[str, Any], erf: str, log: str) -> str:
    match coding["kind"]:
        case "range":
            low, high = coding["low"], coding["high"]
            return f"2.0 * (x[{i}] - {number(low)}) / {number(high - low)} - 1.0"
        case "normal":
            return f"{erf}((x[{i}] - {number(coding['mean'])}) / {coding['std'] * ROOT2!r})"
        case _:
            width = repr(coding["sigma"] * ROOT2)
            return f"{erf}(({log}(x[{i}]) - {number(coding['mu'])}) / {width})"


def _factor(factor: Factor) -> str:
    match factor:
        case Coordinate(i):
            return f"t[{i}]"
        case Product(a, b):
            return f"f[{a}] * f[{b}]"
        case Recurrence(i, alpha, beta, gamma, now, before):
            kept = f"(t[{i}] - {number(alpha)}) * f[{now}] - {number(beta)} * f[{before}]"
            return f"({kept}) / {gamma!r}"
        case Contrast(i, values):
            parts = [f"{number(v)} * (level[{i}] == {q}.0)" for q, v in enumerate(values) if v]
            return " + ".join([*parts, f"0.0 * level[{i}]"])


def number(value: float) -> str:
    """All digits of a finite number, negative ones in brackets."""
    return repr(float(value)) if value >= 0 else f"({float(value)!r})"
