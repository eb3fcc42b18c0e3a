"""Numbers as printed."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from surrogate.report import digits

MINUS, THIN = digits.MINUS, digits.THIN


@pytest.mark.parametrize(
    "value, words",
    [
        (0.0, "0"),
        (1234.5, "1234"),
        (0.123456, "0.123"),
        (-2.5, f"{MINUS}2.50"),
        (99.96, "100.0"),
        (123456.0, f"123{THIN}456"),
        (1.234e-5, "1.23 × 10⁻⁵"),
        (-4.5e8, f"{MINUS}4.50 × 10⁸"),
        (math.nan, digits.NOTHING),
        (None, digits.NOTHING),
        (math.inf, "∞"),
    ],
)
def test_figure(value, words):
    """Three significant digits, true minus, powers of ten only where needed."""
    assert digits.figure(value) == words


def test_uncertainty_decides_the_decimals():
    """Two significant digits of the half-width, and the value to the same decimal."""
    assert digits.with_half(11.5432, 0.1234) == "11.54 ± 0.12"
    assert digits.with_half(1234.56, 34.0) == "1235 ± 34"
    assert digits.with_interval(0.7089, 0.6901, 0.7312) == "0.709 (0.690 to 0.731)"
    assert digits.with_interval(1e-5, 0.0, 0.018) == "0.0000 (0.0000 to 0.0180)"
    assert digits.with_interval(0.0, 0.0, 0.000131, most=4) == "0.0000 (0.0000 to 0.0001)"
    assert digits.with_half(3.0, math.nan) == "3.00"


def test_interval_shows_on_which_side_of_zero_it_ends():
    """An interval that just excludes zero does not end at 0.0."""
    assert digits.interval(0.6901, 0.7312) == "0.690 to 0.731"
    assert digits.interval(-2.38, -0.043) == f"{MINUS}2.38 to {MINUS}0.04"
    assert digits.interval(0.0, 2.4) == "0.0 to 2.4"


def test_percent_is_never_rounded_to_all_or_nothing():
    """99.97 % is not 100 %, and 0.01 % is not 0 %."""
    assert digits.percent(0.934) == f"93.4{THIN}%" and digits.percent(0.95) == f"95{THIN}%"
    assert digits.percent(0.9997).startswith("above") and digits.percent(1.0) == f"100{THIN}%"
    assert digits.percent(0.0001).startswith("below") and digits.percent(0.0) == f"0{THIN}%"


def test_score_is_one_only_when_perfect():
    """R2 = 0.9995 is not 1.000."""
    assert [digits.score(v) for v in (0.987, 0.9995, 0.99997, 1.0, -3.2)] == [
        "0.987",
        "0.9995",
        "0.99997",
        "1.000",
        f"{MINUS}3.200",
    ]


def test_p_value_has_a_floor():
    """Nothing is claimed below one in a thousand."""
    assert digits.p_value(3e-17) == f"<{THIN}0.001" and digits.p_value(0.0214) == "0.021"


@pytest.mark.parametrize(
    "seconds, words",
    [
        (0.42, f"0.42{THIN}s"),
        (0.0042, f"4.2{THIN}ms"),
        (2e-6, f"2.0{THIN}µs"),
        (190.0, f"3{THIN}min 10{THIN}s"),
        (7500.0, f"2{THIN}h 5{THIN}min"),
        (250_000.0, "2.9 days"),
    ],
)
def test_duration(seconds, words):
    """The unit that people would use."""
    assert digits.duration(seconds) == words


def test_units_and_labels():
    """Powers are raised; what has no unit says so."""
    assert digits.unit("mm**2") == "mm²" and digits.unit("kg*m/s^-2") == "kg·m/s⁻²"
    assert digits.labelled("tension", "N/mm") == "tension (N/mm)"
    assert digits.labelled("mu", "") == f"mu ({digits.NOTHING})"


def test_column_lines_up():
    """One number of decimals for a column, enough to show its spread."""
    assert digits.column([1.0, 10.0, 5.55555]) == ["1.00", "10.00", "5.56"]
    assert digits.column([np.nan, 2.0]) == [digits.NOTHING, "2.00"]


def test_listing():
    """Words joined as in a sentence, cut short when there are too many."""
    assert digits.listing([]) == "" and digits.listing("a") == "a"
    assert digits.listing("abc") == "a, b and c"
    assert digits.listing("abcdef", 3) == "a, b, c and 3 more"
    assert digits.listing("abcd", 3) == "a, b, c and d"


def test_decimal_points_stand_below_each_other():
    """Set flush right, with spaces as wide as a digit and as a point for what is missing."""
    column = ["0.5", "12", "\N{MINUS SIGN}3.25", digits.NOTHING]
    wide = digits.FIGURE_SPACE
    assert digits.aligned(column) == [
        f"0.5{wide}", f"12{digits.POINT_SPACE}{wide * 2}", "\N{MINUS SIGN}3.25", digits.NOTHING,
    ]  # fmt: skip
    behind = [
        len(word) - re.search(r"[.\u2008]", word).start() for word in digits.aligned(column)[:3]
    ]
    assert set(behind) == {3}


def test_every_number_of_a_pattern_is_aligned():
    """Values, ends and units; words of several patterns are left alone."""
    told = digits.aligned(["0.71 (0.69 to 0.73) m", "12.5 (9.25 to 16) m"])
    assert len(told[0]) - told[0].index(".") == len(told[1]) - told[1].index(".")
    assert (
        digits.aligned(["100 %", "81.8 %"])[0] == f"100 %{digits.POINT_SPACE}{digits.FIGURE_SPACE}"
    )
    assert [" ".join(word.split()) for word in told] == [
        "0.71 (0.69 to 0.73) m", "12.5 (9.25 to 16) m",
    ]  # fmt: skip
    mixed = ["1.5 ms", "2 s"]
    assert digits.aligned(mixed) == mixed
    assert digits.aligned([]) == [] and digits.aligned(["yes", "no"]) == ["yes", "no"]
