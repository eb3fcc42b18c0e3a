"""Fields by POD: indices and draws of the whole field, against closed forms."""

import numpy as np
import pytest

from surrogate.fitting.fit import fit
from surrogate.regressors import field
from surrogate.regressors.field import Field
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Interactions
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def test_indices_of_a_field_are_those_of_its_places_weighted_by_variance():
    """Lamboni 2011: sum over places of Var(E[f | x_S]) over sum of Var f, for known fields.

    f(x, place) = sin(place) x1 + 2 cos(place) x2 x3 on uniform inputs: the parts are
    sum sin^2 / 3 and 4 sum cos^2 / 9.
    """
    places = np.linspace(0.0, 3.0, 17)
    space = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in ("x1", "x2", "x3")))
    coded = space.sample(60, seed=4)
    values = np.outer(coded[:, 0], np.sin(places)) + 2.0 * np.outer(
        coded[:, 1] * coded[:, 2], np.cos(places)
    )
    fitted = fit(space, coded, values, Interactions())
    first, product = (np.sin(places) ** 2).sum() / 3.0, 4.0 * (np.cos(places) ** 2).sum() / 9.0
    indices = fitted.estimator.sobol_indices()
    shares = np.array([first, product, product]) / (first + product)
    np.testing.assert_allclose(indices.total, shares, atol=1e-12)
    np.testing.assert_allclose(indices.first_order, [shares[0], 0.0, 0.0], atol=1e-12)
    assert indices.second_order[1, 2] == pytest.approx(shares[1], abs=1e-12)


def test_drawn_fields_scatter_as_the_field_says():
    """Draws follow Student's t: their deviation is the predicted one times sqrt(n / (n - 2))."""
    places = np.linspace(0.0, 1.0, 9)
    space = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in ("x1", "x2")))
    coded = space.sample(12, seed=5)
    values = np.sin(np.outer(1.0 + coded[:, 0], 2.0 * places)) + coded[:, 1:] * places**2
    estimator = fit(space, coded, values, GaussianProcess()).estimator
    point = np.array([[0.9, -0.8]])
    draws = np.stack([draw.predict(point)[0] for draw in estimator.posterior_draws(2000, seed=1)])
    mean, std = estimator.predict(point, return_std=True)
    own = np.sqrt(np.maximum(std[0] ** 2 - estimator.left_out_**2, 0.0))
    freedom = estimator.interval_freedom
    expected = own * np.sqrt(freedom / (freedom - 2.0))
    np.testing.assert_allclose(draws.mean(axis=0), mean[0], atol=0.1 * own.max())
    np.testing.assert_allclose(draws.std(axis=0), expected, atol=0.06 * own.max())


def test_modes_by_snapshots_are_the_singular_vectors(monkeypatch):
    """Products of fields and the singular value decomposition give one field, to 1e-10."""
    x = np.linspace(-1.0, 1.0, 15)[:, None]
    values = np.exp(np.outer(1.0 + x[:, 0], np.linspace(0.0, 1.0, 40)))
    by_products = Field(Interactions(), explained=0.9999).fit(x, values)
    monkeypatch.setattr(field, "RESOLVED", np.inf)
    by_svd = Field(Interactions(), explained=0.9999).fit(x, values)
    np.testing.assert_allclose(by_products.predict(x), by_svd.predict(x), atol=1e-10)
    np.testing.assert_allclose(by_products.left_out_, by_svd.left_out_, atol=1e-10)
    modes = by_products.modes_
    np.testing.assert_allclose(modes @ modes.T, np.eye(len(modes)), atol=1e-10)
