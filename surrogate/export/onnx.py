"""An ONNX model: opset 17, float64, `x` (batch, D) to `mean` and `std`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surrogate.errors import StudyError
from surrogate.export.arrays import padded
from surrogate.export.description import Description
from surrogate.export.erf import erf
from surrogate.export.factors import Contrast, Coordinate, Factor, Product, Recurrence
from surrogate.export.formula import Formula, Process, Spread, Term
from surrogate.export.graph import Graph, Tensor

#: Protocol buffers hold no more bytes.
LARGEST = 2**31 - 1


def written(description: Description) -> bytes:
    """The model; `mean` and `std` are (batch,), of a field (batch, *shape).

    Raises `PluginError` where the package `onnx` is missing, `StudyError` for a model that no
    file of ONNX holds.
    """
    one, graph = description.formula, Graph()
    _check_size(one)
    factors = _factors(graph, description)
    mean = _amplitudes(graph, one, factors) @ one.modes + one.middle
    graph.output("mean", mean, description.shape)
    graph.output("std", _deviation(graph, one, factors, mean), description.shape)
    told = {
        "inputs": ", ".join(entry.name for entry in description.inputs),
        **{f"x[{i}]": entry.told for i, entry in enumerate(description.inputs)},
        "study": description.study,
        "surrogate": description.surrogate,
        "output": description.output,
        "unit": description.unit,
        "q2": repr(description.q2),
    }
    about = "\n".join(description.lines())
    model = graph.model(description.name, len(description.inputs), about, told)
    return bytes(model.SerializeToString(deterministic=True))


def _check_size(one: Formula) -> None:
    numbers = sum(2 * process.lower.size for process in one.processes)
    if 8 * numbers > LARGEST - 2**20:
        raise StudyError(
            f"a file of ONNX holds 2 GB, this surrogate needs {8e-9 * numbers:.1f} GB; "
            "use --format c or json, or a surrogate of fewer runs"
        )


def _factors(graph: Graph, description: Description) -> Tensor:
    """Functions of one input each (m, F + 1), the constant 1 first."""
    x = Tensor(graph, "x")
    factors = description.formula.factors
    used = sorted({one.input for one in factors if not isinstance(one, Product)})
    coded = {i: _coded(x.take([i]), description.inputs[i].coding) for i in used}
    found = [x.take([0]) * 0.0 + 1.0]
    for factor in factors:
        found.append(_factor(factor, coded, found))
    return graph.joined(found)


def _coded(x: Tensor, coding: Mapping[str, Any]) -> Tensor:
    """Coded values of physical ones; a level is given by its number."""
    match coding["kind"]:
        case "range":
            low, high = float(coding["low"]), float(coding["high"])
            return (x - low) * 2.0 / (high - low) - 1.0
        case "levels":
            last = len(coding["levels"]) - 1.0
            return _level(x, last) * 2.0 / last - 1.0
        case "normal":
            return erf((x - float(coding["mean"])) / (float(coding["std"]) * math.sqrt(2.0)))
        case _:
            log = x.op("Max", 0.0).op("Log")
            return erf((log - float(coding["mu"])) / (float(coding["sigma"]) * math.sqrt(2.0)))


def _level(x: Tensor, last: float) -> Tensor:
    """The number of the nearest of the levels 0 to last."""
    return x.op("Round").op("Max", 0.0).op("Min", last)


def _factor(factor: Factor, coded: Mapping[int, Tensor], found: Sequence[Tensor]) -> Tensor:
    match factor:
        case Coordinate(i):
            return coded[i]
        case Product(a, b):
            return found[a] * found[b]
        case Recurrence(i, alpha, beta, gamma, now, before):
            return ((coded[i] - alpha) * found[now] - found[before] * beta) / gamma
        case Contrast(i, values):
            last = len(values) - 1.0
            level = _level((coded[i] + 1.0) / 2.0 * last, last)
            total = level * 0.0
            for number, value in enumerate(values):
                if value:
                    total += level.op("Equal", float(number)).real() * value
            return total


def _products(graph: Graph, factors: Tensor, terms: Sequence[Term]) -> Tensor:
    """Products of factors (m, terms)."""
    rows = np.array(padded(terms))
    return graph.product([factors.take(column.tolist()) for column in rows.T])


def _amplitudes(graph: Graph, one: Formula, factors: Tensor) -> Tensor:
    """Amplitudes (m, K)."""
    total = _products(graph, factors, one.terms) @ one.coefficients
    for process in one.processes:
        weights = np.zeros((len(process.centres), len(one.modes)))
        weights[:, process.members] = process.weights
        total += _correlations(graph, process, factors) @ weights
    return total


def _correlations(graph: Graph, process: Process, factors: Tensor) -> Tensor:
    """Products of Matern 5/2 functions (m, n) of points and runs."""
    distances = [
        (factors.take([column]) * float(scale) - np.asarray(centre)[None]).op("Abs")
        for column, scale, centre in zip(
            process.columns, process.scales, process.centres.T, strict=True
        )
    ]
    product = graph.product([s * (s + 3.0) + 3.0 for s in distances])
    total = distances[0]
    for s in distances[1:]:
        total += s
    return product * (-total).op("Exp") / float(3 ** len(distances))


def _deviation(graph: Graph, one: Formula, factors: Tensor, mean: Tensor) -> Tensor:
    """Standard deviations (m, N)."""
    if one.deviation is not None:
        return mean * 0.0 + one.deviation
    if one.spread is not None:
        variances = _of_spread(graph, one.spread, factors)
    else:
        parts = [
            _unexplained(graph, process, factors) @ _placed(process, len(one.modes))
            for process in one.processes
        ]
        variances = parts[0]
        for part in parts[1:]:
            variances += part
    return (variances @ one.modes**2 + one.left_out**2).op("Sqrt")


def _of_spread(graph: Graph, spread: Spread, factors: Tensor) -> Tensor:
    """Variances (m, K) of a polynomial."""
    solved = _products(graph, factors, spread.terms) @ spread.inverse
    return ((solved * solved).sum() + 1.0) @ spread.deviations[None] ** 2


def _placed(process: Process, modes: int) -> np.ndarray:
    """Variances of the members (1, K), zero elsewhere."""
    row = np.zeros((1, modes))
    row[0, process.members] = process.variance
    return row


def _unexplained(graph: Graph, process: Process, factors: Tensor) -> Tensor:
    """Variance (m, 1) of a new run, that of the process being 1.

    ONNX solves no triangular systems: the inverse of the factor, corrected once, keeps the digits.
    """
    inverse = np.linalg.inv(process.lower).T
    r = _correlations(graph, process, factors)
    rest = _products(graph, factors, process.trend) - r @ process.solved
    v = r @ inverse
    v += (r - v @ process.lower.T) @ inverse
    trended = ((rest @ process.gain) * rest).sum()
    return (trended - (v * v).sum() + (1.0 + process.nugget)).op("Max", process.nugget)
