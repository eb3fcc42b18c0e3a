import functools
import itertools
import math
import operator

import numpy as np
import pytest

from surrogate.designs import regular_fraction
from surrogate.designs.aliasing import aliasing
from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.minimum_aberration import TABLE, fewest_runs, fraction, search
from surrogate.errors import DesignError

KEYS = [
    "3-1",
    "4-1",
    "5-1",
    "5-2",
    "6-1",
    "6-2",
    "6-3",
    "7-1",
    "7-2",
    "7-3",
    "7-4",
    "8-2",
    "8-3",
    "8-4",
    "9-2",
    "9-3",
    "9-4",
    "9-5",
    "10-3",
    "10-4",
    "10-5",
    "10-6",
    "11-5",
    "11-6",
]
RESOLUTIONS = {"III": 3, "IV": 4, "V": 5}


def brute_force_words(coded):
    """Number of constant products of 1, 2, .. columns, by multiplying all of them out."""
    factors = coded.shape[1]
    return [
        sum(
            abs(coded[:, list(chosen)].prod(axis=1).sum()) == len(coded)
            for chosen in itertools.combinations(range(factors), length)
        )
        for length in range(1, factors + 1)
    ]


def test_reference_lists_every_key(reference):
    """The 24 designs of the reference are all tested."""
    assert sorted(reference["fractions"]) == sorted(KEYS)


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("by", ["generators", "runs"])
def test_published_fractions(reference, cube, key, by):
    """Box, Hunter and Hunter 1978, table 12.15: runs, resolution, word lengths, words."""
    published = reference["fractions"][key]
    space = cube(published["factors"])
    coded = fractional_factorial(space, **{by: published[by]})
    found = aliasing(space, coded)
    assert coded.shape == (published["runs"], published["factors"])
    assert found.resolution == published["resolution"]
    assert list(found.word_length_pattern) == published["wlp_from_length3"]
    words = [word.replace(":", "") for word in found.defining_words]
    assert words == published["defining_words"] or len(words) == published["defining_words"]


@pytest.mark.parametrize("key", KEYS)
def test_words_by_brute_force(reference, cube, key):
    """Constant products of columns, counted without any theory, agree with the pattern."""
    published = reference["fractions"][key]
    coded = fractional_factorial(cube(published["factors"]), runs=published["runs"])
    assert brute_force_words(coded) == [0, 0, *published["wlp_from_length3"]]


@pytest.mark.parametrize("size", sorted(TABLE))
def test_search_is_as_good_as_the_table(size):
    """The search alone reaches the minimum aberration of every published fraction."""
    factors, generators = size
    base = factors - generators
    lengths = [
        regular_fraction.word_lengths(regular_fraction.weights(masks, base), factors)
        for masks in (search(factors, base), fraction(factors, base))
    ]
    assert lengths[0] == lengths[1]


@pytest.mark.parametrize("roman", RESOLUTIONS)
def test_fewest_runs(reference, cube, roman):
    """Box and Hunter 1961: the smallest fractions of resolution III, IV and V."""
    for factors, runs in reference["fewest_runs"][roman].items():
        space = cube(int(factors))
        coded = fractional_factorial(space, resolution=roman)
        assert len(coded) == runs
        lengths = (
            brute_force_words(coded)
            if space.size <= 9
            else [*aliasing(space, coded).word_length_pattern]
        )
        offset = 1 if space.size <= 9 else 3
        shortest = next((i for i, n in enumerate(lengths, offset) if n), math.inf)
        assert shortest >= RESOLUTIONS[roman]


@pytest.mark.parametrize(
    "factors, resolution, base",
    [
        (12, 5, 8),
        (17, 5, 8),
        (12, 6, 8),
        (31, 3, 5),
        (32, 4, 6),
        (24, 4, 6),
        (23, 5, 9),
        (30, 5, 10),
        (100, 4, 8),
    ],
)
def test_fractions_beyond_the_table(factors, resolution, base):
    """Most factors of resolution V: 17 in 256 runs, 23 in 512 (Draper and Lin 1990)."""
    masks = fewest_runs(factors, resolution, 14)
    assert max(masks).bit_length() == base and len(set(masks)) == factors
    # Independent of the search: no sum of fewer than `resolution` masks is zero.
    for length in range(1, resolution):
        for chosen in itertools.combinations(masks, length):
            assert functools.reduce(operator.xor, chosen) != 0


@pytest.mark.parametrize(
    "factors, base, pattern",
    [
        (11, 4, (12, 26, 28, 24, 20, 13, 4)),
        (15, 4, (35, 105)),
        (12, 5, (0, 38, 0, 52)),
        (11, 7, (0, 0, 6, 6, 2, 1)),
        (16, 5, (0, 140)),
    ],
)
def test_minimum_aberration_beyond_the_table(factors, base, pattern):
    """Chen, Sun and Wu 1993 (word-length patterns of minimum aberration fractions)."""
    masks = fraction(factors, base)
    lengths = regular_fraction.word_lengths(regular_fraction.weights(masks, base), factors)
    assert lengths[3 : 3 + len(pattern)] == pattern


def test_word_lengths_agree_with_enumeration():
    """MacWilliams 1963: the pattern from run weights equals that from listing all words."""
    masks, base = (1, 2, 4, 8, 7, 11, 13, 3, 12), 4
    counted = [0] * (len(masks) + 1)
    for chosen in itertools.product((0, 1), repeat=len(masks)):
        total = 0
        for mask, used in zip(masks, chosen, strict=True):
            total ^= mask * used
        counted[sum(chosen)] += total == 0
    assert regular_fraction.word_lengths(
        regular_fraction.weights(masks, base), len(masks)
    ) == tuple(counted)


def test_traps_of_other_programs(cube):
    """16 runs hold 7 factors in resolution IV, 8 runs in III; (4, 4) and (5, 5) exist."""
    for factors, resolution, runs in [
        (7, 3, 8),
        (7, 4, 16),
        (4, 4, 8),
        (5, 5, 16),
        (7, 5, 64),
        (8, 5, 64),
        (9, 5, 128),
    ]:
        assert len(fractional_factorial(cube(factors), resolution=resolution)) == runs


@pytest.mark.parametrize("factors", [1, 2, 3, 5])
def test_resolution_above_the_number_of_factors_is_a_full_factorial(cube, factors):
    """Only the full factorial has no word at all."""
    coded = fractional_factorial(cube(factors), resolution=factors + 3)
    np.testing.assert_array_equal(coded, full_factorial(cube(factors)))


def test_orthogonal_and_balanced(cube):
    """Main effects of a resolution III fraction are orthogonal to each other and the mean."""
    coded = fractional_factorial(cube(15), resolution=3)
    matrix = np.column_stack([np.ones(len(coded)), coded])
    np.testing.assert_array_equal(matrix.T @ matrix, 16 * np.eye(16))


def test_center_points_stand_at_the_end(cube):
    """The last rows are the middle of every range."""
    coded = fractional_factorial(cube(7), resolution=3, center_points=2)
    assert coded.shape == (10, 7)
    assert not coded[8:].any() and np.abs(coded[:8]).min() == 1


@pytest.mark.parametrize("generators", [["C = -AB"], ["C=-A*B"], ["-AB"], ["C = - A:B"]])
def test_signs_of_generators(cube, generators):
    """The alternate fraction: C = -AB."""
    coded = fractional_factorial(cube(3), generators=generators)
    np.testing.assert_array_equal(coded[:, 2], -coded[:, 0] * coded[:, 1])


def test_generators_by_name(mixed, cube):
    """Names joined by * or :, letters by position, and any parameter may be made."""
    space = type(mixed)(tuple(p for p in mixed.parameters if p.name != "posture"))
    for text in ("tension = bandage * mu", "tension = bandage:mu", "A = BC"):
        coded = fractional_factorial(space, generators=[text])
        np.testing.assert_array_equal(coded[:, 0], coded[:, 1] * coded[:, 2])


@pytest.mark.parametrize(
    "options, said",
    [
        ({}, "give one of resolution, runs and generators"),
        ({"resolution": 3, "runs": 8}, "2 given"),
        ({"resolution": 2}, "resolution: 2 must be a whole number of at least 3"),
        ({"resolution": "X"}, "resolution: 'X'"),
        ({"runs": 12}, "runs: 12 is not the size .* use one of 8, 16, 32, 64"),
        ({"runs": 4}, "use one of 8"),
        ({"generators": "AB"}, "must be a list"),
        ({"generators": ["F = AX"]}, "'X' in 'F = AX' is not a parameter"),
        ({"generators": ["F = A", "E = AB"]}, "makes F change together with A"),
        ({"generators": ["F = AB", "E = AB"]}, "makes E change together with F"),
        ({"generators": ["F = AB", "E = AF"]}, "uses F, which a generator makes"),
        ({"generators": ["F = AB", "F = AC"]}, "F is made twice"),
        ({"generators": ["F = AA"]}, "makes F constant"),
        ({"generators": ["F = "]}, "'nothing' in 'F = '"),
        ({"generators": ["A", "B", "C", "A", "B", "C"]}, "leave no base factor"),
        ({"generators": ["AB = CD"]}, "must have one parameter left"),
        ({"resolution": 3, "center_points": -1}, "center_points: -1"),
    ],
)
def test_mistakes_are_sentences(cube, options, said):
    """Each mistake names the value and what is allowed."""
    with pytest.raises(DesignError, match=said):
        fractional_factorial(cube(6), **options)


def test_all_generator_mistakes_at_once(cube):
    """Two wrong generators give two sentences."""
    with pytest.raises(DesignError) as caught:
        fractional_factorial(cube(6), generators=["E = AX", "F = AY"])
    assert len(str(caught.value).splitlines()) == 2


def test_three_levels_and_no_range_are_refused(mixed, unbounded):
    """Two-level designs cannot place three levels, nor the ends of an unbounded parameter."""
    with pytest.raises(DesignError, match="posture: .* 3 .*lying, sitting, standing"):
        fractional_factorial(mixed, resolution=3)
    with pytest.raises(DesignError, match="c10: .* give it a range"):
        fractional_factorial(unbounded, resolution=3)
