"""The regression table of a least squares fit, and the F test of nested models.

The formulas are those of Montgomery, Peck, Vining, Introduction to Linear Regression Analysis
(5th ed. 2012), chapters 3, 4 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from surrogate.errors import FitError
from surrogate.regressors.box_cox import box_cox
from surrogate.regressors.least_squares import LEVERAGE_TOLERANCE, LeastSquares
from surrogate.regressors.lenth import of_saturated

Array = NDArray[np.float64]

DETERMINISTIC = (
    "The solver is deterministic: the residuals are lack of fit and not noise, so "
    "standard errors, t and p say how well the polynomial describes the solver, not "
    "how surely an effect exists."
)


def table(
    model: LeastSquares,
    points: ArrayLike | None = None,
    *,
    confidence: float = 0.95,
    deterministic: bool = False,
) -> xr.Dataset:
    """The regression table of a fit.

    points (n, d), the runs' inputs, show which runs are replicates (default: equal
    rows of the matrix). Dimension `term`: coefficient, standard_error, t, p, low,
    high, vif. Scalars: r2, r2_adjusted, press, q2, residual_sd, f, f_p, aicc,
    lack_of_fit_f, lack_of_fit_p and degrees of freedom. Dimension `run`: residual,
    leverage, cooks_distance, studentised (internal), studentised_external.
    What the runs cannot tell is NaN, and `notes` says why. Besides, where they exist: Lenth's
    pseudo standard error and margins of a saturated fit (lenth_pse, lenth_margin,
    lenth_simultaneous), and Box and Cox's power of the output (box_cox, box_cox_low,
    box_cox_high; the attribute `transformation` names a round one that does better than y).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        columns = {name: ("term", value) for name, value in _terms(model, confidence).items()}
        rows = {name: ("run", value) for name, value in _runs(model).items()}
        pure = _lack_of_fit(model, model.matrix if points is None else np.asarray(points))
        numbers = {**_summary(model), **pure, **_lenth(model, confidence)}
        power = box_cox(model, confidence)
        if power is not None:
            numbers |= {"box_cox": power.best, "box_cox_low": power.low, "box_cox_high": power.high}
        scalars = {name: ((), float(value)) for name, value in numbers.items()}
    notes = _notes(model, pure) + ([DETERMINISTIC] if deterministic else [])
    return xr.Dataset(
        {**columns, **scalars, **rows},
        coords={"term": list(model.names)},
        attrs={
            "confidence": confidence,
            "notes": "\n".join(notes),
            "deterministic": int(deterministic),
            "transformation": power.transformation if power is not None else "",
        },
    )


def _terms(model: LeastSquares, confidence: float) -> dict[str, Array]:
    """Coefficient columns of the table; VIF_j = C_jj sum (x_j - mean)^2."""
    unscaled = np.full(len(model.names), np.nan)
    unscaled[model.kept] = (model.inverse**2).sum(axis=1)
    unscaled[~model.estimable] = np.nan
    coefficient = np.where(model.estimable, model.coefficients, np.nan)
    error = model.residual_sd * np.sqrt(unscaled)
    t = coefficient / error
    half = _student(confidence, model.freedom) * error
    about_mean = ((model.matrix - model.matrix.mean(axis=0)) ** 2).sum(axis=0)
    constant = about_mean <= 1e-20 * np.maximum((model.matrix**2).sum(axis=0), 1e-300)
    return {
        "coefficient": coefficient,
        "standard_error": error,
        "t": t,
        "p": _tail(stats.t, np.abs(t), model.freedom, sides=2),
        "low": coefficient - half,
        "high": coefficient + half,
        "vif": np.where(constant, np.nan, unscaled * about_mean),
    }


def _lenth(model: LeastSquares, confidence: float) -> dict[str, float]:
    found = of_saturated(model, confidence)
    return {} if found is None else {f"lenth_{name}": value for name, value in vars(found).items()}


def _student(confidence: float, freedom: int) -> float:
    return float(stats.t.ppf(0.5 + confidence / 2.0, freedom)) if freedom else np.nan


def _tail(law: Any, value: Any, *freedom: int, sides: int = 1) -> Any:
    """Probability above `value`; NaN where a number of degrees of freedom is zero."""
    return sides * law.sf(value, *freedom) if all(freedom) else np.nan * value


def _summary(model: LeastSquares) -> dict[str, float]:
    n, rank = model.basis.shape
    press = float(((model.y - model.leave_one_out()) ** 2).sum())
    variance = model.residual_sd**2
    f = _ratio((model.sst - model.sse) / (rank - 1), variance) if rank > 1 else np.nan
    return {
        "r2": 1.0 - _ratio(model.sse, model.sst),
        "r2_adjusted": 1.0 - _ratio(variance, model.sst / (n - 1)),
        "press": press,
        "q2": 1.0 - _ratio(press, model.sst),
        "residual_sd": model.residual_sd,
        "f": f,
        "f_p": _tail(stats.f, f, rank - 1, model.freedom),
        "aicc": _aicc(model),
        "sse": model.sse,
        "runs": n,
        "df_model": rank - 1,
        "df_residual": model.freedom,
    }


def _ratio(part: float, whole: float) -> float:
    """part / whole in the floating point sense: inf or NaN for a whole of zero."""
    return float(np.divide(part, whole))


def _aicc(model: LeastSquares) -> float:
    """-2 log L + 2 k n / (n - k - 1) with k = r + 1 counting the variance (Hurvich, Tsai 1989)."""
    n, k = len(model.y), model.basis.shape[1] + 1
    if n - k - 1 <= 0 or model.sse <= 0.0:
        return np.nan
    return float(n * (np.log(2.0 * np.pi * model.sse / n) + 1.0) + 2.0 * k * n / (n - k - 1))


def _runs(model: LeastSquares) -> dict[str, Array]:
    """Diagnostics of each run (Montgomery et al., sections 4.2 and 6.3)."""
    leverage, freedom = model.leverage, model.freedom
    slack = np.where(1.0 - leverage < LEVERAGE_TOLERANCE, np.nan, 1.0 - leverage)
    internal = model.residuals / (model.residual_sd * np.sqrt(slack))
    rest = np.where(freedom - internal**2 > 0.0, freedom - internal**2, np.nan)
    external = internal * np.sqrt((freedom - 1) / rest) if freedom > 1 else np.nan * internal
    return {
        "residual": model.residuals,
        "leverage": leverage,
        "cooks_distance": internal**2 * leverage / (slack * model.basis.shape[1]),
        "studentised": internal,
        "studentised_external": external,
    }


def _lack_of_fit(model: LeastSquares, points: Array) -> dict[str, float]:
    """F test of lack of fit against pure error (Montgomery et al., section 4.5)."""
    _, group = np.unique(np.round(points, 9), axis=0, return_inverse=True)
    group = group.ravel()
    means = np.bincount(group, model.y) / np.bincount(group)
    pure = float(((model.y - means[group]) ** 2).sum())
    df_pure = len(model.y) - len(means)
    df_lack = model.freedom - df_pure
    # Rounding of identical runs is not an experimental error to test against.
    noisy = pure > 1e-24 * max(float(model.y @ model.y), 1e-300)
    f = np.nan
    if df_pure and df_lack > 0 and noisy:
        f = max(model.sse - pure, 0.0) / df_lack / (pure / df_pure)
    return {
        "lack_of_fit_f": f,
        "lack_of_fit_p": _tail(stats.f, f, df_lack, df_pure),
        "pure_error": pure,
        "df_lack_of_fit": df_lack,
        "df_pure_error": df_pure,
    }


def _notes(model: LeastSquares, pure: dict[str, float]) -> list[str]:
    notes = aliases(model)
    if model.freedom == 0:
        notes.append(
            f"The fit is saturated: {len(model.y)} runs determine "
            f"{model.basis.shape[1]} coefficients and leave nothing to judge them by. "
            "Standard errors, p-values and Q2 do not exist; add runs."
        )
    elif (alone := np.flatnonzero(1.0 - model.leverage < LEVERAGE_TOLERANCE)).size:
        notes.append(
            f"Run {', '.join(map(str, alone))} (counted from 0) alone determines a "
            "coefficient; it cannot be left out, so PRESS and Q2 do not exist."
        )
    if pure["df_pure_error"] and np.isnan(pure["lack_of_fit_f"]):
        notes.append(
            "The replicates agree exactly or leave no degrees of freedom: there is no "
            "pure error to test the lack of fit against."
        )
    return notes


def aliases(model: LeastSquares) -> list[str]:
    """A sentence for each term that the runs cannot tell apart from others."""
    kept = np.asarray(model.names)[model.kept]
    sentences = []
    for name, column in zip(np.asarray(model.names)[~model.kept], model.alias.T, strict=True):
        others = kept[np.abs(column) > 1e-8]
        if len(others) == 0:
            sentences.append(f"{name} is zero in every run; it cannot be estimated.")
        else:
            sentences.append(
                f"{name} is aliased with {', '.join(others)}: the runs cannot tell them apart."
            )
    return sentences


@dataclass(frozen=True)
class Nested:
    """F test of a larger model against a smaller one that it contains."""

    f: float
    p: float
    df_terms: int
    df_residual: int


def nested(smaller: LeastSquares, larger: LeastSquares) -> Nested:
    """Do the larger model's additional terms explain more than its residuals would?

    F = ((SSE_s - SSE_l) / (df_s - df_l)) / (SSE_l / df_l). Both must be fits of the
    same runs and the larger must reproduce the smaller (else `FitError`). NaN when
    the larger model leaves no residual degrees of freedom or adds none.
    """
    if not np.array_equal(smaller.y, larger.y):
        raise FitError("the two models are fits of different runs; compare fits of the same runs")
    outside = smaller.basis - larger.basis @ (larger.basis.T @ smaller.basis)
    if np.abs(outside).max() > 1e-6:
        raise FitError(
            "the smaller model is not part of the larger one; the F test needs nested models"
        )
    terms, freedom = smaller.freedom - larger.freedom, larger.freedom
    if terms == 0 or freedom == 0:
        return Nested(np.nan, np.nan, terms, freedom)
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = max(smaller.sse - larger.sse, 0.0) / terms
        f = _ratio(gain, larger.sse / freedom)
    return Nested(f, float(stats.f.sf(f, terms, freedom)), terms, freedom)
