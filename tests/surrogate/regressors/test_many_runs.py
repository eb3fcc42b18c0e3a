"""Polynomial chaos of many runs: the same answers from sums of products, in little memory."""

import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from surrogate.regressors import chaos, moments, pursuit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.least_squares import LeastSquares
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(
    (
        Parameter("a", uniform(0, 1)),
        Parameter("b", distribution("normal", mean=0, std=1)),
        Parameter("cloth", levels=("p", "q", "r")),
    )
)


def runs(n, noise):
    x = SPACE.sample(n, seed=4)
    rng = np.random.default_rng(5)
    y = 50 + np.exp(x[:, 0]) * (1 + 0.5 * x[:, 2]) + x[:, 1] ** 2
    return x, y + noise * rng.normal(size=n)


@pytest.fixture
def few(monkeypatch):
    """Blocks of a few rows, so that sums are made of many."""
    monkeypatch.setattr(moments, "BLOCK", 3000)


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_the_answers_are_those_of_few_runs(monkeypatch, few, noise):
    """Terms, degree, coefficients and left-out runs as from the model matrix itself."""
    x, y = runs(1200, noise)
    many = PolynomialChaos(max_degree=6, space=SPACE).fit(x, y)
    monkeypatch.setattr(chaos, "MANY", 10_000)
    same = PolynomialChaos(max_degree=6, hyperbolic=chaos.OF_MANY, space=SPACE).fit(x, y)
    assert isinstance(many.model_, moments.FitOfMany)
    assert isinstance(same.model_, LeastSquares)
    assert many.indices_ == same.indices_ and many.degree_ == same.degree_
    np.testing.assert_allclose(many.coef_, same.coef_, rtol=1e-10, atol=1e-11)
    assert many.error_ == pytest.approx(same.error_, rel=1e-8)
    np.testing.assert_allclose(many.leave_one_out(), same.leave_one_out(), rtol=1e-11)
    np.testing.assert_allclose(many.predict(x), same.predict(x), rtol=1e-12)


def test_terms_are_those_of_orthogonal_least_squares():
    """The Cholesky factor of products takes the columns that the matrix itself gives."""
    rng = np.random.default_rng(0)
    matrix = np.column_stack([np.ones(90), rng.normal(size=(90, 30))])
    y, test = rng.normal(size=90), np.arange(90) % 3 == 0

    def of(rows):
        a = matrix[rows]
        return moments.Moments(a.T @ a, a.T @ y[rows], float(y[rows] @ y[rows]), len(a))

    found = moments.path(of(~test), 20)
    assert found.order == pursuit.pursue(matrix[~test], y[~test], 20)
    for k, error in enumerate(found.errors(of(test)), start=1):
        kept = found.order[:k]
        c = np.linalg.lstsq(matrix[~test][:, kept], y[~test], rcond=None)[0]
        assert error == pytest.approx(((y[test] - matrix[test][:, kept] @ c) ** 2).sum(), rel=1e-9)


def test_left_out_folds_are_those_of_refits(few):
    """Terms chosen anew without the fold, of the same degree and number, by brute force."""
    x, y = runs(1100, 0.5)
    model = PolynomialChaos(max_degree=5, space=SPACE).fit(x, y)
    folds = np.random.default_rng(1).permutation(np.arange(1100) % 4)
    found = model.leave_out(folds)
    matrix = model._rows(model._candidates(model.degree_, model.hyperbolic_))(x)
    for fold in range(4):
        rest = folds != fold
        kept = pursuit.pursue(matrix[rest], y[rest] - y.mean(), len(model.indices_))
        c = np.linalg.lstsq(matrix[rest][:, kept], y[rest], rcond=None)[0]
        np.testing.assert_allclose(found[~rest], matrix[~rest][:, kept] @ c, rtol=1e-10)


def test_few_of_many_runs_choose_and_all_are_fitted(monkeypatch):
    """Coefficients are those of least squares on all runs."""
    monkeypatch.setattr(chaos, "CHOOSING", 1500)
    x, y = runs(4000, 0.2)
    model = PolynomialChaos(max_degree=4, space=SPACE).fit(x, y)
    exact = np.linalg.lstsq(model._matrix(x), y, rcond=None)[0]
    np.testing.assert_allclose(model.coef_, exact, rtol=1e-11, atol=1e-12)


def test_noise_of_many_runs_is_not_taken_for_a_function():
    """Left-out errors of noise alone are its variance, to 5 %: nothing is too kind."""
    x = np.random.default_rng(0).uniform(-1, 1, (3000, 4))
    y = np.random.default_rng(1).normal(size=3000)
    model = PolynomialChaos().fit(x, y)
    folds = np.arange(3000) % 10
    assert len(model.indices_) < 10
    assert np.mean((y - model.leave_out(folds)) ** 2) == pytest.approx(y.var(), rel=0.05)


def test_memory_does_not_grow_with_the_runs(monkeypatch):
    """Less than half of the model matrix of 100 000 runs and 176 candidates is ever held."""
    monkeypatch.setattr(moments, "BLOCK", 500_000)
    space = Space(tuple(Parameter(f"p{k}", uniform(0, 1)) for k in range(7)))
    x = space.sample(100_000, seed=1)
    y = np.exp(x[:, 0]) * np.sin(2 * x[:, 1]) + x[:, 2] * x[:, 3]
    tracemalloc.start()
    try:
        model = PolynomialChaos(max_degree=5, space=space).fit(x, y)
        model.leave_out(np.arange(len(x)) % 10)
        model.leave_one_out()
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(model._candidates(5, model.hyperbolic_)) == 176
    assert peak < 0.5 * 100_000 * 176 * 8


LARGE = """
import re
from pathlib import Path
import numpy as np
from surrogate.fitting.fit import fit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
space = Space(tuple(Parameter(f"p{k}", uniform(0, 1)) for k in range(7)))
x = space.sample(100_000, seed=1)
y = np.exp(x[:, 0]) * np.sin(2 * x[:, 1]) + 1 / (1.5 + x[:, 2]) + x[:, 3] * x[:, 4] * x[:, 5]
fits = [fit(space, x, y, one) for one in (Linear(), Quadratic(), PolynomialChaos())]
print(int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) / 1024)
print(fits[2].q2)
"""


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux's /proc")
def test_a_hundred_thousand_runs_in_a_gigabyte():
    """Linear, quadratic and polynomial chaos with their left-out errors.

    What they cost in time is printed by `benchmarks/surrogates.py many`. The peak is that of
    the process itself: `ru_maxrss` counts the one that forked it, too.
    """
    said = subprocess.run(
        [sys.executable, "-c", LARGE], capture_output=True, text=True, check=True
    ).stdout
    megabytes, q2 = map(float, said.split())
    assert megabytes < 1000.0 and q2 > 0.999999
