"""Units: the figures of Chassagne 2018 from one unit to another."""

import pytest

from surrogate.errors import StudyError
from surrogate.space import units


@pytest.mark.parametrize(
    "value, unit, target, answer",
    [
        (18.486, "cm", "mm", 184.86),
        (0.098, "N/mm", "N/m", 98.0),
        (14.3, "MPa", "kPa", 14300.0),
        (1.0, "mmHg", "Pa", 133.322),
        (20.0, "degC", "K", 293.15),
    ],
)
def test_values_convert(value, unit, target, answer):
    """NIST SP 811 factors."""
    assert units.conversion(unit, target).place(value) == pytest.approx(answer, rel=1e-5)


def test_a_spread_of_temperatures_has_no_offset():
    """A standard deviation of 2 degC is one of 2 K."""
    assert units.conversion("degC", "K").distance(2.0) == pytest.approx(2.0)


@pytest.mark.parametrize(
    "unit, target, words",
    [
        ("mm", "N/mm", "does not convert"),
        ("furlogn", "mm", "is unknown"),
        ("mm", "", "a number without unit"),
        ("N/(mm", "N/mm", "is unknown"),
    ],
)
def test_wrong_units_are_sentences(unit, target, words):
    """Units that do not fit are refused by name."""
    with pytest.raises(StudyError, match=words):
        units.conversion(unit, target)


def test_durations():
    """Durations of the study file in seconds."""
    assert [units.seconds(t) for t in ("30 min", "2 h", "1.5 s", 7)] == [1800.0, 7200.0, 1.5, 7.0]
    with pytest.raises(StudyError, match="30 min"):
        units.seconds("30 parsecs")


def test_quantities_carry_their_unit():
    """`98 N/m` is 0.098 N/mm; a bare number is in the target unit."""
    assert units.quantity("98 N/m", "N/mm") == pytest.approx(0.098)
    assert units.quantity("0.098", "N/mm") == 0.098
    assert units.quantity("20cm", "mm") == units.quantity("2e2mm", "mm") == 200.0
    assert units.quantity("-1.5e-3", "mm") == -0.0015
    assert units.quantity("5 1/m", "1/mm") == pytest.approx(0.005)
    assert units.quantity("25 °C", "K") == pytest.approx(298.15)
    for wrong in ("1,5", "1.2.3", "--1"):
        with pytest.raises(StudyError, match="is not a number"):
            units.quantity(wrong, "mm")
    with pytest.raises(StudyError, match="not a number"):
        units.quantity("much", "mm")


@pytest.mark.parametrize(
    "text",
    [
        "9**9**9**9",
        "9^9^9^9",
        "(9**9)**(9**9)",
        "m**9**9**9",
        "m**(9**(9**9))",
        "m*9e99999",
        "9*,*9*,*9*,*9",
        "m**999999999",
        "mm" * 60,
        "(" * 5000 + "m" + ")" * 5000,
    ],
)
def test_a_unit_that_would_be_computed_for_ever_is_refused_unread(text):
    """What pint would compute is never given to it; the answer is a short sentence."""
    assert not units.known(text)
    for wrong in (
        lambda: units.conversion(text, "mm"),
        lambda: units.seconds(text),
        lambda: units.seconds(f"3 {text}"),
        lambda: units.quantity(f"3 {text}", "mm"),
    ):
        with pytest.raises(StudyError) as caught:
            wrong()
        assert len(str(caught.value)) < 400


@pytest.mark.parametrize(
    "text",
    [
        *("", "1", "1/s", "N/mm", "mm**2", "m^2", "m^-2", "mmHg**0.5", "kg m^2 / s^2", "(N/mm)^2"),
        *("%", "°C", "µm", "m²", "degC", "m**(-2)", "cmH2O", "mmHg**2/mm", "delta_degC"),
        *("meter per second", "square meter", "kg * m ** -1 * s ** -2"),
    ],
)
def test_units_that_people_write_are_read(text):
    assert units.known(text)


@pytest.mark.parametrize("unit", ["", "1", "dimensionless"])
def test_numbers_without_unit_are_known_by_three_names(unit):
    assert units.dimensionless(unit) and not units.dimensionless("1/s")
