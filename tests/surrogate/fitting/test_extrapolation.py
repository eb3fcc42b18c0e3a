"""Hidden extrapolation: inside of both ranges, outside of the cloud."""

import numpy as np

from surrogate.fitting.extrapolation import extrapolates
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space((Parameter("a", uniform(-1, 1)), Parameter("b", uniform(-1, 1))))


def test_leverage_is_that_of_the_textbook():
    """x0' (X'X)^-1 x0 written out, for a cloud along the diagonal."""
    r = np.random.default_rng(0)
    a = r.uniform(-1, 1, 60)
    training = np.column_stack([a, np.clip(a + 0.1 * r.normal(size=60), -1, 1)])
    new = r.uniform(-1, 1, (200, 2))
    X, N = (np.column_stack([np.ones(len(x)), x]) for x in (training, new))
    inverse = np.linalg.inv(X.T @ X)
    h = np.einsum("ij,jk,ik->i", N, inverse, N)
    largest = np.einsum("ij,jk,ik->i", X, inverse, X).max()
    assert (extrapolates(SPACE, training, new) == (h > largest)).all()
    assert not extrapolates(SPACE, training, training).any()
    assert extrapolates(SPACE, training, np.array([[-0.9, 0.9]])).all()


def test_inputs_that_rows_do_not_vary_apart():
    line = np.linspace(-1, 1, 9)
    training = np.column_stack([line, line])
    assert extrapolates(SPACE, training, np.array([[0.5, 0.4], [0.5, 0.5]])).tolist() == [
        True,
        False,
    ]
