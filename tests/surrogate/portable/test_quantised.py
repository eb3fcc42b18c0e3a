"""Numbers to a step come back within half of it, whole ones exactly."""

import numpy as np

from surrogate.portable import quantised


def test_rows_come_back_within_half_a_step():
    rows = np.cumsum(np.random.default_rng(0).normal(size=(3, 500)), axis=1)
    rows[1] *= 1e-6
    error = np.abs(quantised.read(quantised.quantised(rows)) - rows)
    assert (error.max(axis=1) <= np.ptp(rows, axis=1) / 131_070 * (1 + 1e-9)).all()


def test_rows_that_may_be_coarse_take_half_the_room():
    rows = np.random.default_rng(0).normal(size=(2, 500))
    packed = quantised.quantised(rows, np.array([0.0, 0.1]))
    sizes = [row.split()[2] for row in packed["steps"]]
    assert sizes == ["2", "1"]
    assert np.abs(quantised.read(packed) - rows)[1].max() <= np.ptp(rows[1]) / 510 * (1 + 1e-9)
    assert quantised.cost(packed)[1] < 0.6 * quantised.cost(packed)[0]


def test_whole_numbers_and_constant_rows_are_exact():
    numbers = np.array([[0, 65535, 7, 7, 4999]])
    assert np.array_equal(quantised.read(quantised.whole(numbers)), numbers)
    assert np.array_equal(quantised.read(quantised.quantised([[2.5] * 4])), [[2.5] * 4])
