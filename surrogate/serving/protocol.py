"""The UM-Bridge protocol 1.0: requests in, answers out, no network.

Vectors go in and out as lists of lists of numbers. `answer` takes the path and the body of
a request and gives the status and the body of its answer; whatever is wrong with a request
becomes an error of the protocol with a sentence.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import SurrogateError
from surrogate.serving.derivatives import apply_hessian, apply_jacobian, gradient

Array = NDArray[np.float64]
Vectors = list[Array]
VERSION = 1.0


class Model(Protocol):
    """What is served.

    input_sizes, output_sizes  numbers in each vector that goes in and out
    differentiable             whether differences of it mean anything; a solver's may not
    scales                     for each vector that goes in, how far each number varies
    Called with one array a vector, it gives one array a vector; raises `SurrogateError` for
    a point without an answer.
    """

    @property
    def name(self) -> str: ...

    @property
    def input_sizes(self) -> Sequence[int]: ...

    @property
    def output_sizes(self) -> Sequence[int]: ...

    @property
    def differentiable(self) -> bool: ...

    @property
    def scales(self) -> Sequence[Array]: ...

    def __call__(self, vectors: Vectors) -> Vectors: ...


@dataclass(frozen=True)
class Reply:
    """Status and body of an answer."""

    status: int
    body: Mapping[str, Any]


class _Refused(Exception):
    """A request that cannot be answered: the protocol's kind of error, and a sentence."""

    def __init__(self, kind: str, sentence: str, status: int = 400):
        super().__init__(sentence)
        self.kind, self.status = kind, status


def answer(models: Mapping[str, Model], path: str, body: Any) -> Reply:
    """The answer to a request of `path`, such as "/Evaluate", with the JSON data `body`."""
    try:
        if path == "/Info":
            return Reply(200, {"protocolVersion": VERSION, "models": list(models)})
        if path not in _ANSWERS:
            raise _Refused("NotFound", f"there is no {path}; there are {', '.join(PATHS)}", 404)
        request = _Request(body)
        return Reply(200, _ANSWERS[path](_model(models, request), request))
    except _Refused as error:
        return _error(error.kind, str(error), error.status)
    except SurrogateError as error:
        return _error("InvalidInput", str(error), 400)
    except Exception as error:
        return _error("InternalError", f"{type(error).__name__}: {error}", 500)


def _error(kind: str, sentence: str, status: int) -> Reply:
    return Reply(status, {"error": {"type": kind, "message": sentence}})


@dataclass(frozen=True)
class _Request:
    """The body of a request, with its parts checked as they are asked for."""

    body: Any

    def __getitem__(self, key: str) -> Any:
        if not isinstance(self.body, Mapping):
            raise _Refused("InvalidInput", "the request is no JSON object")
        if key not in self.body:
            raise _Refused("InvalidInput", f"the request has no '{key}'")
        return self.body[key]

    def vectors(self, sizes: Sequence[int]) -> Vectors:
        """The vectors that go in."""
        given = self["input"]
        if not isinstance(given, list) or len(given) != len(sizes):
            raise _Refused("InvalidInput", f"input: {len(sizes)} vectors are needed, as lists")
        return [
            _vector(f"input {i}", one, size)
            for i, (one, size) in enumerate(zip(given, sizes, strict=True))
        ]

    def vector(self, key: str, size: int) -> Array:
        """A single vector."""
        return _vector(key, self[key], size)

    def index(self, key: str, count: int) -> int:
        """Which vector is meant, from 0."""
        value = self[key]
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < count:
            raise _Refused("InvalidInput", f"{key}: {value!r:.60} must be one of 0..{count - 1}")
        return value


def _vector(name: str, given: Any, size: int) -> Array:
    if not isinstance(given, list) or len(given) != size:
        raise _Refused("InvalidInput", f"{name}: a list of {size} numbers is needed")
    for value in given:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _Refused("InvalidInput", f"{name}: {value!r:.60} is not a number")
    try:
        found = np.array(given, dtype=float)
    except OverflowError:
        raise _Refused("InvalidInput", f"{name}: a number is too large") from None
    if not np.isfinite(found).all():
        raise _Refused("InvalidInput", f"{name}: all numbers must be finite")
    return found


def _model(models: Mapping[str, Model], request: _Request) -> Model:
    name = request["name"]
    if not isinstance(name, str) or name not in models:
        raise _Refused(
            "ModelNotFound", f"model {name!r:.60} is unknown; there are {', '.join(models)}"
        )
    return models[name]


def _sizes_in(model: Model, request: _Request) -> dict[str, Any]:
    return {"inputSizes": list(model.input_sizes)}


def _sizes_out(model: Model, request: _Request) -> dict[str, Any]:
    return {"outputSizes": list(model.output_sizes)}


def _support(model: Model, request: _Request) -> dict[str, Any]:
    smooth = model.differentiable
    kinds = ("Gradient", "ApplyJacobian", "ApplyHessian")
    return {"support": {"Evaluate": True, **dict.fromkeys(kinds, smooth)}}


def _evaluate(model: Model, request: _Request) -> dict[str, Any]:
    found = model(request.vectors(model.input_sizes))
    return {"output": [_plain(one) for one in found]}


def _smooth(model: Model) -> Model:
    if not model.differentiable:
        raise _Refused("UnsupportedFeature", f"{model.name} has no derivatives")
    return model


def _gradient(model: Model, request: _Request) -> dict[str, Any]:
    out = request.index("outWrt", len(_smooth(model).output_sizes))
    where = request.index("inWrt", len(model.input_sizes))
    sens = request.vector("sens", model.output_sizes[out])
    found = gradient(model, model.scales, request.vectors(model.input_sizes), out, where, sens)
    return {"output": _plain(found)}


def _jacobian(model: Model, request: _Request) -> dict[str, Any]:
    out = request.index("outWrt", len(_smooth(model).output_sizes))
    where = request.index("inWrt", len(model.input_sizes))
    along = request.vector("vec", model.input_sizes[where])
    point = request.vectors(model.input_sizes)
    return {"output": _plain(apply_jacobian(model, model.scales, point, out, where, along))}


def _hessian(model: Model, request: _Request) -> dict[str, Any]:
    out = request.index("outWrt", len(_smooth(model).output_sizes))
    first = request.index("inWrt1", len(model.input_sizes))
    second = request.index("inWrt2", len(model.input_sizes))
    sens = request.vector("sens", model.output_sizes[out])
    along = request.vector("vec", model.input_sizes[second])
    point = request.vectors(model.input_sizes)
    found = apply_hessian(model, model.scales, point, out, first, second, sens, along)
    return {"output": _plain(found)}


def _plain(vector: Array) -> list[float]:
    values = np.asarray(vector, dtype=float).ravel().tolist()
    if not all(map(math.isfinite, values)):
        raise _Refused("InvalidOutput", "the model gave a number that is not finite", 500)
    return list(values)


_ANSWERS: Mapping[str, Callable[[Model, _Request], dict[str, Any]]] = {
    "/InputSizes": _sizes_in,
    "/OutputSizes": _sizes_out,
    "/ModelInfo": _support,
    "/Evaluate": _evaluate,
    "/Gradient": _gradient,
    "/ApplyJacobian": _jacobian,
    "/ApplyHessian": _hessian,
}
#: What can be asked for.
PATHS = ("/Info", *_ANSWERS)
