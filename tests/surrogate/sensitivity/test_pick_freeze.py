"""Pick-freeze Sobol' indices against closed forms and quadrature."""

import tracemalloc

import numpy as np
import pytest

from surrogate.errors import StudyError
from surrogate.sensitivity import pick_freeze as module
from surrogate.sensitivity.pick_freeze import pick_freeze
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

NAMES = ("first_order", "total", "second_order")
UNIT = Space(tuple(Parameter(f"x{i}", uniform(-1.0, 1.0)) for i in range(3)))


def errors_in_half_widths(sampled, case, floor=1e-7):
    """|error| over half-width of every index that exists; `floor` for indices known exactly."""
    parts = []
    for name in NAMES:
        gap = np.abs(getattr(sampled, name) - getattr(case, name))
        parts.append((gap / (sampled.half[name] + floor))[~np.isnan(gap)])
    return np.concatenate(parts)


@pytest.mark.parametrize("name", ["ishigami", "sobol_g", "borehole", "piston"])
def test_indices_lie_within_their_own_intervals(name, textbook):
    """First, total and second order of four functions with known indices.

    At 99.9 % confidence the 48 or fewer indices of one function may miss by chance in 5 % of
    seeds; the seed is fixed and was not chosen.
    """
    case = textbook(name)
    sampled = pick_freeze(case.function, case.space, confidence=0.999, seed=0)
    assert errors_in_half_widths(sampled, case).max() < 1.0


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [("ishigami", 4e-3), ("sobol_g", 2e-3), ("borehole", 1e-3), ("piston", 2e-3)],
)
def test_indices_are_accurate_at_the_default_size(name, tolerance, textbook):
    """The intervals of the previous test are narrow: absolute errors at 16 384 pairs."""
    case = textbook(name)
    sampled = pick_freeze(case.function, case.space, seed=0)
    for index in NAMES:
        np.testing.assert_allclose(getattr(sampled, index), getattr(case, index), atol=tolerance)
    assert sampled.evaluations == 2**14 * (2 * case.space.size + 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ishigami", "sobol_g", "borehole", "piston"])
def test_intervals_cover_the_truth_as_often_as_they_say(name, textbook):
    """95 % intervals cover 90 to 99 % of the time, over 300 seeds, on average over the indices.

    Each index that is not negligible by itself as well (Ishigami: all of them).
    """
    case = textbook(name)
    inside = []
    for seed in range(300):
        sampled = pick_freeze(case.function, case.space, samples=2**12, seed=seed)
        inside.append(errors_in_half_widths(sampled, case, floor=0.0) <= 1.0)
    covered = np.mean(inside, axis=0)
    assert 0.90 <= covered.mean() <= 0.99
    if name == "ishigami":
        assert ((covered >= 0.90) & (covered <= 0.99)).all()


def test_additive_function_has_no_interactions_and_shares_of_its_variances():
    """f = 3 x0 + 2 x1 + x2 on [-1, 1]^3: S = T = (9, 4, 1) / 14."""
    sampled = pick_freeze(lambda x: x @ [3.0, 2.0, 1.0], UNIT, seed=5)
    np.testing.assert_allclose(sampled.total, np.array([9.0, 4.0, 1.0]) / 14.0, atol=1e-4)
    np.testing.assert_allclose(sampled.first_order, sampled.total, atol=1e-12)
    assert np.nanmax(np.abs(sampled.second_order)) < 1e-3


def test_parameter_without_effect_has_indices_of_exactly_zero():
    """The estimators are sums of differences that vanish with the effect."""
    sampled = pick_freeze(lambda x: 1e6 + np.exp(x[:, 0]) * x[:, 1], UNIT, seed=1)
    assert sampled.first_order[2] == sampled.total[2] == 0.0
    assert sampled.half["total"][2] == 0.0


def test_indices_do_not_depend_on_origin_and_unit_of_the_output(textbook):
    """S(a + b f) = S(f), to rounding, although a is 10^6 times the spread."""
    case = textbook("ishigami")
    plain = pick_freeze(case.function, case.space, samples=2**10, seed=2)
    moved = pick_freeze(lambda x: 1e6 + 0.25 * case.function(x), case.space, samples=2**10, seed=2)
    for name in NAMES:
        np.testing.assert_allclose(getattr(moved, name), getattr(plain, name), atol=1e-8)


def test_normal_and_categorical_inputs_follow_their_laws():
    """f = z + g(level), z ~ N(0, 2), g = 0, 3, 6 with probability 1/3: shares 4 / (4 + 6)."""
    space = Space(
        (
            Parameter("z", distribution("normal", mean=1.0, std=2.0)),
            Parameter("level", levels=("low", "middle", "high")),
        )
    )
    gain = {"low": 0.0, "middle": 3.0, "high": 6.0}

    def function(coded):
        columns = space.decode(coded)
        return columns["z"] + np.vectorize(gain.get)(columns["level"])

    sampled = pick_freeze(function, space, seed=3)
    np.testing.assert_allclose(sampled.first_order, [0.4, 0.6], atol=2e-3)
    np.testing.assert_allclose(sampled.total, [0.4, 0.6], atol=2e-3)


def test_indices_of_a_field_are_weighted_by_variance():
    """Gamboa et al. 2014: for f = (3 x0, 4 x1) the aggregated indices are 9/25 and 16/25."""
    sampled = pick_freeze(
        lambda x: np.stack([3.0 * x[:, 0] + 7.0, 4.0 * x[:, 1]], axis=1), UNIT, seed=4
    )
    np.testing.assert_allclose(sampled.total, [0.36, 0.64, 0.0], atol=1e-3)


def test_group_index_of_all_inputs_but_one_is_one_minus_its_first_order_index(textbook):
    """T_{~i} = 1 - S_i (Sobol' 1993)."""
    case = textbook("ishigami")
    sampled = pick_freeze(case.function, case.space, groups=[[1, 2]], seed=6)
    np.testing.assert_allclose(sampled.total, [1.0 - case.first_order[0]], atol=3e-3)


def test_same_seed_same_numbers_whatever_the_block(monkeypatch, textbook):
    """Blocks of 8 points give what one block gives, to rounding; another seed does not."""
    case = textbook("ishigami")
    whole = pick_freeze(case.function, case.space, samples=2**10, seed=7)
    monkeypatch.setattr(module, "BLOCK", 8 * 8)
    parts = pick_freeze(case.function, case.space, samples=2**10, seed=7)
    np.testing.assert_allclose(parts.total, whole.total, rtol=1e-10)
    other = pick_freeze(case.function, case.space, samples=2**10, seed=8)
    assert np.abs(other.total - whole.total).max() > 1e-6


def test_a_million_evaluations_of_a_field_stay_in_bounded_memory():
    """2^17 pairs of 8 columns at 50 places are 420 MB of values; the peak is below 150 MB."""
    tracemalloc.start()
    pick_freeze(
        lambda x: np.repeat(x[:, :1] * x[:, 1:2], 50, axis=1), UNIT, samples=2**17, scramblings=4
    )
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 150e6


@pytest.mark.parametrize("ripple", [0.0, 4e-16])
def test_output_that_does_not_vary_has_no_shares(ripple):
    """No variance, no shares of it, as in closed form; nor does rounding share any out."""
    found = pick_freeze(lambda x: 3.0 + ripple * x[:, 0] + 0.1 * ripple * x[:, 1], UNIT)
    for name in ("first_order", "total", "second_order"):
        off = ~np.isnan(getattr(found, name))
        assert (getattr(found, name)[off] == 0.0).all() and (found.half[name][off] == 0.0).all()


@pytest.mark.parametrize("options", [{"scramblings": 2}, {"samples": 0}])
def test_too_few_of_anything_is_refused_with_the_least(options):
    """An interval from two or three values means nothing."""
    ((name, value),) = options.items()
    with pytest.raises(StudyError, match=f"{name}: {value} is too few; take . or more"):
        pick_freeze(lambda x: x[:, 0], UNIT, **options)
