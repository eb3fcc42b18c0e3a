"""Constraints: inequalities between parameters, in base units.

`constraint_text.parse` makes one of the words of a study.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.space.units import base_unit, conversion

Array = NDArray[np.float64]

#: An equality holds when its sides differ by less than this share of their size.
EQUAL = 1e-9

FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "sqrt": np.sqrt,
    "abs": np.abs,
    "min": lambda *values: reduce(np.minimum, values),
    "max": lambda *values: reduce(np.maximum, values),
    "log": np.log,
    "exp": np.exp,
}
_OPERATORS: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
}
_SYMBOLS: Mapping[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "^",
}
SIGNS: Mapping[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "=",
}


@dataclass(frozen=True)
class Relation:
    """One inequality or equality between parameters; build one by `constraint_text.parse`.

    What a solver requires of its inputs is a `surrogate.solver.Constraint`, a function of its
    own.

    text    as the study writes it
    names   the parameters and constants in it, in order of appearance
    """

    text: str
    names: tuple[str, ...]
    _tree: ast.Compare = field(repr=False, compare=False)
    _literals: Mapping[str, float] = field(repr=False, compare=False)
    _units: Mapping[str, str] = field(repr=False, compare=False)

    def __deepcopy__(self, memo: object) -> Relation:
        """Itself: nothing in it changes."""
        return self

    @cached_property
    def is_equality(self) -> bool:
        """True for a mixture such as ``a + b + c = 1``."""
        return any(isinstance(op, ast.Eq) for op in self._tree.ops)

    def holds(self, physical: Mapping[str, Any]) -> NDArray[np.bool_]:
        """Where it holds, shape (run,), for columns of physical values, name -> (run,).

        Where a side has no value, such as the root of a negative number, it does not hold.
        """
        return np.asarray(reduce(np.logical_and, (_holds(*one) for one in self._pairs(physical))))

    def margin(self, physical: Mapping[str, Any]) -> Array:
        """How far an inequality is from being broken, in base units; negative where it is.

        The shape is that of the columns; of several comparisons the one nearest to breaking.
        """
        return np.asarray(reduce(np.minimum, (_margin(*one) for one in self._pairs(physical))))

    def difference(self, physical: Mapping[str, Any]) -> Array:
        """Left less right side, shape (run,), in base units; of an equality zero."""
        _, left, right = self._pairs(physical)[0]
        return np.asarray(left - right)

    def portable(self, inputs: Sequence[str], fixed: Mapping[str, float]) -> dict[str, Any]:
        """`text`, `sides` and what is `compared`, as JSON data; all in base units.

        A side is a number, [operation, sides ...] or ["input", number among `inputs`, slope,
        offset], its physical value times the slope plus the offset.
        """
        leaves: dict[str, Any] = dict(self._literals)
        for name in self.names:
            to_base = conversion(self._units[name], base_unit(self._units[name]))
            leaves[name] = (
                to_base.place(fixed[name])
                if name in fixed
                else ["input", inputs.index(name), to_base.slope, to_base.offset]
            )
        sides = (self._tree.left, *self._tree.comparators)
        return {
            "text": self.text,
            "sides": [_tree(side, leaves) for side in sides],
            "compared": [SIGNS[type(op)] for op in self._tree.ops],
        }

    def _pairs(self, physical: Mapping[str, Any]) -> list[tuple[ast.cmpop, Array, Array]]:
        """What is compared: operator, left and right side in base units."""
        values: dict[str, Any] = dict(self._literals)
        for name in self.names:
            to_base = conversion(self._units[name], base_unit(self._units[name]))
            values[name] = to_base.slope * np.asarray(physical[name], float) + to_base.offset
        with np.errstate(all="ignore"):
            sides = [_value(side, values) for side in (self._tree.left, *self._tree.comparators)]
        return list(zip(self._tree.ops, sides[:-1], sides[1:], strict=True))


def _holds(op: ast.cmpop, left: Array, right: Array) -> NDArray[np.bool_]:
    if isinstance(op, ast.Eq):
        size = np.maximum(np.abs(left), np.abs(right))
        return np.asarray(np.abs(left - right) <= EQUAL * size)
    small, large = (left, right) if isinstance(op, ast.Lt | ast.LtE) else (right, left)
    return np.asarray(small < large if isinstance(op, ast.Lt | ast.Gt) else small <= large)


def _margin(op: ast.cmpop, left: Array, right: Array) -> Array:
    return right - left if isinstance(op, ast.Lt | ast.LtE) else left - right


def _value(node: ast.expr, values: Mapping[str, Any]) -> Any:
    match node:
        case ast.Name():
            return values[node.id]
        case ast.UnaryOp(op=ast.USub()):
            return -_value(node.operand, values)
        case ast.UnaryOp():
            return _value(node.operand, values)
        case ast.BinOp():
            left, right = _value(node.left, values), _value(node.right, values)
            return _OPERATORS[type(node.op)](left, right)
        case ast.Call(func=ast.Name(id=name)):
            return FUNCTIONS[name](*(_value(argument, values) for argument in node.args))
        case _:
            raise AssertionError(f"`parse` lets no {type(node).__name__} through")


def _tree(node: ast.expr, leaves: Mapping[str, Any]) -> Any:
    match node:
        case ast.Name():
            return leaves[node.id]
        case ast.UnaryOp(op=ast.USub()):
            return ["negative", _tree(node.operand, leaves)]
        case ast.UnaryOp():
            return _tree(node.operand, leaves)
        case ast.BinOp():
            return [_SYMBOLS[type(node.op)], _tree(node.left, leaves), _tree(node.right, leaves)]
        case ast.Call(func=ast.Name(id=name)):
            return [name, *(_tree(argument, leaves) for argument in node.args)]
        case _:
            raise AssertionError(f"`parse` lets no {type(node).__name__} through")
