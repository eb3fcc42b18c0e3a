"""Made-up studies whose datasets have the documented names, for the pages to be built from."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import xarray as xr

from surrogate.designs.aliasing import aliasing
from surrogate.fitting import fit as fitting
from surrogate.fitting.comparison import compare
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.report import Content
from surrogate.sensitivity.screening import decide
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

BANDAGE = (
    ("mu_skin", 0.1, 0.3, ""),
    ("tension", 0.059, 0.137, "N/mm"),
    ("leg_length", 184.86, 290.43, "mm"),
    ("alpha1", -0.92, -0.503, ""),
    ("alpha2", -0.109, 0.119, ""),
    ("alpha3", -0.092, 0.068, ""),
    ("alpha4", -0.081, 0.095, ""),
)
HEIGHTS = np.linspace(0.0, 240.0, 30)
ANGLES = np.linspace(-180.0, 165.0, 24)


def bandage_space() -> Space:
    """The seven parameters of a reduced model, ranges with units."""
    meaning = {"mu_skin": "friction of skin and bandage", "tension": "tension per width"}
    return Space(
        tuple(
            Parameter(name, uniform(low, high), unit=unit, description=meaning.get(name, ""))
            for name, low, high, unit in BANDAGE
        )
    )


def wide_space(size: int) -> Space:
    """Many parameters, one of them normal and one categorical."""
    plain = [
        Parameter(f"parameter_{k:02d}", uniform(0.0, 1.0 + k), unit="mm") for k in range(size - 2)
    ]
    return Space(
        (
            *plain,
            Parameter("stiffness", distribution("normal", mean=5.0, std=1.0), (), "kPa"),
            Parameter("bandage", levels=("biflex_16", "biflex_17")),
        )
    )


def pressure(coded: np.ndarray) -> np.ndarray:
    """A pressure with main effects, one interaction, one square; in mmHg, shape (run,)."""
    weights = np.resize([2.7, 11.54, 2.85, 4.54, 3.92, -1.74, -0.51], coded.shape[1])
    return (
        32.73
        + coded @ weights
        + 1.3 * coded[:, 0] * coded[:, -1]
        + 0.9 * coded[:, 0] ** 2
        + 0.5 * np.sin(4.0 * coded[:, 0])
    )


def pressure_map(coded: np.ndarray) -> np.ndarray:
    """A pressure over height and angle, shape (run, height, angle)."""
    shape = np.cos(np.deg2rad(ANGLES))[None, :] * (HEIGHTS / 240.0)[:, None]
    return (
        pressure(coded)[:, None, None] * (1.0 + 0.3 * shape)
        + 4.0 * coded[:, :1, None] * np.sin(HEIGHTS / 40.0)[:, None]
    )


def fraction() -> np.ndarray:
    """2^(7-4), resolution III, and its centre: nine runs of seven parameters."""
    a, b, c = np.array([[(k >> j) & 1 for k in range(8)] for j in range(3)]) * 2 - 1
    return np.vstack([np.column_stack([a, b, c, a * b, a * c, b * c, a * b * c]), np.zeros(7)])


def runs_dataset(space: Space, designs: dict, outputs: dict, failed: dict) -> xr.Dataset:
    """The runs dataset of `designs` (name -> coded points) with `outputs` (name -> function)."""
    coded = np.concatenate(list(designs.values()))
    count = len(coded)
    status = np.array(["failed" if k in failed else "ok" for k in range(count)])
    message = np.array([failed.get(k, "") for k in range(count)])
    variables: dict = {"coded": (("run", "parameter"), coded)}
    for parameter in space.parameters:
        variables[parameter.name] = (
            "run",
            parameter.decode(coded[:, list(space.names).index(parameter.name)]),
            {"units": parameter.unit, "long_name": parameter.description},
        )
    coordinates: dict = {"parameter": list(space.names)}
    for name, (function, dims, unit) in outputs.items():
        values = np.array(function(coded), dtype=float)
        values[status != "ok"] = np.nan
        variables[name] = (("run", *dims), values, {"units": unit, "long_name": f"the {name}"})
        coordinates |= {dim: {"height": HEIGHTS, "angle": ANGLES}[dim] for dim in dims}
    variables |= {
        "design": ("run", np.repeat(list(designs), [len(d) for d in designs.values()])),
        "status": ("run", status),
        "message": ("run", message),
        "seconds": ("run", 41.0 + np.arange(count) % 7),
        "attempts": ("run", np.ones(count, int)),
    }
    return xr.Dataset(
        variables,
        coords=coordinates,
        attrs={
            "study": "study: made_up\nparameters:\n  mu_skin: [0.1, 0.3]\n",
            "solver": "toy",
            "solver_version": "3",
            "versions": json.dumps({"numpy": np.__version__}),
            "seeds": json.dumps({"test": 7}),
            "deterministic": "true",
            "created": "2026-01-01T00:00:00+00:00",
        },
    )


def sensitivity_dataset(space: Space, outputs, refused: str = "") -> xr.Dataset:
    """Indices that fall off geometrically, with intervals; names as documented."""
    d, count = space.size, len(outputs)
    total = np.tile(0.7 * 0.45 ** np.arange(d), (count, 1))
    first = 0.93 * total
    second = np.full((count, d, d), 0.004)
    second[:, np.arange(d), np.arange(d)] = np.nan
    second[:, :1, 1:2] = second[:, 1:2, :1] = 0.05
    variables: dict = {}
    for name, value in (("first_order", first), ("total", total), ("second_order", second)):
        dims = ("output", "parameter", "parameter_2")[: value.ndim]
        sampling, surrogate = 0.01 + 0.02 * value, 0.015 + 0.03 * value
        half = np.hypot(sampling, surrogate)
        variables |= {
            name: (dims, value),
            f"{name}_low": (dims, np.maximum(value - half, 0.0)),
            f"{name}_high": (dims, np.minimum(value + half, 1.0)),
            f"{name}_sampling": (dims, sampling),
            f"{name}_surrogate": (dims, surrogate),
        }
    variables |= {
        "total_worst": (("output", "parameter"), np.minimum(1.0, total + 0.1)),
        "q2": ("output", [0.98] * count),
        "refused": ("output", [refused] * count),
    }
    return xr.Dataset(
        variables,
        coords={
            "output": list(outputs),
            "parameter": list(space.names),
            "parameter_2": list(space.names),
        },
        attrs={
            "surrogate": "quadratic",
            "method": "sobol",
            "confidence": 0.95,
            "computed": "sampling",
        },
    )


def make(
    space: Space | None = None,
    *,
    train=60,
    test=20,
    outputs=("pressure_b1",),
    surrogates=("linear", "interactions", "quadratic"),
    failed=None,
    sensitivity=True,
    name="made_up",
    refused="",
    screened=False,
) -> Content:
    """A whole study: train is a number of random points, or the points themselves."""
    space = space or bandage_space()
    generator = np.random.default_rng(5)
    designs = {
        "train": space.quantile(generator.random((train, space.size)))
        if isinstance(train, int)
        else train
    }
    if test:
        designs["test"] = space.quantile(generator.random((test, space.size)))
    kinds = {
        "pressure_b1": (pressure, (), "mmHg"),
        "slope": (lambda x: pressure(x) ** 2 / 1000.0, (), "mmHg**2/mm"),
        "pressure_map": (pressure_map, ("height", "angle"), "mmHg"),
        "pressure_line": (lambda x: pressure_map(x)[:, :, 0], ("height",), "mmHg"),
    }
    runs = runs_dataset(space, designs, {key: kinds[key] for key in outputs}, failed or {})
    content = Content(name=name, about="How hard does the bandage press?", space=space, runs=runs)
    content = _with_results(content, surrogates, outputs, sensitivity, refused)
    return _screened(content) if screened else content


def _screened(content: Content) -> Content:
    """With the decision that the made-up indices lead to."""
    best = {output: content.fits_of(output)[content.best(output)] for output in content.outputs}
    decision = decide(
        content.sensitivity, 0.05, fits=best, space=content.space, samples=256, draws=10, seed=1
    )
    return replace(content, screening=decision, reduced_study="study: made_up_reduced\n")


def _with_results(content: Content, surrogates, outputs, sensitivity, refused) -> Content:
    methods = {"linear": Linear, "interactions": Interactions, "quadratic": Quadratic}
    trained = content.ok & (content.words("design") == "train")
    held = content.ok & (content.words("design") == "test")
    if not trained.any():
        return replace(content, fits={name: {} for name in surrogates})
    fits = {
        name: {
            output: fitting.fit(
                content.space,
                content.coded[trained],
                content.values(output)[trained],
                methods[name](),
                surrogate=name,
                output=output,
            )
            for output in outputs
        }
        for name in surrogates
    }
    tests = {output: (content.coded[held], content.values(output)[held]) for output in outputs}
    tables = {
        name: {
            output: fit.estimator.regression_table(deterministic=True)
            for output, fit in by_output.items()
            if hasattr(fit.estimator, "regression_table")
        }
        for name, by_output in fits.items()
    }
    found = aliasing(content.space, content.coded[trained])
    return replace(
        content,
        fits=fits,
        comparison=compare(fits, tests),
        regression=tables,
        aliasing={} if found is None else {"train": found},
        sensitivity=sensitivity_dataset(content.space, outputs, refused) if sensitivity else None,
    )


def with_fewer_runs(content: Content, runs: int) -> Content:
    """The same with its linear surrogate of `pressure_b1` fitted to its first runs only."""
    fit = content.fits["linear"]["pressure_b1"]
    names = {"surrogate": "linear", "output": "pressure_b1"}
    fewer = fitting.fit(content.space, fit.coded[:runs], fit.values[:runs], Linear(), **names)
    return replace(content, fits={**content.fits, "linear": {"pressure_b1": fewer}})


def table_of_beams() -> str:
    """A CSV of 25 measured beams with dates, an empty answer and two materials; no noise."""
    rows = ["run,load [N],length (m),material,deflection,measured"]
    for k in range(25):
        load, length = 10.0 + 10.0 * (k % 5), 1.0 + 0.25 * (k // 5)
        material = ("steel", "brass")[k % 2]
        deflection = load * length**3 / (2.0 if material == "brass" else 4.2)
        answer = "" if k == 3 else f"{deflection:.6g}"
        rows.append(f"{k + 1},{load},{length},{material},{answer},2024-03-{k + 1:02d}")
    return "\n".join(rows) + "\n"
