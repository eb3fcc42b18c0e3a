"""JavaScript evaluators give Python's numbers, for every kind of portable surrogate."""

from __future__ import annotations

from pathlib import Path

import node
import numpy as np
import pytest
from exported import KINDS, SPACE, spread_out, truth
from scipy import special, stats

from surrogate.fitting.fit import fit
from surrogate.portable.packing import Packer
from surrogate.regressors.polynomial import Linear
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

pytestmark = node.needed
SUPPORT = Path(__file__).parents[2] / "support"
#: Largest difference to Python, as a share of the output's spread.
EQUAL = 1e-9


def answers(fits_and_places, points):
    """Mean, deviation and half of the interval of each fit at a place (None: a scalar)."""
    packer = Packer()
    cases = [
        {"document": packer.packed(one.portable()), "place": place or 0, "points": points.tolist()}
        for one, place in fits_and_places
    ]
    return node.answered(SUPPORT / "evaluate.mjs", {"shared": packer.shared, "cases": cases})


def compare(one, place, points, answer):
    """Largest difference of an answer, as a share of the spread of the values."""
    mean, std = one.predict(points, return_std=True)
    half = 0.5 * np.subtract(*one.interval(points)[::-1])
    for name, values in {"mean": mean, "deviation": std, "half": half}.items():
        own = values.reshape(len(points), -1)[:, place or 0]
        given = np.array(answer[name], dtype=float)
        scale = one.values.reshape(len(one.values), -1)[:, place or 0].std()
        assert np.isfinite(own).all()
        assert np.abs(given - own).max() <= EQUAL * scale, name


@pytest.mark.parametrize("kind", KINDS)
def test_scalars(kind):
    """Random points in and a little outside of the ranges."""
    train = SPACE.sample(70, seed=1)
    points = np.vstack([SPACE.sample(60, seed=2), 1.1 * SPACE.sample(5, seed=3)])
    one = fit(SPACE, train, truth(train), KINDS[kind])
    (answer,) = answers([(one, None)], points)
    compare(one, None, points, answer)


@pytest.mark.parametrize("kind", ["linear", "chaos", "gp"])
def test_fields(kind):
    """The chosen place of a field, from its modes."""
    train, points = SPACE.sample(60, seed=1), SPACE.sample(40, seed=2)
    one = fit(SPACE, train, spread_out(train), KINDS[kind])
    places = [0, 5, 11]
    for place, answer in zip(places, answers([(one, p) for p in places], points), strict=True):
        compare(one, place, points, answer)


def test_saturated_polynomial_has_no_interval():
    """Without residual degrees of freedom its deviation is not a number."""
    space = Space(tuple(Parameter(name, uniform(0, 1)) for name in "ab"))
    train = space.sample(3, seed=1)
    (answer,) = answers([(fit(space, train, train @ [1.0, 2.0], Linear()), None)], train)
    assert answer["mean"] == pytest.approx((train @ [1.0, 2.0]).tolist(), abs=1e-12)
    assert answer["deviation"] == [None] * 3


def test_special_functions():
    """Normal and Student's laws against scipy, in the tails too."""
    z = np.concatenate([np.linspace(-10, 10, 401), np.linspace(-1, 1, 101)])
    u = np.concatenate([np.geomspace(1e-300, 0.4, 300), np.linspace(0.01, 0.99, 99)])
    t = np.concatenate([-np.geomspace(1e-3, 1e4, 60), np.geomspace(1e-3, 1e4, 60)])
    freedoms = [1, 2, 3, 7, 30, 119, 2000]
    found = node.answered(
        SUPPORT / "special.mjs",
        {"z": z.tolist(), "u": u.tolist(), "t": t.tolist(), "freedoms": freedoms},
    )
    np.testing.assert_allclose(found["erf"], special.erf(z), rtol=4e-16, atol=0)
    np.testing.assert_allclose(found["cdf"], special.ndtr(z), rtol=3e-14, atol=1e-300)
    np.testing.assert_allclose(found["quantile"], special.ndtri(u), rtol=1e-14, atol=1e-15)
    for freedom, own in zip(freedoms, found["student"], strict=True):
        np.testing.assert_allclose(own, stats.t.cdf(t, freedom), rtol=1e-11, atol=1e-300)
