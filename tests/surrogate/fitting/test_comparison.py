"""The comparison table: its numbers, its winner, and whether the margin means anything."""

import numpy as np
import pytest
import xarray as xr
from scipy import stats
from sklearn.ensemble import RandomForestRegressor

from surrogate.fitting.comparison import COLUMNS, best, compare, nested_tests, paired_test
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(name, uniform(0, 1)) for name in ("a", "b", "c")))
MODELS = {"linear": Linear(), "quadratic": Quadratic(), "gp": GaussianProcess()}


def truth(x):
    return 1 + x[:, 0] + 2 * x[:, 1] ** 2 + x[:, 0] * x[:, 2]


def runs(n=50, seed=0, noise=0.1):
    x = SPACE.sample(n, seed=seed)
    return x, truth(x) + noise * np.random.default_rng(seed).normal(size=n)


def fits_of(models, outputs):
    return {
        name: {
            output: fit(SPACE, *data, model, surrogate=name, output=output)
            for output, data in outputs.items()
        }
        for name, model in models.items()
    }


def test_columns_by_definition():
    """Each accuracy column equals its formula, evaluated here by hand."""
    fits, (x, y) = fits_of(MODELS, {"y": runs()}), runs(30, seed=9)
    table = compare(fits, {"y": (x, y)})
    assert set(COLUMNS) < set(table.data_vars) and table.sizes["surrogate"] == 3
    one = fits["linear"]["y"]
    row = table.sel(surrogate="linear", output="y")
    error = y - one.predict(x)
    left_out = one.values - one.left_out
    low, high = one.interval(x)
    expected = {
        "q2_cv": 1 - (left_out**2).sum() / ((one.values - one.values.mean()) ** 2).sum(),
        "rmse_cv": np.sqrt((left_out**2).mean()),
        "rmse_test": np.sqrt((error**2).mean()),
        "q2_test": 1 - (error**2).sum() / ((y - y.mean()) ** 2).sum(),
        "max_error_test": np.abs(error).max(),
        "coverage_95": ((low < y) & (y < high)).mean(),
    }
    for name, value in expected.items():
        assert float(row[name]) == pytest.approx(value, rel=1e-12), name
    assert (row["fit_seconds"] > 0) and (row["predict_seconds"] > 0)


def test_the_true_model_wins_and_clearly_against_a_wrong_one():
    """Data of a quadratic: quadratic beats linear beyond the scatter between folds."""
    models = {"linear": Linear(), "quadratic": Quadratic()}
    table = compare(fits_of(models, {"y": runs()}))
    assert table.attrs["best"] == "quadratic" and best(table) == {"y": "quadratic"}
    assert bool(table["margin_clear"][0]) and float(table["margin"][0]) > 0.1
    assert "more than the scatter" in str(table["sentence"].values[0])
    assert np.isnan(table["q2_test"]).all() and np.isnan(table["coverage"]).all()


def test_paired_test_by_hand():
    """Nadeau and Bengio 2003, equation 15, for ten folds of five among fifty runs."""
    fits = fits_of(MODELS, {"y": runs()})
    a, b = fits["linear"]["y"], fits["quadratic"]["y"]
    d = np.array(
        [
            np.mean(((a.values - a.left_out) ** 2 - (b.values - b.left_out) ** 2)[a.folds == k])
            for k in range(10)
        ]
    )
    t = d.mean() / np.sqrt((1 / 10 + 5 / 45) * d.var(ddof=1))
    assert paired_test(a, b) == pytest.approx(2 * stats.t.sf(abs(t), 9), rel=1e-12)


def test_equally_good_surrogates_are_rarely_told_apart():
    """Null case: linear truth, linear against interactions on noise. The extra terms cost a
    little, so the test may see that; it must not prefer the larger model more than 5 % of times.
    """
    wrong = 0
    for seed in range(60):
        x = SPACE.sample(40, seed=seed)
        y = x[:, 0] + np.random.default_rng(seed).normal(size=40)
        small, large = (fit(SPACE, x, y, model) for model in (Linear(), Interactions()))
        wrong += paired_test(small, large) < 0.05 and large.q2 > small.q2
    assert wrong <= 3


def test_calibration_of_noise():
    """Coverage of the true model follows the level: 50, 80, 90, 95, 99 %."""
    data, test = runs(200, noise=1.0), runs(2000, seed=5, noise=1.0)
    table = compare(
        fits_of({"quadratic": Quadratic(), "forest": RandomForestRegressor(30)}, {"y": data}),
        {"y": test},
    )
    for name in ("quadratic", "forest"):
        np.testing.assert_allclose(
            table["coverage"].sel(surrogate=name, output="y"), table["level"], atol=0.06
        )


def test_best_of_each_output_and_overall():
    x = SPACE.sample(60, seed=1)
    rng = np.random.default_rng(0)
    plane = x @ [1.0, 2.0, 3.0] + 0.5 * rng.normal(size=60)
    bowl = 10 * x[:, 0] ** 2 + 10 * x[:, 1] ** 2 + 0.1 * rng.normal(size=60)
    table = compare(
        fits_of(
            {"linear": Linear(), "quadratic": Quadratic()}, {"plane": (x, plane), "bowl": (x, bowl)}
        )
    )
    assert best(table) == {"plane": "linear", "bowl": "quadratic"}
    assert table.attrs["best"] == "quadratic"


def test_fields_and_missing_fits():
    """A field is pooled over its places; a surrogate without a fit is a row of NaN."""
    x = SPACE.sample(25, seed=2)
    field = truth(x)[:, None] * np.linspace(1, 2, 7)
    fits = fits_of({"linear": Linear(), "quadratic": Quadratic()}, {"field": (x, field)})
    fits["gp"] = {}
    table = compare(fits, {"field": (x[:5], field[:5])})
    assert best(table) == {"field": "quadratic"}
    assert float(table["q2_test"].sel(surrogate="quadratic")[0]) == pytest.approx(1.0, abs=1e-10)
    assert np.isnan(table["q2_cv"].sel(surrogate="gp")).all()
    assert float(table["modes"].sel(surrogate="linear")[0]) == 1
    assert float(table["truncation_error"].sel(surrogate="linear")[0]) < 1e-7


def test_saturated_surrogates_are_chosen_by_the_test_design():
    """Four runs, four coefficients: nothing can be left out, so the test design decides."""
    fits = fits_of({"linear": Linear()}, {"y": runs(4)})
    table = compare(fits, {"y": runs(20, seed=3)})
    assert np.isnan(table["q2_cv"]).all() and np.isfinite(table["q2_test"]).all()
    assert "no surrogate can be cross-validated" in str(table["sentence"].values[0])
    assert "cannot be ranked" in str(compare(fits)["sentence"].values[0])


def test_nested_polynomials_are_tested_pair_by_pair():
    """Three nested models are three pairs; squares explain, interactions with b do not."""
    models = {
        "linear": Linear(),
        "gp": GaussianProcess(),
        "quadratic": Quadratic(),
        "interactions": Interactions(),
    }
    fits = fits_of(models, {"y": runs()})
    found = {(one.smaller, one.larger): one for one in nested_tests(fits)}
    assert set(found) == {
        ("linear", "interactions"),
        ("linear", "quadratic"),
        ("interactions", "quadratic"),
    }
    one = found["linear", "quadratic"]
    sse = [fits[name]["y"].estimator.model_.sse for name in ("linear", "quadratic")]
    assert one.test.f == pytest.approx((sse[0] - sse[1]) / 6 / (sse[1] / 40), rel=1e-10)
    assert one.test.p < 1e-6 and "are significant" in one.sentence
    saturated = nested_tests(fits_of({"l": Linear(), "i": Interactions()}, {"y": runs(7)}))
    assert "cannot be tested" in saturated[0].sentence


def test_fits_to_different_runs_are_not_paired():
    first = fit(SPACE, *runs(40), Linear())
    second = fit(SPACE, *runs(50), Linear())
    assert np.isnan(paired_test(first, second))


def test_the_table_survives_netcdf(tmp_path):
    table = compare(fits_of(MODELS, {"y": runs()}), {"y": runs(20, seed=3)})
    table.to_netcdf(tmp_path / "comparison.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "comparison.nc", engine="h5netcdf") as stored:
        assert stored.attrs["best"] == table.attrs["best"]
        assert best(stored) == best(table)
        np.testing.assert_array_equal(stored["q2_test"], table["q2_test"])


def test_surrogates_of_different_runs_are_judged_on_runs_that_neither_has_seen():
    """A plane through four corners leaves out nothing wrong there, and is wrong elsewhere.

    The quadratic of 50 noisy runs is the better one by far, though its left-out errors are
    larger than the plane's: without a test design the model of most runs wins.
    """
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1], [0, 0, 0]], float)
    plane = corners @ [1.0, 0.5, -0.3]
    fits = {
        "few": {"y": fit(SPACE, corners, plane, Linear(), surrogate="few", output="y")},
        **fits_of({"quadratic": Quadratic()}, {"y": runs()}),
    }
    for test in ({"y": runs(30, seed=9)}, None):
        table = compare(fits, test)
        assert float(table["q2_cv"].sel(surrogate="few", output="y")) > 0.999
        assert best(table) == {"y": "quadratic"} and table.attrs["best"] == "quadratic"
    assert "most training runs" in str(table["sentence"].values[0])
