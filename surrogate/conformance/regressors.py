"""Does a regressor keep the contract: a scikit-learn estimator on coded inputs?"""

from __future__ import annotations

import inspect
import json
import pickle
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from surrogate.conformance.verdict import attempt, conclude, documented, global_randomness, same
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(name, uniform(0.0, 1.0)) for name in ("length", "width", "height")))
RUNS, ELSEWHERE = 40, 25

Numbers = NDArray[np.float64]


def check_regressor(estimator: Any, *, runs: int = RUNS, space: Space = SPACE) -> None:
    """Raise `PluginError` with everything about an unfitted `estimator` that breaks the contract.

    runs   number of training points of a smooth function of three inputs
    space  of the three inputs, for a regressor that is not for three ranges
    """
    name = type(estimator).__name__
    conclude(name, [*documented(estimator), *_estimator(estimator)])
    rng = np.random.default_rng(0)
    X, Z = (space.snap(rng.uniform(-1.0, 1.0, (n, space.size))) for n in (runs, ELSEWHERE))
    conclude(name, _behaviour(_prepared(estimator, space), X, _smooth(X), Z))


def _smooth(X: Numbers) -> Numbers:
    values: Numbers = 30.0 + 4.0 * X[:, 0] - 2.0 * X[:, 1] + X[:, 0] * X[:, 1] + 0.5 * X[:, 2] ** 2
    return values


def _estimator(estimator: Any) -> Iterable[str]:
    for method in ("fit", "predict", "get_params", "set_params"):
        if not callable(getattr(estimator, method, None)):
            yield f"has no {method}; derive it from sklearn.base.RegressorMixin and BaseEstimator"
            return
    copied, sentences = attempt("sklearn.base.clone", lambda: clone(estimator))
    if sentences:
        yield sentences[0] + "; let __init__ store its arguments unchanged and do nothing else"
    elif set(copied.get_params(deep=False)) != set(estimator.get_params(deep=False)):
        yield "a clone has other parameters; let get_params name all arguments of __init__"


def _prepared(estimator: Any, space: Space) -> Any:
    """A clone, with the space if it asks for one, as a study would set it."""
    copied = clone(estimator)
    return copied.set_params(space=space) if "space" in copied.get_params(deep=False) else copied


def _behaviour(estimator: Any, X: Numbers, y: Numbers, Z: Numbers) -> list[str]:
    found: list[str] = []
    mine = X.copy(), y.copy()
    with global_randomness(found):
        fitted, sentences = attempt(f"fitting {len(X)} points", lambda: clone(estimator).fit(*mine))
    if sentences:
        return sentences
    if not (same(mine[0], X) and same(mine[1], y)):
        found.append("fit changes its training data; copy what it changes")
    if not hasattr(fitted, "predict"):
        return [*found, "fit does not return the estimator; end it with `return self`"]
    predicted, sentences = attempt("predict", lambda: fitted.predict(Z.copy()))
    found += sentences or list(_prediction(predicted, len(Z), "predict"))
    if found:
        return found
    return [
        *_consistency(estimator, fitted, X, y, Z, predicted),
        *_uncertainty(fitted, Z, predicted),
        *_closed_forms(fitted, len(X)),
    ]


def _prediction(values: Any, points: int, what: str) -> Iterable[str]:
    if not isinstance(values, np.ndarray) or values.shape != (points,):
        shape = getattr(values, "shape", type(values).__name__)
        yield f"{what} of {points} points returned {shape}; return an array of shape ({points},)"
    elif not np.isfinite(values).all():
        yield f"{what} returned values that are not finite"


def _consistency(
    estimator: Any, fitted: Any, X: Numbers, y: Numbers, Z: Numbers, predicted: Numbers
) -> Iterable[str]:
    scale = np.ptp(y)
    parts = np.concatenate([fitted.predict(Z[:7]), fitted.predict(Z[7:8]), fitted.predict(Z[8:])])
    if np.abs(parts - predicted).max() > 1e-8 * scale:
        yield (
            "predictions depend on which points are asked together; a study predicts in chunks, "
            "so scale by training data only"
        )
    again = clone(estimator).fit(X, y).predict(Z)
    if not same(again, predicted):
        yield "a second fit to the same data predicts differently; give it a seed (random_state)"
    copied, sentences = attempt("pickling", lambda: pickle.loads(pickle.dumps(fitted)))
    if sentences:
        yield sentences[0] + "; keep lambdas and open files out of its attributes"
    elif not same(copied.predict(Z), predicted):
        yield "a pickled copy predicts differently; keep all that matters in attributes"


def _uncertainty(fitted: Any, Z: Numbers, predicted: Numbers) -> Iterable[str]:
    if "return_std" not in inspect.signature(fitted.predict).parameters:
        return
    pair, sentences = attempt(
        "predict(return_std=True)", lambda: fitted.predict(Z, return_std=True)
    )
    if sentences or not isinstance(pair, tuple) or len(pair) != 2:
        yield from sentences or ["predict(return_std=True) must return (mean, std)"]
        return
    mean, std = pair
    yield from _prediction(std, len(Z), "the std of predict(return_std=True)")
    if not np.allclose(mean, predicted, rtol=1e-8, atol=1e-8 * np.ptp(predicted)):
        yield "predict(return_std=True) has another mean than predict"
    if not (np.asarray(std) >= 0).all():
        yield "the std of predict(return_std=True) is negative somewhere"


def _closed_forms(fitted: Any, runs: int) -> Iterable[str]:
    """The optional methods, where the estimator has them."""
    if hasattr(fitted, "sobol_indices"):
        indices, sentences = attempt("sobol_indices", fitted.sobol_indices)
        yield from sentences or _indices(indices)
    if hasattr(fitted, "leave_one_out"):
        values, sentences = attempt("leave_one_out", fitted.leave_one_out)
        yield from sentences or _prediction(values, runs, "leave_one_out")
    if hasattr(fitted, "portable"):
        _, sentences = attempt("portable", lambda: json.dumps(fitted.portable(), allow_nan=False))
        yield from (
            f"{s}; return plain dictionaries, lists, texts and finite numbers" for s in sentences
        )


def _indices(indices: Any) -> Iterable[str]:
    for attribute in ("first_order", "total"):
        values = np.asarray(getattr(indices, attribute, np.nan), dtype=float)
        if values.shape != (SPACE.size,):
            yield f"sobol_indices().{attribute} must have shape ({SPACE.size},)"
        elif not ((values > -1e-9) & (values < 1.0 + 1e-9)).all():
            yield f"sobol_indices().{attribute} = {values} leaves [0, 1]"
