"""What a solver returns: numbers in its declared units, or a failed run with a sentence."""

import asyncio
import datetime
import decimal
import fractions
import re
from collections.abc import Mapping

import numpy as np
import pint
import pytest
import xarray as xr

from surrogate.errors import SolverError
from surrogate.execution.answers import LONGEST_MESSAGE, evaluate
from surrogate.solver import Output

THEIRS = pint.UnitRegistry()  # a registry of the user's own, with a unit of their own
THEIRS.define("barleycorn = 8.47 mm")

Y = Output(unit="mm")
PLACES = Output(unit="mm", dims=("place",), coordinates={"place": np.arange(3.0)})
GRID = Output(
    unit="mm", dims=("i", "j"), coordinates={"i": np.arange(2.0), "j": np.arange(2.0)}, gaps=True
)


def answer(value, output=Y):
    """Outcome of a solver that returns `value` as its output y."""
    return evaluate(lambda: {"y": value}, {}, {"y": output})


def number(value, output=Y):
    outcome = answer(value, output)
    assert outcome.status == "ok", outcome.message
    return outcome.fields["y"].tolist() if output.dims else outcome.outputs["y"]


def sentence(value, output=Y):
    outcome = answer(value, output)
    assert (outcome.status, outcome.outputs, outcome.fields) == ("failed", {}, {})
    return outcome.message


@pytest.mark.parametrize(
    "value",
    [2, 2.0, np.float32(2), np.int8(2), np.array(2), decimal.Decimal(2), fractions.Fraction(2)]
    + [np.array(2, dtype=object), np.array(np.float16(2), dtype=object), xr.DataArray(2.0)],
)
def test_a_number_is_a_number(value):
    assert number(value) == 2.0 and type(number(value)) is float


@pytest.mark.parametrize(
    "value", [[1, 2.0, 3], (1, 2, 3), np.array([1, 2, 3]), range(1, 4), [np.array(1), 2, 3]]
)
def test_lists_and_arrays_are_fields(value):
    assert number(value, PLACES) == [1.0, 2.0, 3.0]


# Units


@pytest.mark.parametrize(
    "value, expected",
    [
        (THEIRS.Quantity(4.5, "m"), 4500.0),
        (THEIRS.Quantity(2.0, "barleycorn"), 16.94),
        (xr.DataArray(4.5, attrs={"units": "m"}), 4500.0),
    ],
)
def test_a_quantity_is_converted_to_the_declared_unit(value, expected):
    assert number(value) == pytest.approx(expected, rel=1e-12)


def test_scales_with_an_offset_and_pure_numbers_are_converted():
    """20 degC are 293.15 K; 1 mm/m is 0.001."""
    celsius = THEIRS.Quantity(20.0, "degC")
    assert number(celsius, Output(unit="K")) == pytest.approx(293.15, rel=1e-12)
    assert number(THEIRS.Quantity(1.0, "mm/m"), Output()) == pytest.approx(0.001, rel=1e-12)


def test_fields_of_quantities_are_converted():
    """A quantity of an array; a list or an array of quantities, one unit each."""
    metre = THEIRS.Quantity
    assert number(metre(np.array([1.0, 2.0, 3.0]), "m"), PLACES) == [1000.0, 2000.0, 3000.0]
    each = [metre(1, "m"), metre(2, "mm"), 3]
    objects = np.empty(3, dtype=object)
    objects[:] = each
    assert number(each, PLACES) == number(objects, PLACES) == [1000.0, 2.0, 3.0]


@pytest.mark.parametrize(
    "value, output, expected",
    [
        (THEIRS.Quantity(3.0, "kg"), Y, r"is 3.0 kilogram; it does not convert to 'mm'"),
        (THEIRS.Quantity(3.0, "kg"), Output(), r"does not convert to a number without unit"),
        (xr.DataArray(3.0, attrs={"units": "kg"}), Y, r"unit 'kg' does not convert to 'mm'"),
        (xr.DataArray(3.0, attrs={"units": "mmm m"}), Y, r"unit 'mmm m' is unknown"),
    ],
)
def test_a_quantity_of_another_dimension_is_a_failed_run(value, output, expected):
    assert expected in sentence(value, output) and sentence(value, output).startswith("output 'y' ")


class Length:
    """A quantity as astropy and unyt write it: `to` and `value`."""

    unit = "m"

    def __init__(self, value):
        self.value = value

    def to(self, unit):
        assert unit == "mm"
        return Length(1000.0 * self.value)


def test_quantities_of_other_libraries_are_converted():
    assert number(Length(4.5)) == 4500.0


# Gaps and labels


def test_what_is_masked_is_no_number():
    """The value under a mask, 1e20 or older data, never becomes an answer."""
    one = np.ma.masked_array([1.0, 1e20, 3.0], mask=[False, True, False])
    assert sentence(one, PLACES) == "output 'y' is masked in 1 of 3 places"
    assert sentence(THEIRS.Quantity(one, "m"), PLACES) == "output 'y' is masked in 1 of 3 places"
    assert sentence(np.ma.masked) == "output 'y' is masked in 1 of 1 places"
    assert np.isnan(number(np.ma.masked, Output(unit="mm", gaps=True)))
    grid = np.ma.masked_array([[1, 2], [3, 4]], mask=[[False, True], [False, False]])
    np.testing.assert_array_equal(number(grid, GRID), [[1.0, np.nan], [3.0, 4.0]])
    assert number(np.ma.masked_array([1.0, 2.0, 3.0]), PLACES) == [1.0, 2.0, 3.0]


def test_dimensions_of_a_labelled_array_are_matched_by_name():
    """A square array of xarray with the dimensions in the other order is turned."""
    turned = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], dims=("j", "i"))
    assert number(turned, GRID) == [[1.0, 3.0], [2.0, 4.0]]


# No numbers


class Awkward:
    """An object whose texts and numbers raise."""

    def _refuse(self, *_):
        raise RuntimeError("not today")

    __array__ = __str__ = __repr__ = __float__ = __len__ = _refuse


class Unshowable:
    def __repr__(self):
        raise RuntimeError("not today")


class Leaving:
    def __array__(self, *_, **__):
        raise SystemExit(1)


@pytest.mark.parametrize(
    "value, expected",
    [
        ("4.5", "is '4.5'; it must be real numbers"),
        (b"4.5", "is b'4.5'; it must be real numbers"),
        (bytearray(b"4"), "must be real numbers|has shape"),
        (True, "is True; it must be real numbers"),
        (np.True_, "must be real numbers"),
        (np.array(True, dtype=object), "is True; it must be real numbers"),
        (np.datetime64("2026-01-01"), "must be real numbers"),
        (np.timedelta64(3, "s"), "must be real numbers"),
        (datetime.datetime(2026, 1, 1), "must be real numbers"),
        (datetime.timedelta(1), "must be real numbers"),
        (1j, "is 1j; it must be real numbers"),
        (None, "is None; it must be real numbers"),
        ({"a": 1}, "must be real numbers"),
        ([1.0], r"is \[1.0\]; the solver declares one number"),
        (10**400, "is 1000.*000; it is too large for a double"),
        (10**5000, "is an object of type int; it is too large for a double"),
        (decimal.Decimal("1e400"), "is inf; it must be finite|too large"),
        (np.longdouble("1e400"), "is inf; it must be finite"),
        (decimal.Decimal("sNaN"), "cannot be read: ValueError"),
        (Awkward(), "cannot be read: RuntimeError: not today .test_answers.py, line"),
        (Unshowable(), "is .*Unshowable.*; it must be real numbers"),
        (Leaving(), "cannot be read: SystemExit: 1"),
        (np.zeros(1, dtype=[("a", float)])[0], "must be real numbers"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_no_number_is_a_failed_run_that_names_the_output(value, expected):
    assert sentence(value).startswith("output 'y' ")
    assert re.search(expected, sentence(value)), sentence(value)
    assert len(sentence(value)) < 200


@pytest.mark.parametrize(
    "value, expected",
    [
        ([1.0, True, 2.0], "is True; it must be real numbers"),
        ([1.0, "2", 3.0], "is '2'; it must be real numbers"),
        ([1.0, None, 3.0], "is None; it must be real numbers"),
        ([1.0, [2.0], 3.0], "is [2.0]; the solver declares one number"),
        ([1.0, 10**400, 3.0], "it is too large for a double"),
        ([1.0, 2.0], "has 2 entries where the solver declares 3"),
        (np.array([1.0, "a", 3.0], dtype=object), "is 'a'; it must be real numbers"),
        (np.broadcast_to(0.0, (10**6, 10**6)), "has shape (1000000, 1000000)"),
        (np.array([True, False, True]), "it must be real numbers"),
    ],
    ids=str,
)
def test_no_field_is_a_failed_run_that_names_the_output(value, expected):
    assert sentence(value, PLACES).startswith("output 'y' ")
    assert expected in sentence(value, PLACES)


def test_lists_inside_lists_are_read_no_deeper_than_declared():
    """A list that holds itself, and one of 10^9 entries in ten lists."""
    endless: list = []
    endless.extend([endless] * 3)
    assert "the solver declares one number" in sentence(endless, PLACES)
    bomb = [0.0] * 10
    for _ in range(8):
        bomb = [bomb] * 10
    assert "has 10 entries where the solver declares 3" in sentence(bomb, PLACES)
    assert len(sentence(bomb)) < 200


class Odd(Mapping):
    """A mapping that breaks its own rules."""

    def __init__(self, contains=True, keys=("y",)):
        self.contains, self.keys_ = contains, keys

    def __contains__(self, key):
        if self.contains is None:
            raise RuntimeError("no idea")
        return self.contains

    def __getitem__(self, key):
        raise KeyError(key)

    def __iter__(self):
        return iter(self.keys_)

    def __len__(self):
        return -1


@pytest.mark.parametrize(
    "result, expected",
    [
        (Odd(), "output 'y' cannot be read: KeyError: 'y'"),
        (Odd(contains=None), "output 'y' cannot be read: RuntimeError: no idea"),
        (Odd(contains=False, keys=[Awkward()]), "output 'y' cannot be read: RuntimeError: not"),
        (Odd(contains=False, keys=range(10**9)), "the solver did not return 'y'; it returned 0, 1"),
        (3.0, "the solver returned float; it must return a mapping"),
        ([("y", 1.0)], "the solver returned list; it must return a mapping"),
    ],
    ids=["getitem", "contains", "keys", "endless", "float", "pairs"],
)
def test_an_odd_mapping_is_a_failed_run(result, expected):
    outcome = evaluate(lambda: result, {}, {"y": Y})
    assert outcome.status == "failed" and outcome.message.startswith(expected)


# Exceptions


class Mute(Exception):
    def __str__(self):
        raise RuntimeError("no words")


class MuteRefusal(SolverError):
    __str__ = Mute.__str__


def raising(error):
    def solver():
        raise error

    return evaluate(solver, {}, {"y": Y})


@pytest.mark.parametrize(
    "error, answered, expected",
    [
        (Mute(), False, "Mute: its message cannot be shown (test_answers.py, line "),
        (MuteRefusal(), True, "its message cannot be shown"),
        (asyncio.CancelledError(), False, "CancelledError (test_answers.py, line "),
        (GeneratorExit(), False, "GeneratorExit (test_answers.py, line "),
        (SolverError(), True, "the solver has no answer here and does not say why"),
        (ValueError("a\n  b"), False, "ValueError: a b (test_answers.py, line "),
    ],
    ids=lambda value: type(value).__name__,
)
def test_whatever_a_solver_raises_is_one_sentence(error, answered, expected):
    outcome = raising(error)
    assert (outcome.status, outcome.answered) == ("failed", answered)
    assert outcome.message.startswith(expected)


def test_a_long_message_is_cut():
    assert len(raising(SolverError("x" * 10**6)).message) == LONGEST_MESSAGE


def test_ctrl_c_is_no_answer():
    with pytest.raises(KeyboardInterrupt):
        raising(KeyboardInterrupt())
