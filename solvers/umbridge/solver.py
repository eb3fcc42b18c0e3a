"""A UM-Bridge model as a solver for studies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypeVar
from urllib.parse import urlsplit

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from surrogate.errors import SolverError, StudyError
from surrogate.solver import Input, Output

from ..command.options import seconds
from ..declared import DeclaredInput
from .client import Client


class OutputOptions(BaseModel):
    """An output: one number, or as many as `dims` has places.

    dims  dimension -> its coordinate values, or how many there are
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    unit: str = ""
    description: str = ""
    dims: dict[str, list[float] | int] = {}


#: The vectors of an option: for each, name -> description, in order.
Inputs = list[dict[str, DeclaredInput]]
Outputs = list[dict[str, OutputOptions]]

_Vectors = TypeVar("_Vectors", Inputs, Outputs)


class UMBridge:
    """A model behind a UM-Bridge server, called over HTTP.

    url            such as "http://localhost:4242"; not a part of a run's identity
    model          its name on the server
    inputs         a mapping for each vector that goes in, its numbers in order: name ->
                   {unit, nominal, range, levels, description, source}; one vector may stand
                   without the list. A level goes out as its number, from 0
    outputs        the same for vectors that come out: name -> {unit, description, dims}
    config         what the model is told besides its inputs; a part of a run's identity
    timeout        of one answer: seconds, or a text such as `30 min`
    retries        how often a request is repeated when the server breaks or is away
    model_version  any text; change it when the model gives other answers now

    Raises `StudyError` for options that do not fit. The server is asked at the first run, so
    that reports need none; run several workers for requests in parallel.
    """

    def __init__(
        self,
        url: str,
        model: str,
        inputs: list[dict[str, Any]] | dict[str, Any],
        outputs: list[dict[str, Any]] | dict[str, Any],
        config: dict[str, Any] | None = None,
        timeout: float | str | None = None,
        retries: int = 2,
        model_version: str = "",
    ):
        self._in = _vectors("inputs", inputs, TypeAdapter(Inputs))
        self._out = _vectors("outputs", outputs, TypeAdapter(Outputs))
        if urlsplit(url).scheme not in ("http", "https") or not urlsplit(url).hostname:
            raise StudyError(f"url: '{url}' is no address; write http://localhost:4242")
        self.client = Client(url, model, config or {}, seconds(timeout), max(0, retries))
        self.inputs = {
            name: Input(**one.model_dump()) for vector in self._in for name, one in vector.items()
        }
        self.outputs = {name: _output(one) for vector in self._out for name, one in vector.items()}
        self._checked = False
        self.version = model_version or "1"
        self.identity_options = {
            "model": model,
            "config": config or {},
            "inputs": [list(vector) for vector in self._in],
            "outputs": [list(vector) for vector in self._out],
        }

    def __call__(self, **given: float | str) -> dict[str, float | NDArray[np.float64]]:
        """The model's answer; raises `SolverError` when it has none."""
        self._check_sizes()
        sent = [[self._number(name, given[name]) for name in vector] for vector in self._in]
        found: dict[str, float | NDArray[np.float64]] = {}
        for vector, values in zip(self._out, self.client.evaluate(sent), strict=True):
            at = 0
            for name in vector:
                shape = self.outputs[name].shape
                part = np.array(values[at : at + math.prod(shape)], dtype=float)
                found[name] = part.reshape(shape) if shape else float(part[0])
                at += math.prod(shape)
        return found

    def _number(self, name: str, value: float | str) -> float:
        levels = self.inputs[name].levels
        return float(levels.index(str(value)) if levels else value)

    def _check_sizes(self) -> None:
        """Once: raises `SolverError` when the server's vectors are not the declared ones."""
        if self._checked:
            return
        offered = self.client.models()
        if self.client.model not in offered:
            raise SolverError(
                f"{self.client.url} has no model '{self.client.model}'; it has {', '.join(offered)}"
            )
        declared = (
            [len(vector) for vector in self._in],
            [sum(math.prod(self.outputs[name].shape) for name in vector) for vector in self._out],
        )
        for kind, ours, theirs in zip(
            ("inputs", "outputs"), declared, self.client.sizes(), strict=True
        ):
            if ours != theirs:
                raise SolverError(
                    f"{kind}: the study declares vectors of {ours} numbers; the model has {theirs}"
                )
        self._checked = True


def _vectors(option: str, given: Any, kind: TypeAdapter[_Vectors]) -> _Vectors:
    """The vectors of an option, each name -> its description; raises `StudyError`."""
    given = [given] if isinstance(given, Mapping) else given
    try:
        found = kind.validate_python(given)
    except ValidationError as error:
        raise StudyError(
            *(
                f"{option}.{'.'.join(map(str, item['loc']))}: {item['msg'].lower()}"
                for item in error.errors()
            )
        ) from None
    names = [name for vector in found for name in vector]
    if not names or len(set(names)) < len(names):
        raise StudyError(f"{option}: {names} must be one or more names that all differ")
    return found


def _output(given: OutputOptions) -> Output:
    coordinates = {
        dim: np.arange(float(values)) if isinstance(values, int) else np.array(values, dtype=float)
        for dim, values in given.dims.items()
    }
    return Output(
        unit=given.unit,
        description=given.description,
        dims=tuple(given.dims),
        coordinates=coordinates,
    )
