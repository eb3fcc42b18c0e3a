"""What the report draws from a polynomial: half-normal plot, stationary point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.fitting import fit as fitting
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.report import digits
from surrogate.report.blocks import Figures, Fold, Text
from surrogate.report.sections import effects, stationary

OUTPUT = "pressure_b1"


def with_fit(content, coded, values, estimator):
    """The same content with one surrogate of its own, and its table."""
    name = type(estimator).__name__.lower()
    fit = fitting.fit(content.space, coded, values, estimator, surrogate=name, output=OUTPUT)
    tables = {name: {OUTPUT: fit.estimator.regression_table()}}
    return replace(content, fits={name: {OUTPUT: fit}}, regression=tables)


def test_a_saturated_fit_shows_its_half_normal_plot(study):
    """The one large effect of a 2^(7-4) stands out; the constant is no effect."""
    content = study(surrogates=("linear",))
    size = content.space.size
    rng = np.random.default_rng(0)
    coded = fractional_factorial(content.space, resolution=3)
    assert len(coded) == size + 1
    values = 30.0 + 9.0 * coded[:, 0] + rng.normal(0.0, 0.1, len(coded))
    other = with_fit(content, coded, values, Linear())
    fold = next(b for b in effects.blocks(other, OUTPUT) if isinstance(b, Fold))
    said = [b.words for b in fold.blocks if isinstance(b, Text)]
    assert any(f"active: {content.space.names[0]}." in words for words in said)
    drawn = [f.plot for b in fold.blocks if isinstance(b, Figures) for f in b.items]
    assert len(drawn) == 2 and len(drawn[1].numbers[0].values) == size


@pytest.mark.parametrize("sign, words", [(-1.0, "a maximum"), (1.0, "a minimum")])
def test_the_stationary_point_is_told_in_physical_values(study, sign, words):
    """A bowl about a known point inside the ranges."""
    content = study(surrogates=("linear",))
    coded = content.space.sample(120, seed=1)
    centre = np.linspace(-0.4, 0.4, content.space.size)
    values = 30.0 + sign * ((coded - centre) ** 2).sum(axis=1)
    noise = np.random.default_rng(2).normal(0.0, 1e-3, len(coded))
    other = with_fit(content, coded, values + noise, Quadratic(content.space))
    said = stationary.blocks(other, OUTPUT, "quadratic")[0].words
    assert words in said and "30.0" in said.rpartition(";")[2]
    first = content.space.decode(centre[None])
    name = content.space.names[0]
    assert f"{name} {digits.figure(float(first[name][0]))}" in said


def test_a_plane_has_no_stationary_point(study):
    """Nothing is said of it."""
    assert stationary.blocks(study(surrogates=("linear",)), OUTPUT, "linear") == []
