"""The formats, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from surrogate.export import c, fmu, javascript, json, onnx, python
from surrogate.export.description import Description


@dataclass(frozen=True)
class Format:
    """A format: what it is for, and the function that writes a description in it."""

    about: str
    written: Callable[[Description], bytes]


FORMATS: Mapping[str, Format] = {
    "json": Format("the portable document, to be evaluated by a program of your own", json.written),
    "python": Format("a file that needs NumPy alone", python.written),
    "c": Format("one file of C99 without dependencies", c.written),
    "javascript": Format("an ES module for browsers and Node", javascript.written),
    "onnx": Format("a graph for ONNX runtimes", onnx.written),
    "fmu": Format("a co-simulation unit of FMI 2.0, compiled", fmu.written),
}
