"""Surrogates of every kind to be exported, and points to compare them at."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surrogate.export.description import Description, describe
from surrogate.fitting.fit import Fit, fit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.regressors.selection import Lasso, Stepwise
from surrogate.solver import Output
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

COMPILER = shutil.which("cc") or shutil.which("gcc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler")
STRICT = ("-O2", "-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic")

SPACE = Space(
    (
        Parameter("tension", uniform(0.05, 0.14), unit="N/mm"),
        Parameter("cloth", levels=("p", "q", "r")),
        Parameter("c10", distribution("normal", mean=5, std=1), unit="kPa"),
        Parameter("t", distribution("lognormal", mean=2, std=0.4)),
        Parameter("teeth", integers((3, 12))),
        Parameter("pipe", listed([10.0, 16.0])),
    )
)
KINDS: dict[str, Any] = {
    "linear": Linear(),
    "interactions": Interactions(),
    "quadratic": Quadratic(),
    "stepwise": Stepwise(),
    "lasso": Lasso(),
    "chaos": PolynomialChaos(max_degree=3),
    "gp": GaussianProcess(starts=1),
    "gp_linear": GaussianProcess(trend="linear", starts=1),
    "gp_interpolating": GaussianProcess(nugget=1e-8, starts=1),
}
FIELDS = ("quadratic", "chaos", "gp")
#: Name of every case: scalars by kind, fields, a field that does not vary, a saturated fit.
CASES = (*KINDS, *(f"{kind}_field" for kind in FIELDS), "same_field", "saturated", "no_terms")
#: Largest differences to Python, as a share of the output's spread.
MEAN, STD = 1e-12, 1e-9
#: Training runs: more than the quadratic has terms, or enough for a process.
RUNS, FEW = 45, 25


def truth(x: np.ndarray) -> np.ndarray:
    """Smooth in the numbers, another slope for each cloth."""
    cloth = np.where(x[:, 1] == 0, 3.0, x[:, 1])
    return 40 + 5 * x[:, 0] + cloth * x[:, 2] + np.sin(2 * x[:, 3]) * x[:, 4] + x[:, 5] * x[:, 0]


def spread_out(x: np.ndarray) -> np.ndarray:
    """A field over 3 x 4 places."""
    waves = np.cos(np.arange(12.0).reshape(3, 4))
    return truth(x)[:, None, None] * waves + x[:, :1, None] ** 2 * waves**2


@dataclass(frozen=True, eq=False)
class Case:
    """A fit, its description, and what Python says at `points()`."""

    name: str
    fit: Fit
    description: Description

    @cached_property
    def predicted(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation (m, ...)."""
        return self.fit.predict(SPACE.encode(named(points())), return_std=True)

    def check(self, mean: np.ndarray, std: np.ndarray) -> None:
        """The same, within `MEAN` and `STD` of the spread.

        Weights of a process are large and cancel; what rounding costs Python's sum and the other
        one, eps times the sizes of all weights each, comes on top.
        """
        own_mean, own_std = self.predicted
        scale = max(float(self.fit.values.std()), 1e-3)
        rounding = 2.0 * self.description.formula.rounding.reshape(own_mean.shape[1:])
        assert np.shape(mean) == own_mean.shape and np.shape(std) == own_std.shape
        assert np.isfinite(own_mean).all()
        assert (np.abs(mean - own_mean) <= MEAN * scale + rounding).all()
        np.testing.assert_allclose(std, own_std, rtol=0, atol=STD * scale, equal_nan=True)


@cache
def case(name: str) -> Case:
    """The case of that name, which is also that of its function."""
    kind = name.removesuffix("_field")
    field = kind != name
    train = SPACE.sample(RUNS, seed=1)[: FEW if kind in ("gp", "gp_linear") else RUNS]
    values = spread_out(train) if field else truth(train)
    if name == "same_field":
        values = np.broadcast_to(np.arange(12.0).reshape(3, 4), (RUNS, 3, 4))
    if name == "saturated":
        train, values = train[:8], truth(train[:8])
    if name == "no_terms":
        values = np.full(RUNS, 3.5)
    estimator = KINDS.get(kind) or {"same": GaussianProcess(), "saturated": Linear()}.get(
        kind, PolynomialChaos(max_degree=1)
    )
    fitted = fit(SPACE, train, values, estimator, surrogate=kind, output="y*/")
    places = {"height": np.array([0.0, 0.5, 2.0]), "side": np.array(["l", 'm"', "n\\", "o"])}
    output = Output("mmHg", tuple(places), places) if field else Output("mmHg")
    told = describe(
        fitted,
        output,
        name=name,
        study="of /* hard */ text \\",
        nominal={"tension": 0.1, "cloth": "q"},
        constants={"mu": 0.6, "yarn": "wool"},
    )
    return Case(name, fitted, told)


@cache
def points() -> np.ndarray:
    """Physical points (m, D), levels by number: random ones, edges, runs, outside of the ranges."""
    rng = np.random.default_rng(5)
    columns = []
    for parameter in SPACE.parameters:
        if parameter.categorical:
            columns.append(rng.integers(0, len(parameter.levels), 120).astype(float))
            continue
        low, high = parameter.law.support if parameter.bounded else parameter.law.ppf([0.01, 0.99])
        inside = rng.uniform(low, high, 60)
        edges = rng.choice([low, high, 0.5 * (low + high)], 30)
        outside = rng.uniform(low - 0.3 * (high - low), high + 0.3 * (high - low), 30)
        columns.append(np.concatenate([inside, edges, outside]))
    found = np.column_stack(columns)
    found[-1, 3] = -1.0  # where a lognormal law has no logarithm
    runs = SPACE.decode(SPACE.sample(RUNS, seed=1))
    numbers = {level: float(k) for k, level in enumerate(SPACE["cloth"].levels)}
    runs["cloth"] = np.array([numbers[level] for level in runs["cloth"]])
    trained = np.column_stack([runs[name] for name in SPACE.names])
    return np.ascontiguousarray(np.vstack([found, trained]))


def named(at: np.ndarray) -> dict[str, Any]:
    """Columns of physical points by name, levels by name."""
    columns: dict[str, Any] = dict(zip(SPACE.names, at.T, strict=True))
    columns["cloth"] = np.array(SPACE["cloth"].levels)[at[:, 1].astype(int)]
    return columns


def write(path: Path, content: bytes) -> Path:
    """A file with that content."""
    path.write_bytes(content)
    return path
