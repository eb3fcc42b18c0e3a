"""Blocks of two-level fractions: what is given up for them, against published arrangements."""

import itertools

import numpy as np
import pytest

from surrogate.cli.standing import check
from surrogate.designs.aliasing import aliasing
from surrogate.designs.blocks import block_numbers
from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.errors import DesignError, StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.polynomial import Linear
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.study import Study


def space(factors, blocks):
    numbers = tuple(Parameter(name, uniform(-1, 1)) for name in "abcdefgh"[:factors])
    days = Parameter("day", levels=tuple(f"d{k}" for k in range(blocks)))
    return Space((numbers[0], days, *numbers[1:]))


def confounded(design, blocks):
    """Orders of all effects that are constant within blocks, found by trying all."""
    which = np.unique(design[:, 1], return_inverse=True)[1].ravel()
    corners = np.delete(design, 1, axis=1)
    orders = []
    for order in range(1, corners.shape[1] + 1):
        for term in itertools.combinations(range(corners.shape[1]), order):
            column = corners[:, term].prod(axis=1)
            sums = np.bincount(which, column)
            orders += [order] * bool((np.abs(sums) == np.bincount(which)).all())
    return sorted(orders)


@pytest.mark.parametrize(
    ("factors", "blocks", "orders"),
    [
        (3, 2, [3]),
        (3, 4, [2, 2, 2]),
        (4, 2, [4]),
        (4, 4, [2, 3, 3]),
        (4, 8, [2, 2, 2, 2, 2, 2, 4]),
        (5, 2, [5]),
        (5, 4, [3, 3, 4]),
        (5, 8, [2, 2, 3, 3, 3, 3, 4]),
        (5, 16, [2] * 10 + [4] * 5),
        (6, 2, [6]),
        (6, 4, [4, 4, 4]),
        (6, 8, [3, 3, 3, 3, 4, 4, 4]),
        (7, 8, [4, 4, 4, 4, 4, 4, 4]),
    ],
)
def test_factorials_in_blocks_are_those_of_montgomery(factors, blocks, orders):
    """Design and Analysis of Experiments, table 7.9: which effects each arrangement gives up."""
    design = fractional_factorial(space(factors, blocks), runs=2**factors, blocks="day")
    assert confounded(design, blocks) == orders
    _, sizes = np.unique(design[:, 1], return_counts=True)
    assert set(sizes) == {2**factors // blocks}


def test_a_fraction_in_blocks_keeps_main_effects_and_most_interactions():
    """2^(6-2) in two blocks of eight: an effect without main effects or pairs among its aliases."""
    design = fractional_factorial(space(6, 2), runs=16, blocks="day")
    assert min(confounded(design, 2)) == 3
    assert (np.diff(design[:, 1]) >= 0).all()  # block by block
    numbers = np.delete(design, 1, axis=1)
    assert np.allclose(numbers.T @ numbers, 16 * np.eye(6))
    assert np.allclose(numbers.T @ design[:, 1], 0.0)


def test_each_block_has_its_centre_points():
    design = fractional_factorial(space(3, 2), runs=8, blocks="day", center_points=2)
    middle = design[(np.delete(design, 1, axis=1) == 0.0).all(axis=1)]
    assert sorted(middle[:, 1]) == [-1.0, -1.0, 1.0, 1.0]


def test_what_is_confounded_is_told():
    """As Montgomery has it for 2^4 in four blocks: two interactions of three, one of two."""
    of = space(4, 4)
    told = aliasing(of, fractional_factorial(of, runs=16, blocks="day"))
    assert told.resolution is None
    ((name, effects),) = told.blocks
    assert name == "day" and sorted(effect.count(":") for effect in effects) == [1, 2, 2]
    assert f"levels of day are confounded with {effects[0]}" in str(told)


def test_block_effects_do_not_touch_the_others():
    """y = 2 a - c + a shift of each day: a and c exact, the shifts told by the levels of day."""
    of = space(4, 4)
    design = fractional_factorial(of, runs=16, blocks="day")
    shift = np.array([5.0, -1.0, 0.0, 2.0])
    day = np.unique(design[:, 1], return_inverse=True)[1].ravel()
    own = fit(of, design, 2.0 * design[:, 0] - design[:, 3] + shift[day], Linear())
    table = own.estimator.regression_table()["coefficient"].to_series()
    assert table[["a", "b", "c", "d"]].to_numpy() == pytest.approx([2.0, 0.0, -1.0, 0.0], abs=1e-12)
    shifts = table[["day[d1]", "day[d2]", "day[d3]"]].to_numpy()
    assert shifts == pytest.approx([-2.5, -1.5, 0.5])


@pytest.mark.parametrize(
    ("of", "options", "told"),
    [
        (space(4, 4), {"runs": 16, "blocks": "week"}, "blocks: 'week' is no parameter"),
        (space(4, 4), {"runs": 16, "blocks": "a"}, "blocks: a has no levels"),
        (space(4, 3), {"runs": 16, "blocks": "day"}, "blocks: day has 3 levels"),
        (space(4, 8), {"runs": 8, "blocks": "day"}, "8 runs do not divide into 8 blocks"),
        (space(6, 4), {"runs": 8, "blocks": "day"}, "would hide a main effect"),
    ],
)
def test_mistakes_are_told(of, options, told):
    with pytest.raises(DesignError, match=told):
        fractional_factorial(of, **options)


def test_large_fractions_divide_well():
    """2^(10-2), 256 runs in 8 blocks: no pair is given up."""
    corners = np.where(np.arange(256)[:, None] >> np.arange(8) & 1, 1.0, -1.0)
    corners = np.column_stack([corners, corners[:, :5].prod(axis=1), corners[:, 3:].prod(axis=1)])
    block = block_numbers(corners, 8)
    pairs = [corners[:, t].prod(axis=1) for t in itertools.combinations(range(10), 2)]
    sums = [np.abs(np.bincount(block, column)).max() for column in [*corners.T, *pairs]]
    assert max(sums) == 0.0


STUDY = {
    "study": "demo",
    "solver": {
        "name": "laboratory",
        "options": {
            "inputs": {
                "a": {"range": [0, 1]},
                "b": {"range": [0, 1]},
                "c": {"range": [0, 1]},
                "day": {"levels": ["mon", "tue", "wed", "thu"]},
            },
            "outputs": {"y": {}},
        },
    },
    "designs": {"train": {"method": "fractional_factorial", "runs": 8, "blocks": "day"}},
    "surrogates": {"linear": "linear"},
}


def test_check_tells_what_blocks_hide(tmp_path):
    words = {"a": [0, 1], "b": [0, 1], "c": [0, 1], "day": {"levels": ["mon", "tue", "wed", "thu"]}}
    study = Study.from_mapping({**STUDY, "parameters": words})
    text = "\n".join(map(str, check(study, tmp_path).parts))
    assert "levels of day are confounded with a:b, a:c, b:c" in text


def test_a_study_tells_mistakes_at_their_place():
    words = {"a": [0, 1], "b": [0, 1], "c": [0, 1]}
    with pytest.raises(StudyError, match="designs.train.*blocks: 'day' is no parameter"):
        Study.from_mapping({**STUDY, "parameters": words})
