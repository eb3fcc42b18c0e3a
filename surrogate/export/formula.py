"""The model of a portable document as factors, terms and arrays, ready to be written down.

Whatever its kind, a surrogate is a field of N places, a scalar being one place of one mode::

    a = products of factors @ coefficients + correlations with runs @ weights     (K,)
    mean = middle + a @ modes                                                      (N,)
    variance = v @ modes^2 + left_out^2,  v that of a, or a constant deviation

`surrogate.regressors.portable` has the formulas of each kind.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.export.factors import Factor, Factors
from surrogate.regressors import kriging
from surrogate.regressors.columns import Column
from surrogate.regressors.matern import ROOT5, correlation
from surrogate.regressors.polynomial import design_matrix

Array = NDArray[np.float64]

#: Numbers of factors; () is the constant.
Term = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Process:
    """Gaussian processes of the same runs, lengths and nugget; n runs, c columns, q trend terms.

    members          amplitudes that they are (m,), which `weights` (n, m) belong to
    columns          factors (c,);  scales (c,) sqrt(5) / lengths;  centres (n, c) scaled runs
    lower            (n, n) Cholesky factor of the runs' correlations R, R_ii = 1 + nugget
    trend            terms (q,);  solved (n, q) R^-1 F;  gain (q, q) (F' R^-1 F)^-1
    variance         (m,) of each process
    """

    members: tuple[int, ...]
    columns: tuple[int, ...]
    scales: Array
    centres: Array
    weights: Array
    nugget: float
    lower: Array
    trend: tuple[Term, ...]
    solved: Array
    gain: Array
    variance: Array


@dataclass(frozen=True, eq=False)
class Spread:
    """v = (deviations sqrt(1 + |row @ inverse|^2))^2 with the row (r,) of a polynomial's terms.

    inverse (r, r) is R^-1 of the runs' X = Q R; deviations (K,).
    """

    terms: tuple[Term, ...]
    inverse: Array
    deviations: Array


@dataclass(frozen=True, eq=False)
class Formula:
    """A surrogate as the module's first lines write it; K amplitudes, T terms, N places.

    factors       in order; number 0 is the constant 1
    terms (T,)    coefficients (T, K)
    middle (N,)   modes (K, N);  left_out (N,)
    deviation     (N,) where it is the same everywhere; None: of `spread` or `processes`
    """

    factors: tuple[Factor, ...]
    terms: tuple[Term, ...]
    coefficients: Array
    processes: tuple[Process, ...]
    spread: Spread | None
    middle: Array
    modes: Array
    left_out: Array
    deviation: Array | None

    @property
    def rounding(self) -> Array:
        """What rounding may cost the mean (N,): weights of processes are large and cancel."""
        lost = np.zeros(len(self.modes))
        for process in self.processes:
            lost[list(process.members)] += np.abs(process.weights).sum(axis=0)
        return np.asarray(np.finfo(float).eps * (lost @ np.abs(self.modes)))


def formula(document: Mapping[str, Any]) -> Formula:
    """The formula of a portable document."""
    model, error = document["model"], document["error"]
    field = model["kind"] == "field"
    models = (
        [completed(model.get("common", {}), own) for own in model["amplitudes"]]
        if field
        else [model]
    )
    if not models:  # a field that does not vary: one amplitude that is zero
        models = [{"kind": "polynomial", "columns": [], "terms": []}]
        models[0]["deviation"] = {"residual_sd": 0.0, "points": [[]], "terms": [[]]}
    factors = Factors()
    terms, coefficients = _terms(factors, models)
    own = error["kind"] == "own"
    processes = _processes(factors, models) if models[0]["kind"] == "gaussian_process" else ()
    spread = _spread(factors, models) if own and not processes else None
    size = len(model["mean"]) if field else 1
    modes = np.reshape(model["modes"], (-1, size)) if field else np.ones((1, 1))
    return Formula(
        factors.listed,
        terms,
        coefficients,
        processes,
        spread,
        _numbers(model["mean"]) if field else np.zeros(1),
        modes if len(modes) else np.zeros((1, size)),
        _numbers(model["left_out"]) if field else np.zeros(1),
        None if own else np.broadcast_to(np.ravel(_numbers(error["deviation"])), (size,)),
    )


def completed(common: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """A mode's model and what it has in common with others; mappings in both are joined alike."""
    joined = {**common, **own}
    for key in common.keys() & own.keys():
        joined[key] = completed(common[key], own[key])
    return joined


def _numbers(values: Any) -> Array:
    """Floats of JSON data, null being NaN."""
    return np.array(values, dtype=float)


def _terms(factors: Factors, models: Sequence[Mapping[str, Any]]) -> tuple[tuple[Term, ...], Array]:
    """All terms of the models (T,), each once, and their coefficients (T, K)."""
    sums: dict[Term, Array] = {(): np.zeros(len(models))}
    for k, model in enumerate(models):
        for term, coefficient in _own_terms(factors, model):
            sums.setdefault(term, np.zeros(len(models)))[k] += coefficient
    return tuple(sums), np.array(list(sums.values()))


def _own_terms(factors: Factors, model: Mapping[str, Any]) -> list[tuple[Term, float]]:
    if model["kind"] == "chaos":
        bases = model["bases"]
        return [
            (factors.degrees(bases, one["degrees"]), one["coefficient"]) for one in model["terms"]
        ]
    columns = model["columns"]
    if model["kind"] == "polynomial":
        return [
            (factors.powers(columns, one["powers"]), one["coefficient"]) for one in model["terms"]
        ]
    trend = [
        (factors.powers(columns, one["powers"]), model["scale"] * one["coefficient"])
        for one in model["trend"]
    ]
    return [((), model["offset"]), *trend]


def _processes(factors: Factors, models: Sequence[Mapping[str, Any]]) -> tuple[Process, ...]:
    """The models, those of the same lengths and nugget together."""
    alike: dict[tuple[Any, ...], list[int]] = {}
    for k, model in enumerate(models):
        alike.setdefault((model["nugget"], *model["lengths"]), []).append(k)
    return tuple(_process(factors, members, models) for members in alike.values())


def _process(
    factors: Factors, members: Sequence[int], models: Sequence[Mapping[str, Any]]
) -> Process:
    some = [models[k] for k in members]
    first = some[0]
    columns, points, lengths = (
        first["columns"],
        _numbers(first["points"]),
        _numbers(first["lengths"]),
    )
    powers = [one["powers"] for one in first["trend"]]
    matrix = correlation(points, points, lengths)
    np.fill_diagonal(matrix, 1.0 + first["nugget"])
    known = kriging.factored(matrix, design_matrix(powers, points))
    return Process(
        tuple(members),
        tuple(factors.column(column) for column in columns),
        ROOT5 / lengths,
        points * (ROOT5 / lengths),
        np.column_stack([one["scale"] * _numbers(one["weights"]) for one in some]),
        first["nugget"],
        np.tril(known.factor),
        tuple(factors.powers(columns, term) for term in powers),
        known.solved,
        known.gain,
        _numbers([one["variance"] for one in some]),
    )


def _spread(factors: Factors, models: Sequence[Mapping[str, Any]]) -> Spread:
    columns, deviation = models[0]["columns"], models[0]["deviation"]
    points = _numbers(deviation["points"])
    values = np.ones((len(points), len(columns)))
    for j, one in enumerate(columns):
        column = Column(one["input"], "", one.get("level", 0), one.get("levels", 0))
        values[:, j] = column.values(points[:, column.parameter])
    upper = np.linalg.qr(design_matrix(deviation["terms"], values), mode="r")
    deviations = [model["deviation"]["residual_sd"] for model in models]
    terms = tuple(factors.powers(columns, term) for term in deviation["terms"])
    return Spread(terms, np.linalg.inv(upper), _numbers(deviations))
