"""How well a model agrees with a reference: the figures of method comparison.

With reference x, model y and differences d = y - x over n pairs:

    slope through the origin   b = sum x y / sum x^2 (reference on x, model on y)
    R2, two of them            squared correlation of x and y, blind to scale and offset;
                               1 - sum d^2 / sum (x - mean x)^2, of the model as it stands
    bias                       mean d, with Student's interval
    limits of agreement        bias -+ 1.96 s, between which 95 % of differences lie
                               (Bland and Altman 1986)

Intervals of the limits are exact for normal differences: sqrt(n) (limit - mean d) / s is
a noncentral t (Carkeet 2015). With several pairs a subject the differences scatter
between and within subjects; both parts come from an analysis of variance (Bland and
Altman 2007, the true value varying) and the intervals of the limits from the delta method.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

#: Name -> (what it is, whether it is in the output's unit).
FIGURES = {
    "n": ("pairs compared", False),
    "slope": ("slope of the regression through the origin, model on reference", False),
    "slope_low": ("lower end of its interval", False),
    "slope_high": ("upper end of its interval", False),
    "r2_correlation": ("squared correlation of model and reference", False),
    "r2": ("1 - sum of squared errors / sum of squares of the reference about its mean", False),
    "mean_error_percent": ("mean of (model - reference) / reference, in percent", False),
    "mean_absolute_error_percent": ("mean of |model - reference| / reference, in percent", False),
    "rmse": ("root mean square of model - reference", True),
    "bias": ("mean of model - reference", True),
    "bias_low": ("lower end of its interval", True),
    "bias_high": ("upper end of its interval", True),
    "sd": ("standard deviation of model - reference", True),
    "lower_limit": ("lower limit of agreement, bias - 1.96 sd", True),
    "lower_limit_low": ("lower end of its interval", True),
    "lower_limit_high": ("upper end of its interval", True),
    "upper_limit": ("upper limit of agreement, bias + 1.96 sd", True),
    "upper_limit_low": ("lower end of its interval", True),
    "upper_limit_high": ("upper end of its interval", True),
    "sd_within": ("of that, standard deviation within a subject", True),
    "sd_between": ("of that, standard deviation between subjects", True),
}


def agreement(
    reference: ArrayLike,
    model: ArrayLike,
    subjects: ArrayLike | None = None,
    *,
    confidence: float = 0.95,
    multiple: float = 1.96,
) -> dict[str, float]:
    """`FIGURES` of pairs (n,), those with a NaN left out; NaN where too few pairs are left.

    subjects  (n,) who each pair belongs to; None, or all different, for one pair each
    multiple  standard deviations from the bias to a limit (1.96; Bland and Altman 1986: 2)

    The slope's interval takes pairs of one subject for independent ones.
    """
    x, y = np.asarray(reference, dtype=float), np.asarray(model, dtype=float)
    known = np.isfinite(x) & np.isfinite(y)
    x, y, groups = x[known], y[known], _groups(subjects, known)
    found = dict.fromkeys(FIGURES, np.nan) | {"n": float(len(x))}
    if len(x) == 0:
        return found
    found |= _errors(x, y)
    if len(x) < 2:
        return found
    found |= _regression(x, y, confidence)
    limits = _plain if groups.max() + 1 == len(x) else _repeated
    return found | limits(y - x, groups, confidence, multiple)


def _groups(subjects: ArrayLike | None, known: np.ndarray) -> np.ndarray:
    """Number of the subject of each pair that is known."""
    if subjects is None:
        return np.arange(known.sum())
    return np.unique(np.asarray(subjects).astype(str)[known], return_inverse=True)[1]


def _errors(x: np.ndarray, y: np.ndarray) -> dict[str, float]:
    error = y - x
    relative = error / x if (x != 0.0).all() else np.full(len(x), np.nan)
    return {
        "bias": error.mean(),
        "rmse": np.sqrt((error**2).mean()),
        "mean_error_percent": 100.0 * relative.mean(),
        "mean_absolute_error_percent": 100.0 * np.abs(relative).mean(),
    }


def _regression(x: np.ndarray, y: np.ndarray, confidence: float) -> dict[str, float]:
    squares = (x**2).sum()
    slope = (x * y).sum() / squares if squares else np.nan
    error = np.sqrt(((y - slope * x) ** 2).sum() / (len(x) - 1) / squares) if squares else np.nan
    half = stats.t.ppf(0.5 + confidence / 2.0, len(x) - 1) * error
    about_mean = ((x - x.mean()) ** 2).sum()
    both = np.sqrt(about_mean * ((y - y.mean()) ** 2).sum())
    return {
        "slope": slope,
        "slope_low": slope - half,
        "slope_high": slope + half,
        "r2": 1.0 - ((y - x) ** 2).sum() / about_mean if about_mean else np.nan,
        "r2_correlation": (((x - x.mean()) * (y - y.mean())).sum() / both) ** 2 if both else np.nan,
    }


def _plain(
    d: np.ndarray, groups: np.ndarray, confidence: float, multiple: float
) -> dict[str, float]:
    """Limits from independent differences."""
    n, bias, sd = len(d), d.mean(), d.std(ddof=1)
    tails = np.array([0.5 - confidence / 2.0, 0.5 + confidence / 2.0])
    reach = stats.t.ppf(tails, n - 1) * sd / np.sqrt(n)
    outer = (
        stats.nct.ppf(tails, n - 1, multiple * np.sqrt(n)) * sd / np.sqrt(n)
        if sd > 0
        else np.zeros(2)
    )
    return _limits(bias, sd, multiple, reach[1], outer)


def _repeated(
    d: np.ndarray, groups: np.ndarray, confidence: float, multiple: float
) -> dict[str, float]:
    """Limits from several differences a subject: one-way analysis of variance.

    The mean number of differences a subject is m0 = (N^2 - sum m^2) / ((k - 1) N); the
    total variance msb / m0 + (1 - 1 / m0) msw is that of one new pair of a new subject.
    """
    sizes = np.bincount(groups)
    total, k = len(d), len(sizes)
    if k < 2:
        return {"sd": np.nan}
    means = np.bincount(groups, d) / sizes
    within = ((d - means[groups]) ** 2).sum() / (total - k)
    between = (sizes * (means - d.mean()) ** 2).sum() / (k - 1)
    m0 = (total**2 - (sizes**2).sum()) / ((k - 1) * total)
    apart = max(0.0, (between - within) / m0)
    variance = apart + within
    of_bias = apart * (sizes**2).sum() / total**2 + within / total
    of_variance = 2.0 * (between / m0) ** 2 / (k - 1) + 2.0 * ((1.0 - 1.0 / m0) * within) ** 2 / (
        total - k
    )
    t = stats.t.ppf(0.5 + confidence / 2.0, k - 1)
    sd = np.sqrt(variance)
    half = t * np.sqrt(
        of_bias + (multiple**2 * of_variance / (4.0 * variance) if variance else 0.0)
    )
    found = _limits(
        d.mean(), sd, multiple, t * np.sqrt(of_bias), multiple * sd + np.array([-half, half])
    )
    return found | {"sd_within": np.sqrt(within), "sd_between": np.sqrt(apart)}


def _limits(
    bias: float, sd: float, multiple: float, half: float, outer: np.ndarray
) -> dict[str, float]:
    """outer: interval of limit - bias for the upper limit; the lower one mirrors it."""
    return {
        "bias_low": bias - half,
        "bias_high": bias + half,
        "sd": sd,
        "lower_limit": bias - multiple * sd,
        "upper_limit": bias + multiple * sd,
        "lower_limit_low": bias - outer[1],
        "lower_limit_high": bias - outer[0],
        "upper_limit_low": bias + outer[0],
        "upper_limit_high": bias + outer[1],
    }
