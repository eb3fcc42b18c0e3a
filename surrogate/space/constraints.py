"""Constraints: inequalities between parameters, in the study's own names and units.

A constraint such as ``width + 2*gap <= 80 mm`` is parsed, never run as code. It may hold
numbers with or without unit, names, ``+ - * / ^``, ``sqrt abs min max log exp``, and one
or more of ``<= >= < > =``. What is compared or added must have one dimension; all
arithmetic is done in base units.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError, nearest
from surrogate.space.units import base_unit, conversion, dimension, known

if TYPE_CHECKING:
    from surrogate.space.units import Dimension

Array = NDArray[np.float64]

#: Longest text of a constraint, and largest exponent in it.
LONGEST, LARGEST_POWER = 500, 16.0
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
_SIGNS: Mapping[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "=",
}
_COMPARED = tuple(_SIGNS)
_EXAMPLE = "write an inequality such as 'width + 2*gap <= 80 mm'"

_NUMBER = re.compile(r"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
_UNIT_WORD = re.compile(r"\s*([°%µ]?[^\W\d]*)((?:\s*(?:\*\*|\^)\s*-?\d+)?)")
_JOIN = re.compile(r"\s*[*/](?!\*)\s*(?=[^\W\d_])")


@dataclass(frozen=True)
class Relation:
    """One inequality or equality between parameters; build one by `parse`.

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
            "compared": [_SIGNS[type(op)] for op in self._tree.ops],
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


def parse(text: str, units: Mapping[str, str]) -> Relation:
    """The constraint that `text` states about the numeric inputs in `units` (name -> unit).

    Raises `StudyError` for unknown names and functions, units that do not fit, and anything
    that is no inequality.
    """
    if len(text) > LONGEST:
        raise StudyError(f"a constraint has {len(text)} characters; at most {LONGEST} are read")
    try:
        return _Parser(text, units).constraint()
    except StudyError as error:
        raise StudyError(f"constraint '{text}': {error}") from None
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise StudyError(f"constraint '{text}' is not understood; {_EXAMPLE}") from None


@dataclass
class _Parser:
    """Reads one constraint: numbers with units first, then Python's own grammar, checked."""

    text: str
    units: Mapping[str, str]
    literals: dict[str, float] = field(default_factory=dict)
    written: dict[str, str] = field(default_factory=dict)
    dimensions: dict[str, Dimension] = field(default_factory=dict)
    names: dict[str, None] = field(default_factory=dict)

    def constraint(self) -> Relation:
        tree = self._tree(self._without_numbers())
        sides = [tree.left, *tree.comparators]
        first = self._dimension(sides[0])
        for side in sides[1:]:
            self._same(sides[0], first, side, self._dimension(side))
        if not self.names:
            raise StudyError("it names no parameter")
        units = {name: self.units[name] for name in self.names}
        return Relation(self.text, tuple(self.names), tree, self.literals, units)

    def _tree(self, source: str) -> ast.Compare:
        python = re.sub(r"(?<![<>=!])=(?!=)", "==", source.replace("^", "**"))
        found = ast.parse(python.strip(), mode="eval").body
        if not isinstance(found, ast.Compare):
            raise StudyError(f"it compares nothing; {_EXAMPLE}")
        if not all(isinstance(op, _COMPARED) for op in found.ops):
            raise StudyError("only <=, >=, <, > and = compare")
        return found

    def _without_numbers(self) -> str:
        """The text with a name in place of each number and its unit."""
        parts, at = [], 0
        while found := _NUMBER.search(self.text, at):
            parts.append(self.text[at : found.start()])
            unit, at = self._unit_after(found.end())
            name = f"_{len(self.literals)}"
            number = float(found[1])
            if not math.isfinite(number):
                raise StudyError(f"{found[1]} is not a finite number")
            self.literals[name] = conversion(unit, base_unit(unit)).place(number)
            self.dimensions[name] = dimension(unit)
            self.written[name] = f"{found[1]} {unit}".strip()
            parts.append(name)
        return "".join([*parts, self.text[at:]])

    def _unit_after(self, at: int) -> tuple[str, int]:
        """The unit that follows a number ("" when none does), and where it ends.

        It is a word straight after the number, and further words joined by * or / as long
        as they are units and no names of the study.
        """
        word = _UNIT_WORD.match(self.text, at)
        if word is None or not word[1]:
            return "", at
        if not known(word[0].replace("^", "**")):
            raise StudyError(
                f"'{word[1]}' after a number is no unit; write a product with *, as in 2*width"
            )
        start, end = word.start(1), word.end()
        while joined := _JOIN.match(self.text, end):
            further = _UNIT_WORD.match(self.text, joined.end())
            if further is None or further[1] in self.units or further[1] in FUNCTIONS:
                break
            if not known(self.text[start : further.end()].replace("^", "**")):
                break
            end = further.end()
        return self.text[start:end].replace("^", "**"), end

    def _dimension(self, node: ast.expr) -> Dimension:
        """Dimension of an expression; raises `StudyError` for what is not understood."""
        found: Dimension
        match node:
            case ast.Name():
                found = self._dimension_of_name(node.id)
            case ast.UnaryOp(op=ast.UAdd() | ast.USub()):
                found = self._dimension(node.operand)
            case ast.BinOp(op=ast.Pow()):
                found = self._dimension(node.left) ** self._power(node.right)
            case ast.BinOp(op=ast.Mult()):
                found = self._dimension(node.left) * self._dimension(node.right)
            case ast.BinOp(op=ast.Div()):
                found = self._dimension(node.left) / self._dimension(node.right)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                found, right = self._dimension(node.left), self._dimension(node.right)
                self._same(node.left, found, node.right, right)
            case ast.Call(func=ast.Name(id=name), keywords=[]):
                found = self._dimension_of_call(name, node.args)
            case _:
                raise StudyError(
                    f"only numbers, names, + - * / ^ and {', '.join(FUNCTIONS)} are understood"
                )
        return found

    def _dimension_of_name(self, name: str) -> Dimension:
        if name not in self.literals:
            if name not in self.units:
                raise StudyError(
                    f"'{name}' is no numeric parameter or constant; {nearest(name, self.units)}"
                )
            self.names[name] = None
            self.dimensions[name] = dimension(self.units[name])
        return self.dimensions[name]

    def _dimension_of_call(self, name: str, arguments: list[ast.expr]) -> Dimension:
        if name not in FUNCTIONS:
            raise StudyError(f"function '{name}' is unknown; {nearest(name, FUNCTIONS)}")
        many = name in ("min", "max")
        if (len(arguments) < 2) if many else (len(arguments) != 1):
            raise StudyError(f"{name} takes {'two or more values' if many else 'one value'}")
        found = [self._dimension(argument) for argument in arguments]
        if name in ("log", "exp") and found[0] != dimension(""):
            raise StudyError(f"{name} needs a number without unit, such as a ratio")
        for argument, other in zip(arguments[1:], found[1:], strict=True):
            self._same(arguments[0], found[0], argument, other)
        return found[0] ** 0.5 if name == "sqrt" else found[0]

    def _power(self, node: ast.expr) -> float:
        """The exponent: a number, so that the unit is known."""
        negative = isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)
        inner = node.operand if isinstance(node, ast.UnaryOp) else node
        value = self.literals.get(inner.id) if isinstance(inner, ast.Name) else None
        if value is None or value > LARGEST_POWER:
            raise StudyError(
                f"the exponent {self._shown(node)} must be a number up to {LARGEST_POWER:g}"
            )
        return -value if negative else value

    def _same(self, a: ast.expr, unit_a: Dimension, b: ast.expr, unit_b: Dimension) -> None:
        if unit_a == unit_b:
            return
        for node, other, unit in ((a, b, unit_b), (b, a, unit_a)):
            if isinstance(node, ast.Name) and self.written.get(node.id, "").find(" ") < 0:
                if node.id in self.written:
                    raise StudyError(
                        f"{self._shown(node)} has no unit, but {self._shown(other)} is {unit}; "
                        f"write {self._shown(node)} with its unit"
                    )
        raise StudyError(
            f"{self._shown(a)} is {unit_a} and {self._shown(b)} is {unit_b}; they cannot be "
            "added or compared"
        )

    def _shown(self, node: ast.expr) -> str:
        """An expression as the study writes it."""
        shown = ast.unparse(node)
        return re.sub(r"\b_\d+\b", lambda found: self.written.get(found[0], found[0]), shown)
