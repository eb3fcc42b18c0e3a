import itertools

import numpy as np
import pytest
from scipy.spatial.distance import pdist
from scipy.stats import qmc, spearmanr

from surrogate.designs.halton import halton
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.sobol import sobol
from surrogate.errors import DesignError
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SEQUENCES = [sobol, halton]
ALL = [sobol, halton, latin_hypercube]


def slices(coded, runs):
    """In which of `runs` equal slices of [-1, 1] each value lies."""
    return np.floor((coded + 1.0) / 2.0 * runs).astype(int)


@pytest.mark.parametrize("criterion", ["maximin", "random"])
@pytest.mark.parametrize("runs", [1, 2, 3, 7, 40])
def test_latin_property(cube, criterion, runs):
    """McKay, Beckman and Conover 1979: one value in each slice of each parameter."""
    coded = latin_hypercube(cube(4), runs=runs, criterion=criterion, seed=3)
    np.testing.assert_array_equal(
        np.sort(slices(coded, runs), axis=0), np.tile(np.arange(runs)[:, None], 4)
    )


@pytest.mark.parametrize("runs", [4, 5, 6, 7, 8])
def test_maximin_is_the_true_optimum_in_two_dimensions(cube, runs):
    """Largest smallest distance of any Latin hypercube, by enumerating all of them."""
    permutations = np.array(list(itertools.permutations(range(runs))))
    smallest = np.full(len(permutations), np.inf)
    for i, j in itertools.combinations(range(runs), 2):
        squared = (permutations[:, i] - permutations[:, j]) ** 2 + (i - j) ** 2
        smallest = np.minimum(smallest, squared)
    found = min(pdist(latin_hypercube(cube(2), runs=runs, seed=0)) * runs / 2) ** 2
    assert found == pytest.approx(smallest.max(), abs=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_maximin_reaches_the_published_distance_of_ten_runs(cube, seed):
    """Van Dam, Husslage, den Hertog and Melissen 2007: root of 10 steps in two dimensions."""
    coded = latin_hypercube(cube(2), runs=10, seed=seed)
    assert min(pdist(coded) * 10 / 2) ** 2 == pytest.approx(10, abs=1e-9)


@pytest.mark.parametrize("runs, k", [(30, 7), (60, 5), (100, 7)])
def test_maximin_is_as_far_apart_as_smts(cube, runs, k):
    """SMT's enhanced stochastic evolution (Jin, Chen and Sudjianto 2005), means of three."""
    sampling = pytest.importorskip("smt.sampling_methods")
    limits = np.tile([0.0, 1.0], (k, 1))
    theirs = [
        pdist(sampling.LHS(xlimits=limits, criterion="ese", seed=seed)(runs)).min()
        for seed in range(3)
    ]
    ours = [pdist(latin_hypercube(cube(k), runs=runs, seed=seed)).min() / 2 for seed in range(3)]
    assert np.mean(ours) > np.mean(theirs)


def test_more_effort_is_further_apart(cube):
    """Means of three seeds, ten times the exchanges."""
    usual, more = (
        np.mean(
            [
                pdist(latin_hypercube(cube(5), runs=40, effort=effort, seed=seed)).min()
                for seed in range(3)
            ]
        )
        for effort in (1, 10)
    )
    assert more > 1.02 * usual


def test_maximin_is_the_same_everywhere(cube):
    """Sums of the search are exact, so that no processor rounds it into another design."""
    ranks = slices(latin_hypercube(cube(3), runs=11, seed=0), 11)
    assert ranks.T.tolist() == [
        [9, 4, 2, 10, 0, 1, 8, 7, 3, 6, 5],
        [7, 1, 3, 2, 4, 8, 6, 10, 9, 0, 5],
        [1, 0, 9, 4, 3, 8, 10, 6, 2, 7, 5],
    ]


@pytest.mark.parametrize("runs, k", [(20, 3), (30, 7), (60, 5)])
def test_maximin_beats_the_best_of_many_random_ones(cube, runs, k):
    """Smallest distance at least 15 % above the best of 2000 random Latin hypercubes."""
    rng = np.random.default_rng(1)
    column = np.tile((2 * np.arange(runs)[:, None] + 1) / runs - 1, k)
    best = max(pdist(rng.permuted(column, axis=0)).min() for _ in range(2000))
    found = pdist(latin_hypercube(cube(k), runs=runs, seed=1)).min()
    assert found > 1.15 * best


@pytest.mark.parametrize("method", SEQUENCES)
def test_a_longer_sequence_keeps_the_shorter(cube, mixed, method):
    """Prefix property: raising `runs` adds points and moves none."""
    for space in (cube(5), mixed):
        long = method(space, runs=77, seed=5)
        for runs in (1, 2, 33, 64):
            np.testing.assert_array_equal(method(space, runs=runs, seed=5), long[:runs])


def test_sobol_is_a_net(cube):
    """Sobol' 1967: 2^m points of two neighbouring coordinates fill each elementary
    interval of area 2^-m exactly once (a (0, m, 2)-net in base 2), scrambled or not."""
    u = (sobol(cube(2), runs=64, seed=2) + 1.0) / 2.0
    for a in range(7):
        cells = np.floor(u * [2**a, 2 ** (6 - a)]).astype(int)
        assert len(np.unique(cells, axis=0)) == 64


def test_halton_is_even_in_each_base(cube):
    """Halton 1960: the first b^m values of the coordinate of base b fill its b^m slices."""
    u = (halton(cube(3), runs=125, seed=2) + 1.0) / 2.0
    for column, base, power in [(0, 2, 6), (1, 3, 4), (2, 5, 3)]:
        n = base**power
        assert len(np.unique(np.floor(u[:n, column] * n + 1e-9))) == n


@pytest.mark.parametrize("method", ALL)
def test_more_even_than_random(cube, method):
    """Centred discrepancy below that of every one of 50 random designs (Hickernell 1998)."""
    rng = np.random.default_rng(0)
    u = (method(cube(4), runs=64, seed=11) + 1.0) / 2.0
    assert qmc.discrepancy(u) < min(qmc.discrepancy(rng.random((64, 4))) for _ in range(50))


@pytest.mark.parametrize("method", SEQUENCES)
def test_projections_are_even(cube, method):
    """Each pair of parameters covers a 4 by 4 grid: no cell is empty with 64 points."""
    coded = method(cube(6), runs=64, seed=4)
    for pair in itertools.combinations(range(6), 2):
        assert len(np.unique(slices(coded[:, pair], 4), axis=0)) == 16


@pytest.mark.parametrize("method", ALL)
def test_seed(cube, method):
    """Same seed same points; other seeds other points; None is not a fixed seed."""
    space = cube(3)
    np.testing.assert_array_equal(method(space, runs=9, seed=1), method(space, runs=9, seed=1))
    assert not np.array_equal(method(space, runs=9, seed=1), method(space, runs=9, seed=2))
    assert not np.array_equal(method(space, runs=9), method(space, runs=9))


@pytest.mark.parametrize("method", ALL)
def test_levels_and_unbounded_parameters(mixed, unbounded, method):
    """Levels come equally often, and unbounded parameters stay finite with their law."""
    values = mixed.decode(method(mixed, runs=64, seed=0))
    counts = np.unique(values["posture"], return_counts=True)[1]
    assert counts.min() >= 20 and counts.sum() == 64
    c10 = unbounded.decode(method(unbounded, runs=256, seed=0))["c10"]
    assert np.isfinite(c10).all()
    assert c10.mean() == pytest.approx(5.0, abs=0.02)
    assert c10.std() == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("criterion", ["maximin", "random"])
def test_correlated_hypercube_keeps_slices_and_correlation(criterion):
    """Iman and Conover 1982: rank correlation 6/pi asin(rho/2) with the Latin property."""
    space = Space(
        (
            Parameter("a", uniform(0, 1)),
            Parameter("b", uniform(0, 1)),
            Parameter("c", distribution("normal", mean=0, std=1)),
        ),
        correlation=((1, 0.8, 0), (0.8, 1, 0), (0, 0, 1)),
    )
    coded = latin_hypercube(space, runs=200, criterion=criterion, seed=0)
    np.testing.assert_array_equal(
        np.sort(slices(coded, 200), axis=0), np.tile(np.arange(200)[:, None], 3)
    )
    expected = 6 / np.pi * np.arcsin(0.4)
    assert spearmanr(coded[:, 0], coded[:, 1])[0] == pytest.approx(expected, abs=0.06)
    assert abs(spearmanr(coded[:, 0], coded[:, 2])[0]) < 0.15


@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("runs", [0, -3, 2.5, True, "ten", 10_000_000])
def test_runs_must_be_a_reasonable_whole_number(cube, method, runs):
    """The value is named."""
    with pytest.raises(DesignError, match="runs"):
        method(cube(2), runs=runs)


def test_unknown_criterion(cube):
    """Spelling is suggested."""
    with pytest.raises(DesignError, match="did you mean 'maximin'"):
        latin_hypercube(cube(2), runs=5, criterion="maxmin")
