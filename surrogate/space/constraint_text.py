"""What the text of a constraint says, in the study's own names and units.

A constraint such as ``width + 2*gap <= 80 mm`` is parsed, never run as code. It may hold
numbers with or without unit, names, ``+ - * / ^``, ``sqrt abs min max log exp``, and one
or more of ``<= >= < > =``. What is compared or added must have one dimension.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from surrogate.errors import StudyError, nearest
from surrogate.space.constraints import FUNCTIONS, SIGNS, Relation
from surrogate.space.units import base_unit, conversion, dimension, known

if TYPE_CHECKING:
    from surrogate.space.units import Dimension

#: Longest text of a constraint, and largest exponent in it.
LONGEST, LARGEST_POWER = 500, 16.0
_COMPARED = tuple(SIGNS)
_EXAMPLE = "write an inequality such as 'width + 2*gap <= 80 mm'"

_NUMBER = re.compile(r"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
_UNIT_WORD = re.compile(r"\s*([°%µ]?[^\W\d]*)((?:\s*(?:\*\*|\^)\s*-?\d+)?)")
_JOIN = re.compile(r"\s*[*/](?!\*)\s*(?=[^\W\d_])")


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
