"""What a run is worth, against the integrals that define it."""

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from surrogate.adaptive.contour import contour_improvement
from surrogate.adaptive.expected_feasibility import deviations_away, expected_feasibility
from surrogate.adaptive.expected_improvement import expected_improvement
from surrogate.adaptive.index_variance import total_index_weights
from surrogate.adaptive.variance import covariances, taken
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

MEAN = np.array([-1.3, 0.0, 0.4, 2.5])
DEVIATION = np.array([0.7, 1.0, 0.05, 1.6])
SPACE = Space(tuple(Parameter(name, uniform(0.0, 1.0)) for name in "abc"))


def expectations(of, *ends):
    """E of(Y) for Y ~ N(mean, deviation^2), by quadrature between kinks."""
    found = []
    for m, s in zip(MEAN, DEVIATION, strict=True):
        low, high = m - 12 * s, m + 12 * s
        kinks = [low, *sorted(end for end in ends_of(ends, s) if low < end < high), high]
        pieces = zip(kinks[:-1], kinks[1:], strict=True)
        found.append(sum(quad(weighted, *piece, (of, m, s))[0] for piece in pieces))
    return np.array(found)


def weighted(y, of, m, s):
    return of(y, s) * stats.norm.pdf(y, m, s)


def ends_of(ends, s):
    return [end(s) if callable(end) else end for end in ends]


def test_expected_improvement_is_the_mean_of_the_improvement():
    """Jones et al. 1998: E max(best - Y, 0)."""
    exact = expectations(lambda y, s: max(0.3 - y, 0.0), 0.3)
    assert expected_improvement(MEAN, DEVIATION, 0.3) == pytest.approx(exact, rel=1e-7, abs=1e-9)


def test_contour_improvement_is_the_mean_of_the_improvement():
    """Ranjan et al. 2008: E max(e^2 - (Y - value)^2, 0), e = 2 s."""
    exact = expectations(
        lambda y, s: max(4 * s**2 - (y - 0.3) ** 2, 0.0),
        lambda s: 0.3 - 2 * s,
        lambda s: 0.3 + 2 * s,
    )
    assert contour_improvement(MEAN, DEVIATION, 0.3) == pytest.approx(exact, rel=1e-7, abs=1e-9)


def test_expected_feasibility_is_the_mean_of_the_feasibility():
    """Bichon et al. 2008: E max(e - |Y - limit|, 0), e = 2 s."""
    exact = expectations(
        lambda y, s: max(2 * s - abs(y - 0.3), 0.0),
        lambda s: 0.3 - 2 * s,
        0.3,
        lambda s: 0.3 + 2 * s,
    )
    assert expected_feasibility(MEAN, DEVIATION, 0.3) == pytest.approx(exact, rel=1e-7, abs=1e-9)


def test_u_is_the_distance_in_deviations():
    """Echard et al. 2011; a prediction without deviation is sure unless it is at the limit."""
    assert deviations_away(MEAN, DEVIATION, 0.3) == pytest.approx(abs(MEAN - 0.3) / DEVIATION)
    assert deviations_away(np.array([1.0]), np.array([0.0]), 0.3)[0] > 1e9


def test_nothing_is_gained_where_all_is_known():
    """A deviation of zero is worth nothing, and divides nothing by zero."""
    none, away = np.zeros(4), MEAN + 5.0
    assert (expected_improvement(away, none, 0.3) == 0.0).all()
    assert (contour_improvement(away, none, 0.3) < 1e-20).all()
    assert (expected_feasibility(away, none, 0.3) < 1e-20).all()


@pytest.fixture(scope="module")
def process():
    rng = np.random.default_rng(3)
    X = 2.0 * rng.random((25, 3)) - 1.0
    y = np.sin(2 * X[:, 0]) + X[:, 1] ** 2 + 0.3 * X[:, 0] * X[:, 2]
    return GaussianProcess(space=SPACE, trend="linear").fit(X, y)


def test_covariance_is_that_of_joint_runs(process):
    """Between different points it is the covariance of runs that `predict_joint` gives."""
    pairs = 2.0 * np.random.default_rng(4).random((6, 2, 3)) - 1.0
    _, joint = process.predict_joint(pairs)
    found = np.diag(covariances(process, pairs[:, 0], pairs[:, 1]))
    assert found == pytest.approx(joint[:, 0, 1], rel=1e-8, abs=1e-12)


def test_variance_taken_is_what_a_further_run_takes(process):
    """Before minus after the run is added, lengths, nugget and process variance kept."""
    rng = np.random.default_rng(5)
    X, Z = (2.0 * rng.random((n, 3)) - 1.0 for n in (4, 60))
    weights = rng.standard_normal((60, 2))
    before = covariances(process, Z, Z)
    integrated, summed = taken(process, X, Z), taken(process, X, Z, weights)
    for k, x in enumerate(X):
        runs = np.vstack([process.points_, x])
        values = np.append(process.predict(process.points_), process.predict(x[None]))
        more = GaussianProcess(space=SPACE, trend="linear").condition(runs, values, process.logs_)
        more.variance_ = process.variance_
        gone = before - covariances(more, Z, Z)
        assert integrated[k] == pytest.approx(np.diag(gone).mean(), rel=1e-5)
        assert summed[k] == pytest.approx(np.diag(weights.T @ gone @ weights), rel=1e-5)


def test_total_indices_move_by_their_weights(process):
    """The derivative of Jansen's estimate along a change of the output."""
    points, weights = total_index_weights(process, SPACE, pairs=500, seed=1)
    values = process.predict(points)
    change = np.cos(3 * points[:, 0]) * points[:, 1]

    def totals(f):
        f = f.reshape(4, 500)
        return ((f[0] - f[1:]) ** 2).mean(axis=1) / 2 / f[0].var()

    step = 1e-6
    slope = (totals(values + step * change) - totals(values - step * change)) / (2 * step)
    assert change @ weights == pytest.approx(slope, rel=1e-6, abs=1e-8)


def test_condition_is_the_fit_with_its_own_lengths(process):
    """A fit that is conditioned on its own runs and lengths predicts the same."""
    rng = np.random.default_rng(6)
    X = 2.0 * rng.random((20, 3)) - 1.0
    y = np.exp(X[:, 0]) - X[:, 1]
    fitted = GaussianProcess(space=SPACE).fit(X, y)
    again = GaussianProcess(space=SPACE).condition(X, y, fitted.logs_)
    Z = 2.0 * rng.random((50, 3)) - 1.0
    for one, other in zip(
        again.predict(Z, return_std=True), fitted.predict(Z, return_std=True), strict=True
    ):
        assert one == pytest.approx(other, rel=1e-12)
