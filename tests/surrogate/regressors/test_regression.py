"""Regression tables against published ones and against the definitions."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from surrogate.errors import FitError
from surrogate.regressors import regression
from surrogate.regressors.least_squares import least_squares

FACTS = json.loads((Path(__file__).parents[2] / "reference/regression.json").read_text())


def second_order(x1, x2, *more):
    """Columns and names of a full second-order model in two coded factors."""
    names = ["1", *(name for name, _ in more), "x1", "x2", "x1:x2", "x1^2", "x2^2"]
    return np.column_stack(
        [np.ones_like(x1), *(column for _, column in more), x1, x2, x1 * x2, x1**2, x2**2]
    ), names


def chemreact():
    data = {
        name: np.array(column, dtype=float)
        for name, column in FACTS["chemreact"]["data"].items()
        if name != "coding"
    }
    matrix, names = second_order(
        (data["Time"] - 85) / 5, (data["Temp"] - 175) / 5, ("Block2", data["Block"] - 1)
    )
    return least_squares(matrix, data["Yield"], names)


def uniformity():
    data = FACTS["uniformity"]["data"]
    matrix, names = second_order(
        (np.array(data["pressure"]) - 42) / 38, (np.array(data["h2_wf6"]) - 6) / 4
    )
    return least_squares(matrix, data["uniformity"], names)


PUBLISHED = [("chemreact", chemreact), ("uniformity", uniformity)]


@pytest.mark.parametrize(("name", "build"), PUBLISHED)
@pytest.mark.parametrize(
    ("column", "key"),
    [
        ("coefficient", "coef"),
        ("standard_error", "se"),
        ("t", "t"),
        ("p", "pvalue"),
        ("vif", "vif"),
    ],
)
def test_coefficient_table_equals_the_published_one(name, build, column, key):
    """Lenth 2009 (rsm, ChemReact) and NIST e-Handbook 5.4.7.3 (uniformity), column by column."""
    table = regression.table(build())
    published = {
        ("1" if term == "Intercept" else term): value for term, value in FACTS[name][key].items()
    }
    ours = table[column].sel(term=list(published)).values
    np.testing.assert_allclose(ours, list(published.values()), rtol=1e-8)


@pytest.mark.parametrize(("name", "build"), PUBLISHED)
def test_summary_equals_the_published_one(name, build):
    """R2, F, PRESS, Q2, AICc and the lack-of-fit test of the same two tables."""
    table, facts = regression.table(build()), FACTS[name]
    lack = facts["lack_of_fit"]
    expected = {
        "r2": facts["r2"],
        "r2_adjusted": facts["r2_adj"],
        "residual_sd": facts["resid_sd"],
        "f": facts["f"],
        "f_p": facts["f_pvalue"],
        "sse": facts["sse"],
        "press": facts["press"],
        "q2": facts["q2_loo"],
        "aicc": facts["aicc(k=p+1 incl sigma)"],
        "pure_error": lack["ss_pe"],
        "lack_of_fit_f": lack["F"],
        "lack_of_fit_p": lack["p"],
        "df_lack_of_fit": lack["df_lof"],
        "df_pure_error": lack["df_pe"],
    }
    for key, value in expected.items():
        assert float(table[key]) == pytest.approx(value, rel=1e-9), key


@pytest.mark.parametrize(("name", "build"), PUBLISHED)
def test_run_diagnostics_equal_the_published_ones(name, build):
    """Leverage, Cook's distance and both studentised residuals of the same two tables."""
    table = regression.table(build())
    for ours, key in [
        ("leverage", "leverage"),
        ("cooks_distance", "cooks_distance"),
        ("studentised", "rstudent_internal"),
        ("studentised_external", "rstudent_external"),
    ]:
        np.testing.assert_allclose(table[ours], FACTS[name][key], rtol=1e-8)


def test_interval_is_student_t_about_the_coefficient():
    """95 % interval: b +- t(0.975, n - p) se, here with 5 degrees of freedom."""
    table = regression.table(uniformity())
    half = 2.570581835636314 * table["standard_error"]
    np.testing.assert_allclose(table["high"] - table["coefficient"], half, rtol=1e-10)
    np.testing.assert_allclose(table["coefficient"] - table["low"], half, rtol=1e-10)


def random_model(seed=3, n=24):
    rng = np.random.default_rng(seed)
    x1, x2 = rng.uniform(-1, 1, (2, n))
    matrix, names = second_order(x1, x2)
    return matrix, rng.normal(size=n), names


@pytest.mark.parametrize("groups", [24, 5, 3])
def test_leave_out_equals_refitting(groups):
    """The closed form (I - H_BB)^-1 e_B is the refit without fold B, to rounding."""
    matrix, y, names = random_model()
    folds = np.arange(24) % groups
    refit = np.empty(24)
    for fold in range(groups):
        rest = folds != fold
        refit[~rest] = matrix[~rest] @ np.linalg.lstsq(matrix[rest], y[rest], rcond=None)[0]
    model = least_squares(matrix, y, names)
    np.testing.assert_allclose(model.leave_out(folds), refit, atol=1e-12)
    if groups == 24:
        np.testing.assert_allclose(model.leave_one_out(), refit, atol=1e-12)


def test_nested_test_on_one_term_is_the_square_of_t():
    """F(1, v) of adding one term equals t^2 of that term, with the same p."""
    matrix, y, names = random_model()
    larger = least_squares(matrix, y, names)
    smaller = least_squares(matrix[:, :-1], y, names[:-1])
    table = regression.table(larger)
    result = regression.nested(smaller, larger)
    assert result.f == pytest.approx(float(table["t"][-1]) ** 2, rel=1e-9)
    assert result.p == pytest.approx(float(table["p"][-1]), rel=1e-9)
    assert (result.df_terms, result.df_residual) == (1, 18)


def test_nested_test_against_the_mean_is_the_overall_f():
    """Adding every term to the constant gives the table's F."""
    matrix, y, names = random_model()
    larger = least_squares(matrix, y, names)
    result = regression.nested(least_squares(matrix[:, :1], y, ["1"]), larger)
    assert result.f == pytest.approx(float(regression.table(larger)["f"]), rel=1e-10)


def test_nested_refuses_models_that_are_not():
    matrix, y, names = random_model()
    other = least_squares(matrix[:, [0, 1]], y, ["1", "x1"])
    larger = least_squares(matrix[:, [0, 2]], y, ["1", "x2"])
    with pytest.raises(FitError, match="not part of"):
        regression.nested(other, larger)
    with pytest.raises(FitError, match="different runs"):
        regression.nested(other, least_squares(matrix, y + 1.0, names))


def test_saturated_fit_says_so_and_keeps_its_coefficients():
    """n = p: coefficients are exact, everything that needs residuals is NaN."""
    x1 = np.array([-1.0, 1, -1, 1])
    x2 = np.array([-1.0, -1, 1, 1])
    matrix = np.column_stack([np.ones(4), x1, x2, x1 * x2])
    model = least_squares(matrix, 3 + 2 * x1 - x2 + 0.5 * x1 * x2, ["1", "x1", "x2", "x1:x2"])
    table = regression.table(model)
    np.testing.assert_allclose(table["coefficient"], [3, 2, -1, 0.5], atol=1e-14)
    assert float(table["r2"]) == pytest.approx(1.0)
    for name in (
        "standard_error",
        "t",
        "p",
        "low",
        "high",
        "q2",
        "press",
        "f_p",
        "aicc",
        "residual_sd",
        "studentised",
        "cooks_distance",
        "r2_adjusted",
    ):
        assert np.isnan(table[name]).all(), name
    assert "4 runs determine 4 coefficients" in table.attrs["notes"]


def test_aliased_terms_are_named_and_have_no_coefficient():
    """In a half fraction with x3 = x1 x2 neither x3 nor x1:x2 can be estimated; x1, x2 can."""
    x1, x2 = np.array([[-1.0, -1], [1, -1], [-1, 1], [1, 1]] * 2).T
    matrix = np.column_stack([np.ones(8), x1, x2, x1 * x2, x1 * x2])
    y = 1 + x1 + 4 * x1 * x2 + np.array([1, 1, 1, 1, -1, -1, -1, -1]) * 0.1
    table = regression.table(least_squares(matrix, y, ["1", "x1", "x2", "x3", "x1:x2"]))
    np.testing.assert_allclose(table["coefficient"], [1, 1, 0, np.nan, np.nan], atol=1e-14)
    assert float(table["df_residual"]) == 4
    assert "x1:x2 is aliased with x3" in table.attrs["notes"]


def test_squares_of_a_two_level_design_are_aliased_with_the_constant():
    x = np.array([-1.0, 1, -1, 1])
    model = least_squares(np.column_stack([np.ones(4), x, x**2]), x, ["1", "x", "x^2"])
    assert regression.aliases(model) == ["x^2 is aliased with 1: the runs cannot tell them apart."]


def test_run_that_alone_determines_a_term_has_no_press():
    """A run of leverage 1 cannot be left out; the others' diagnostics remain."""
    x = np.array([0.0, 0, 0, 0, 1])
    y = np.array([1.0, 2, 1, 2, 9])
    model = least_squares(np.column_stack([np.ones(5), x]), y, ["1", "x"])
    table = regression.table(model)
    assert np.isnan(table["press"]) and np.isnan(table["studentised"][4])
    assert np.isfinite(table["studentised"][:4]).all() and np.isfinite(table["p"]).all()
    assert "Run 4" in table.attrs["notes"]


def test_replicates_of_a_deterministic_solver_are_no_pure_error():
    x = np.array([-1.0, 1, 0, 0, 0, 0.5])
    model = least_squares(np.column_stack([np.ones(6), x]), np.exp(x), ["1", "x"])
    table = regression.table(model, x[:, None], deterministic=True)
    assert np.isnan(table["lack_of_fit_f"]) and float(table["df_pure_error"]) == 2
    assert "replicates agree exactly" in table.attrs["notes"]
    assert "lack of fit and not noise" in table.attrs["notes"]


def test_p_values_are_uniform_when_there_is_no_effect():
    """Under the null hypothesis p is uniform: Kolmogorov-Smirnov over 400 noise samples."""
    matrix, _, names = random_model()
    noise = np.random.default_rng(0).normal(size=(400, 24))
    p = [float(regression.table(least_squares(matrix, y, names))["p"][2]) for y in noise]
    assert stats.kstest(p, "uniform").pvalue > 0.01


def test_values_that_are_not_finite_are_refused():
    with pytest.raises(FitError, match="not finite"):
        least_squares(np.ones((3, 1)), [1.0, np.nan, 2.0], ["1"])
