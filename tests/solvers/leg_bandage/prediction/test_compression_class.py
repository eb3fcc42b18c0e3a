"""Compression classes, as printed by the standards."""

import pytest

from surrogate_solvers.leg_bandage.prediction.compression_class import (
    BS,
    RAL,
    class_of,
    class_words,
    nearest_class,
)


@pytest.mark.parametrize(
    "pressure, ral, bs",
    [
        (10.0, "below I", "below 1"),
        (17.4, "below I", "1"),
        (17.6, "I", "2"),
        (21.0, "I", "2"),
        (22.0, "between I and II", "2"),
        (23.0, "II", "2"),
        (32.4, "II", "3"),
        (33.0, "between II and III", "3"),
        (40.0, "III", "above 3"),
        (47.5, "between III and IV", "above 3"),
        (49.0, "IV", "above 3"),
        (90.0, "IV", "above 3"),
    ],
)
def test_limits_of_both_standards(pressure, ral, bs):
    """RAL-GZ 387: 18-21, 23-32, 34-46, from 49; Drug Tariff 40: 14-17, 18-24, 25-35 mmHg."""
    assert (class_words(pressure, RAL), class_words(pressure, BS)) == (ral, bs)


def test_class_in_words_and_the_nearest_one():
    assert str(class_of(40.0, RAL)) == "RAL-GZ 387 class III (34 to 46 mmHg)"
    assert str(class_of(60.0, RAL)) == "RAL-GZ 387 class IV (from 49 mmHg)"
    assert class_of(22.0, RAL) is None and class_of(40.0, BS) is None
    assert [nearest_class(p, RAL).name for p in (5, 21.6, 22.4, 47.0, 80)] == [
        "I",
        "I",
        "II",
        "III",
        "IV",
    ]
