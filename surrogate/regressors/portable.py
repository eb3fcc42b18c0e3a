"""Surrogates as plain JSON, to be evaluated without this package.

A description is a dict of `inputs`, in order, a `model` on coded inputs x and its `error`.
`surrogate export` adds `study`, `unit`, `q2`, `constants` and the `coordinates` of a field.

inputs: each has `name`, `unit` and a `coding` of the physical value v::

  {"kind": "range", "low": a, "high": b}      x = 2 (v - a) / (b - a) - 1
  {"kind": "levels", "levels": [names]}       x = 2 index / (k - 1) - 1
  {"kind": "normal", "mean", "std"}           x = erf((v - mean) / (std sqrt 2))
  {"kind": "lognormal", "mu", "sigma"}        x = erf((ln v - mu) / (sigma sqrt 2))

columns (of the kinds `polynomial` and `gaussian_process`): {"input": i} is x_i;
{"input": i, "level": l, "levels": k} is 1 where the level's index round((x_i + 1)
(k - 1) / 2) is l, -1 where it is 0, and 0 elsewhere.

model, by "kind"::

  polynomial   sum over `terms` of coefficient * prod column[j]^q, powers = [[j, q], ...]
  chaos        sum over `terms` of coefficient * prod P_{i,q}(x_i), degrees = [[i, q], ...].
               `bases`[i] is either {"alpha": [...], "beta": [...]}, for which
               P_0 = 1, beta[k+1] P_{k+1} = (x - alpha[k]) P_k - beta[k] P_{k-1}, or
               {"levels": k, "values": [[P_q at each level], ...]}
  gaussian_process   offset + scale * (trend + sum_i weights[i] prod_j m(|c_j - points[i][j]|
               / lengths[j])) with columns c, m(r) = (1 + s + s^2 / 3) exp(-s), s = sqrt(5) r;
               `trend` is a list like the polynomial's `terms`
  field        mean + sum_k mode_k * (surrogate k), flattened in C order to `shape`. Surrogate k
               is `amplitudes`[k] and what all of them have in common, which stands once, in
               `common`; mappings in both are joined likewise (no `common` in version 1)

error of a prediction, by "kind"; of a field a number for each place. A number is null where
it is not known.
  own        the model's standard deviation, see below; `quantile_95` times it is half of the
             95 % interval, Student's with `freedom` (null: normal)
  left_out   `deviation` and `half_width_95` everywhere, from `freedom` + 1 left-out errors

standard deviation of a new run, of the models that have one
  polynomial         s sqrt(1 + x' (X'X)^-1 x), `deviation` giving s = `residual_sd`, and X by the
                     coded `points` of the runs and its `terms`
  gaussian_process   sqrt(variance max(nugget, 1 + nugget - r' R^-1 r + (f - F' R^-1 r)'
                     (F' R^-1 F)^-1 (f - F' R^-1 r))) with the correlations r of x and R of the
                     runs, R_ii = 1 + nugget, and rows f and F of the trend
  field              root of sum_k (mode_k * deviation k)^2 + left_out^2
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from surrogate.errors import FitError
from surrogate.regressors.columns import Column
from surrogate.space.space import Parameter, Space

FORMAT = "surrogate-studies portable surrogate"
VERSION = 2


def describe(
    space: Space,
    model: dict[str, Any],
    error: dict[str, Any],
    *,
    surrogate: str,
    output: str,
) -> dict[str, Any]:
    """The whole document of one output's surrogate."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "surrogate": surrogate,
        "output": output,
        "inputs": [described_input(parameter) for parameter in space.parameters],
        "model": model,
        "error": error,
    }


def finite(value: ArrayLike) -> Any:
    """Numbers as JSON has them: lists, null for what is not finite."""
    numbers = np.asarray(value, dtype=float)
    known = numbers.astype(object)
    known[~np.isfinite(numbers)] = None
    return known.tolist()


def parted(models: Sequence[Mapping[str, Any]]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """What all models have in common, and the rest of each: see `field`."""
    common: dict[str, Any] = {}
    rests = [dict(model) for model in models]
    everywhere = set.intersection(*map(set, models)) if models else set()
    for key in sorted(everywhere):
        first, *others = values = [model[key] for model in models]
        if all(value == first for value in others):
            common[key] = first
            parts: Sequence[Any] = [None] * len(models)
        elif all(isinstance(value, Mapping) for value in values):
            shared, parts = parted(values)
            common |= {key: shared} if shared else {}
        else:
            continue
        for rest, part in zip(rests, parts, strict=True):
            del rest[key]
            rest.update({key: part} if part else {})
    return common, rests


def described_columns(of: tuple[Column, ...]) -> list[dict[str, Any]]:
    """Columns as the module's first lines describe them; raises `FitError` for normal scores."""
    if any(column.score for column in of):
        raise FitError("a process on normal scores of unbounded inputs has no portable form")
    return [
        {"input": column.parameter, "level": column.level, "levels": column.levels}
        if column.levels
        else {"input": column.parameter}
        for column in of
    ]


def described_input(parameter: Parameter) -> dict[str, Any]:
    """An input; raises `FitError` for an unbounded one whose law has no coding here."""
    return {"name": parameter.name, "unit": parameter.unit, "coding": _coding(parameter)}


def _coding(parameter: Parameter) -> dict[str, Any]:
    if parameter.categorical:
        return {"kind": "levels", "levels": list(parameter.levels)}
    low, high = parameter.law.support
    if parameter.bounded:
        return {"kind": "range", "low": low, "high": high}
    words = dict(parameter.law.words)
    law = words["distribution"]
    if law == "normal" and "range" not in words:
        return {"kind": "normal", "mean": words["mean"], "std": words["std"]}
    if law == "lognormal" and "range" not in words:
        sigma = math.sqrt(math.log1p((words["std"] / words["mean"]) ** 2))
        return {"kind": "lognormal", "mu": math.log(words["mean"]) - sigma**2 / 2.0, "sigma": sigma}
    raise FitError(
        f"{parameter.name}: a surrogate of an unbounded {parameter.law} input "
        "cannot be exported; give it a range [smallest, largest]"
    )
