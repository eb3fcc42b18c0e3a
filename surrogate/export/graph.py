"""A graph of ONNX operators on float64 tensors, written down operator by operator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from surrogate.errors import PluginError

OPSET, FORMAT = 17, 8


def package() -> ModuleType:
    """The package onnx; raises `PluginError` where it is missing."""
    try:
        import onnx
    except ImportError as error:
        raise PluginError(
            "--format onnx needs the package onnx; pip install 'surrogate-studies[export]'"
        ) from error
    return onnx


@dataclass(frozen=True)
class Tensor:
    """A tensor of a graph, with the arithmetic of NumPy; numbers become constants."""

    graph: Graph
    name: str

    def __add__(self, other: Tensor | ArrayLike) -> Tensor:
        return self.graph.node("Add", self, other)

    def __sub__(self, other: Tensor | ArrayLike) -> Tensor:
        return self.graph.node("Sub", self, other)

    def __mul__(self, other: Tensor | ArrayLike) -> Tensor:
        return self.graph.node("Mul", self, other)

    def __truediv__(self, other: Tensor | ArrayLike) -> Tensor:
        return self.graph.node("Div", self, other)

    def __matmul__(self, other: Tensor | ArrayLike) -> Tensor:
        return self.graph.node("MatMul", self, other)

    def __neg__(self) -> Tensor:
        return self.graph.node("Neg", self)

    def sum(self) -> Tensor:
        """Sums of rows, (m, 1)."""
        return self.graph.node("ReduceSum", self, np.array([1]), keepdims=1)

    def take(self, columns: Sequence[int]) -> Tensor:
        """Columns (m, k), in this order."""
        return self.graph.node("Gather", self, np.array(columns, dtype=np.int64), axis=1)

    def op(self, operator: str, *others: Tensor | ArrayLike) -> Tensor:
        """An operator of which this is the first input."""
        return self.graph.node(operator, self, *others)

    def where(self, yes: Tensor | ArrayLike, no: Tensor | ArrayLike) -> Tensor:
        """`yes` where this is true."""
        return self.graph.node("Where", self, yes, no)

    def real(self) -> Tensor:
        """0 and 1 of a tensor of truths."""
        return self.graph.node("Cast", self, to=self.graph.onnx.TensorProto.DOUBLE)


@dataclass
class Graph:
    """Operators and constants so far."""

    onnx: ModuleType = field(default_factory=package)
    nodes: list[Any] = field(default_factory=list)
    constants: list[Any] = field(default_factory=list)
    outputs: list[Any] = field(default_factory=list)

    def node(self, operator: str, *inputs: Tensor | ArrayLike, **attributes: Any) -> Tensor:
        """The only output of an operator."""
        made = Tensor(self, f"{operator.lower()}_{len(self.nodes)}")
        given = [self._named(one) for one in inputs]
        self.nodes.append(self.onnx.helper.make_node(operator, given, [made.name], **attributes))
        return made

    def _named(self, value: Tensor | ArrayLike) -> str:
        if isinstance(value, Tensor):
            return value.name
        whole = isinstance(value, np.ndarray) and value.dtype == np.int64
        numbers = np.asarray(value, dtype=None if whole else np.float64)
        name = f"constant_{len(self.constants)}"
        self.constants.append(self.onnx.numpy_helper.from_array(numbers, name))
        return name

    def joined(self, columns: Sequence[Tensor]) -> Tensor:
        """Columns (m, 1) side by side."""
        return self.node("Concat", *columns, axis=1)

    def product(self, tensors: Sequence[Tensor]) -> Tensor:
        """Product of tensors of one shape."""
        return reduce(lambda a, b: a * b, tensors)

    def output(self, name: str, value: Tensor, shape: Sequence[int]) -> None:
        """Rows (m, ...) of a tensor (m, n) as an output of that name."""
        whole = np.array([-1, *shape], dtype=np.int64)
        reshaped = self.node("Reshape", value, whole)
        self.nodes.append(self.onnx.helper.make_node("Identity", [reshaped.name], [name]))
        self.outputs.append(self._described(name, ["batch", *shape]))

    def _described(self, name: str, shape: Sequence[int | str]) -> Any:
        double = self.onnx.TensorProto.DOUBLE
        return self.onnx.helper.make_tensor_value_info(name, double, list(shape))

    def model(self, name: str, inputs: int, about: str, told: Mapping[str, str]) -> Any:
        """The model of an input `x` (batch, inputs), checked."""
        helper = self.onnx.helper
        x = self._described("x", ["batch", inputs])
        graph = helper.make_graph(self.nodes, name, [x], self.outputs, self.constants, about)
        opset = [helper.make_opsetid("", OPSET)]
        model = helper.make_model(
            graph, opset_imports=opset, ir_version=FORMAT, producer_name="surrogate-studies"
        )
        helper.set_model_props(model, dict(told))
        self.onnx.checker.check_model(model, full_check=True)
        return model


def horner(coefficients: Sequence[float], x: Tensor) -> Tensor:
    """A polynomial, highest power first."""
    total = x * 0.0 + coefficients[0]
    for coefficient in coefficients[1:]:
        total = total * x + coefficient
    return total
