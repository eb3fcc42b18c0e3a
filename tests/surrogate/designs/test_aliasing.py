import numpy as np

from surrogate.designs.aliasing import aliasing
from surrogate.designs.center_points import center_points
from surrogate.designs.fold_over import fold_over
from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.plackett_burman import plackett_burman
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def test_table_names_three_interactions_for_each_main_effect(cube):
    """2^(7-4) of resolution III: each main effect is aliased with three interactions."""
    space = cube(7)
    table = dict(aliasing(space, fractional_factorial(space, resolution=3)).table)
    assert len(table) == 7 + 21
    assert table["A"] == ["B:D", "C:E", "F:G"]
    assert table["B:D"] == ["A", "C:E", "F:G"]
    assert all(len(aliases) == 3 for aliases in table.values())


def test_table_agrees_with_products_of_columns(cube):
    """Two effects are aliased exactly when their columns are equal, or opposite (minus)."""
    space = cube(6)
    coded = fractional_factorial(space, generators=["E = ABC", "F = -BCD"])
    value = {name: coded[:, j] for j, name in enumerate(space.names)}

    def column(effect):
        return np.prod([value[name] for name in effect.lstrip("-").split(":")], axis=0)

    table = dict(aliasing(space, coded).table)
    for effect, aliases in table.items():
        expected = {
            other if (column(effect) == column(other)).all() else f"-{other}"
            for other in table
            if other != effect and abs(column(effect) @ column(other)) == len(coded)
        }
        assert set(aliases) == expected


def test_signs_of_the_defining_relation(cube):
    """C = -AB gives I = -ABC, and A is estimated as -BC."""
    found = aliasing(cube(3), fractional_factorial(cube(3), generators=["C = -AB"]))
    assert found.defining_words == ("-A:B:C",)
    assert dict(found.table)["A"] == ["-B:C"]


def test_printed_table_says_each_chain_once(cube):
    """The text has the resolution, the defining relation and one line a chain."""
    space = Space(tuple(Parameter(name, uniform(0, 1)) for name in ("mu", "tension", "length")))
    text = str(aliasing(space, fractional_factorial(space, resolution=3)))
    assert text.splitlines() == [
        "resolution 3; I = mu:tension:length",
        "mu = tension:length",
        "tension = mu:length",
        "length = mu:tension",
    ]
    assert "no effect is aliased" in str(aliasing(space, full_factorial(space)))


def test_centre_points_do_not_matter(cube, mixed):
    """Neither true centre points nor those at each level of a categorical parameter."""
    space = cube(5)
    plain = fractional_factorial(space, resolution=3)
    centred = fractional_factorial(space, resolution=3, center_points=3)
    assert aliasing(space, plain) == aliasing(space, centred)
    mixed = Space(tuple(p for p in mixed.parameters if len(p.levels) != 3))
    coded = fractional_factorial(mixed, resolution=3)
    grown = np.vstack([coded, center_points(mixed, coded)])
    assert aliasing(mixed, grown) == aliasing(mixed, coded)


def test_replicates_are_one_design(cube):
    """Every run twice is still the same fraction; one run twice is not regular."""
    space = cube(4)
    coded = fractional_factorial(space, resolution=4)
    assert aliasing(space, np.vstack([coded, coded])).defining_words == ("A:B:C:D",)
    assert aliasing(space, np.vstack([coded, coded[:1]])) is None


def test_not_a_regular_fraction(cube):
    """Plackett-Burman in 12 runs, Latin hypercubes and odd sets of corners have no words."""
    assert aliasing(cube(11), plackett_burman(cube(11))) is None
    assert aliasing(cube(3), latin_hypercube(cube(3), runs=8, seed=1)) is None
    assert aliasing(cube(3), full_factorial(cube(3))[:7]) is None
    assert aliasing(cube(3), full_factorial(cube(3), levels=3)) is None


def test_full_fold_over_of_resolution_three_is_four(cube):
    """Box and Wilson 1951: reversing all signs cancels every word of odd length."""
    space = cube(7)
    coded = fractional_factorial(space, resolution=3)
    folded = aliasing(space, np.vstack([coded, fold_over(space, coded)]))
    assert folded.resolution == 4
    assert folded.word_length_pattern == (0, 7, 0, 0, 0)


def test_many_generators_list_a_generating_set(cube):
    """31 factors in 32 runs have 2^26 - 1 words: 26 that generate them are listed."""
    space = cube(31)
    found = aliasing(space, fractional_factorial(space, resolution=3))
    assert found.resolution == 3 and len(found.defining_words) == 26
    assert found.word_length_pattern[0] == 155  # lines of the projective space PG(4, 2)
