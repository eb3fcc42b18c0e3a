"""Constraints are parsed, keep units, and are never run as code."""

import numpy as np
import pytest

from surrogate.errors import StudyError
from surrogate.space.constraint_text import parse

UNITS = {"width": "mm", "gap": "cm", "a": "", "b": "", "c": "", "load": "N", "T": "degC", "m": "kg"}


def holds(text, **physical):
    return parse(text, UNITS).holds({k: np.atleast_1d(v) for k, v in physical.items()}).tolist()


def test_units_are_converted_before_anything_is_added():
    """10 mm + 2 * 3 cm = 70 mm and 10 mm + 2 * 4 cm = 90 mm."""
    assert holds("width + 2*gap <= 80 mm", width=[10, 10], gap=[3, 4]) == [True, False]
    assert holds("width + 2*gap <= 8 cm", width=[10, 10], gap=[3, 4]) == [True, False]
    assert holds("width + 2*gap <= 0.08 m", width=[10, 10], gap=[3, 4]) == [True, False]


@pytest.mark.parametrize(
    "text, physical, expected",
    [
        ("sqrt(width^2 + gap^2) < 5 cm", {"width": [30, 30], "gap": [3.9, 4.1]}, [True, False]),
        ("load / width >= 3 N/mm", {"load": [31, 29], "width": [10, 10]}, [True, False]),
        ("abs(a - b) <= 0.5", {"a": [1, 1], "b": [1.5, 1.6]}, [True, False]),
        ("min(a, b, c) > 0", {"a": [1, 1], "b": [2, -1], "c": [3, 3]}, [True, False]),
        ("max(a, b) < 2e0", {"a": [1, 1], "b": [1, 3]}, [True, False]),
        ("log(a) <= 1", {"a": [2.7, 2.8]}, [True, False]),
        ("exp(-a) < 0.5", {"a": [0.7, 0.6]}, [True, False]),
        ("1 <= a <= 2", {"a": [0.5, 1.5, 2.5]}, [False, True, False]),
        ("a + b + c = 1", {"a": [0.1, 0.1], "b": [0.2, 0.2], "c": [0.7, 0.71]}, [True, False]),
        ("T <= 300 K", {"T": [26, 27]}, [True, False]),
        ("T <= 26.5 degC", {"T": [26, 27]}, [True, False]),
        ("a**-1 < 2", {"a": [1, 0.1]}, [True, False]),
        ("gap*load <= 2000 N*mm / 10", {"gap": [19, 21], "load": [1, 1]}, [True, False]),
    ],
)
def test_what_is_understood(text, physical, expected):
    assert holds(text, **physical) == expected


def test_a_root_of_a_negative_number_does_not_hold():
    assert holds("sqrt(a) < 10", a=[-1.0, 4.0]) == [False, True]


def test_a_mixture_is_an_equality():
    """Its difference is left less right side, in base units."""
    mixture = parse("a + b = 1", UNITS)
    assert mixture.is_equality and mixture.names == ("a", "b")
    assert mixture.difference({"a": [0.5], "b": [0.75]}) == pytest.approx([0.25])


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("width <= 80", "80 has no unit, but width is .length.; write 80 with its unit"),
        ("width + load <= 80 mm", "width is .length. and load is .*cannot be added or compared"),
        ("widht <= 80 mm", "'widht' is no numeric parameter or constant; did you mean 'width'"),
        ("width + 2 gap <= 80 mm", "'gap' after a number is no unit; write a product with"),
        ("width + gap", "compares nothing; write an inequality such as"),
        ("width != 3 mm", "only <=, >=, <, > and = compare"),
        ("cos(a) < 1", "function 'cos' is unknown"),
        ("min(a) < 1", "min takes two or more values"),
        ("sqrt(a, b) < 1", "sqrt takes one value"),
        ("log(width) < 1", "log needs a number without unit"),
        ("a^b < 1", "exponent b must be a number"),
        ("9**9**9**9 < a", "exponent .* must be a number up to 16"),
        ("a^99 < 1", "exponent 99 must be a number up to 16"),
        ("1 < 2", "names no parameter"),
        ("__import__('os').system('x') < a", "are understood"),
        ("a.real < 1", "only numbers, names"),
        ("[a] < 1", "only numbers, names"),
        ("a < < 1", "not understood; write an inequality"),
        ("(" * 300 + "a < 1", "not understood"),
        ("a" * 497 + " < 1", "501 characters; at most 500"),
        ("a < 1e999", "1e999 is not a finite number"),
        ("", "not understood"),
        ("load*gap <= 2 N*m", "cannot be added or compared"),  # m is a mass here: names go first
    ],
)
def test_what_is_not_understood_is_a_sentence(text, sentence):
    with pytest.raises(StudyError, match=sentence):
        parse(text, UNITS)
