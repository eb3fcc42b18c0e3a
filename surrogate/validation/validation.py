"""Validation: surrogates, and other models, beside cases that they have never seen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr

from surrogate.execution.answers import evaluate
from surrogate.fitting.fit import Fit
from surrogate.runs.identity import RunInputs, SolverSpec, run_inputs
from surrogate.solver import Solver
from surrogate.space import units
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.space import Parameter, Space
from surrogate.validation.agreement import FIGURES, agreement
from surrogate.validation.cases import Cases

CONFIDENCE = 0.95
DEFINITIONS = (
    "slope: regression through the origin, reference on x, model on y; r2: 1 - SSE / SST of the "
    "model as it stands; r2_correlation: squared correlation; errors: model minus reference; "
    "limits of agreement: bias -+ 1.96 sd"
)


@dataclass(frozen=True)
class Fixed:
    """An input that a study does not vary; `stated` when the study names it a constant."""

    value: float | str
    unit: str
    stated: bool


def fixed_inputs(solver: Solver, space: Space, constants: Mapping[str, Any]) -> dict[str, Fixed]:
    """All inputs of the study's solver that are no parameters: constants and nominal values."""
    return {
        name: Fixed(constants.get(name, one.nominal), one.unit, name in constants)
        for name, one in solver.inputs.items()
        if name not in space.names and (name in constants or one.nominal is not None)
    }


@dataclass(frozen=True)
class Validation:
    """The entry `validation:`.

    cases      the cases, or None when they are the runs of `reference`
    reference  another study whose runs are the cases
    outputs    which outputs are compared; empty for all that the cases have
    subject    the column that tells who a case was measured on; None for `subject`, if any
    models     other solvers, by name
    """

    cases: Cases | None = None
    reference: Any = None
    outputs: tuple[str, ...] = ()
    subject: str | None = None
    models: Mapping[str, SolverSpec] = field(default_factory=dict)


def outputs_in(cases: Cases, offered: Mapping[str, Any], wanted: Iterable[str]) -> tuple[str, ...]:
    """The scalar outputs to compare: those wanted, or all offered that the cases have."""
    return tuple(wanted) or tuple(
        name for name, output in offered.items() if name in cases.columns and not output.dims
    )


def validate(
    space: Space,
    fits: Mapping[str, Mapping[str, Fit]],
    cases: Cases,
    outputs: Mapping[str, str],
    models: Mapping[str, SolverSpec] | None = None,
    fixed: Mapping[str, Fixed] | None = None,
) -> xr.Dataset:
    """Every surrogate and model beside the cases.

    outputs    name -> unit
    models     called on the cases' columns, else on the study's constants, else on their
               own nominal values
    fixed      what the study does not vary
    Cases outside of the parameters' ranges are set aside: nobody predicts them, and no
    figure is drawn from them; `inside` and `outside` tell which they are, and why.

    Dimensions `case`, `output`, `model`, and a variable for each of
    `surrogate.validation.agreement.FIGURES`. Raises `StudyError` for cells that are not understood.
    """
    columns = cases.inputs({p.name: p for p in space.parameters})
    why = outside(space.parameters, columns)
    inside = np.array([not words for words in why])
    reference = {name: cases.numbers(name, unit, gaps=True) for name, unit in outputs.items()}
    answers: dict[str, dict[str, np.ndarray]] = {}
    notes = varied(cases, space, fixed or {}, "error of the surrogates")
    if inside.any():
        coded = space.encode({name: values[inside] for name, values in columns.items()})
        answers = {
            name: {output: _of_fit(by[output], coded, inside) for output in outputs if output in by}
            for name, by in fits.items()
        }
    for name, spec in (models or {}).items():
        answers[name], said = _of_model(spec, cases, inside, outputs, fixed or {})
        notes += [f"{name}: {words}" for words in said]
    answers = {name: by for name, by in answers.items() if by}
    return _dataset(cases, columns, outputs, reference, answers, inside, why, notes, space)


def outside(parameters: Iterable[Parameter], columns: Mapping[str, np.ndarray]) -> list[str]:
    """Why each case lies outside of the parameters' ranges, "" when it does not."""
    why: list[list[str]] = [[] for _ in next(iter(columns.values()))]
    for parameter in parameters:
        for words, value in zip(why, columns[parameter.name], strict=True):
            if not _within(parameter, value):
                words.append(_off(parameter, value))
    return ["; ".join(words) for words in why]


def _within(parameter: Parameter, value: Any) -> bool:
    if parameter.categorical:
        return value in parameter.levels
    law = parameter.distribution
    if isinstance(law, DiscreteLaw):
        return bool(law.allows(value))
    return bool(np.abs(parameter.encode(value)) <= 1.0 + 1e-9)


def _off(parameter: Parameter, value: Any) -> str:
    if parameter.distribution is None:
        return f"{parameter.name} {value} (not {', '.join(parameter.levels)})"
    if isinstance(parameter.distribution, DiscreteLaw):
        return f"{parameter.name} {value:.4g} {parameter.unit} (not {parameter.distribution})"
    low, high = parameter.distribution.support
    return f"{parameter.name} {value:.4g} {parameter.unit}".rstrip() + f" ({low:.4g} to {high:.4g})"


def _of_fit(fit: Fit, coded: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Value, lower and upper end of the 95 % interval (3, case); NaN outside."""
    found = np.full((3, len(inside)), np.nan)
    found[:, inside] = fit.predict(coded), *fit.interval(coded, CONFIDENCE)
    return found


def _of_model(
    spec: SolverSpec,
    cases: Cases,
    inside: np.ndarray,
    outputs: Mapping[str, str],
    fixed: Mapping[str, Fixed],
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Values of each output that the model has, as (3, case), and what went wrong."""
    columns = cases.inputs(spec.solver.inputs)
    kept = constants_for(spec, fixed, columns)
    offered = spec.solver.outputs
    wanted = {n: offered[n] for n in outputs if n in offered and not offered[n].dims}
    values = {name: np.full((3, len(cases.places)), np.nan) for name in wanted}
    refused: list[str] = []
    asked = _calls(spec, columns, kept, len(cases.places))
    for k in np.flatnonzero(inside):
        answer = evaluate(spec.solver, asked[k], wanted)  # a failure costs its case, no more
        if answer.status != "ok":
            refused.append(f"{cases.labels[k]} ({answer.message})")
        for name, value in answer.outputs.items():
            convert = units.conversion(offered[name].unit, outputs[name])
            values[name][0, k] = convert.place(value)
    return values, [f"no answer for case {', '.join(refused)}"] if refused else []


def constants_for(
    spec: SolverSpec, fixed: Mapping[str, Fixed], columns: Iterable[str]
) -> dict[str, float | str]:
    """The study's constants that a model takes and the cases do not give, in its units."""
    inputs = spec.solver.inputs
    return {
        name: one.value
        if isinstance(one.value, str)
        else units.conversion(one.unit, inputs[name].unit).place(one.value)
        for name, one in fixed.items()
        if one.stated and name in inputs and name not in columns
    }


def varied(cases: Cases, space: Space, fixed: Mapping[str, Fixed], counts: str) -> list[str]:
    """A sentence for each input that the study fixes and the cases have elsewhere.

    counts: as what its effect counts.
    """
    said = []
    for name, one in fixed.items():
        if name not in cases.columns:
            continue
        there, here = (
            _levels(cases, name, one.value)
            if isinstance(one.value, str)
            else _ends(cases, name, one.value, one.unit)
        )
        if there:
            said.append(
                f"the cases have {name} {there}; the study fixes it at {here}, so what it "
                f"changes counts as {counts}"
            )
    return said


def _levels(cases: Cases, name: str, fixed: str) -> tuple[str, str]:
    """Levels that the cases have besides the fixed one, "" when there are none, and that one."""
    return ", ".join(sorted({*cases.words(name)} - {fixed, ""})), fixed


def _ends(cases: Cases, name: str, fixed: float, unit: str) -> tuple[str, str]:
    """The range that the cases have, "" when it is the fixed value, and that value."""
    values = cases.numbers(name, unit, gaps=True)
    ends = (
        dict.fromkeys(f"{end(values):.4g}" for end in (np.nanmin, np.nanmax))
        if not np.allclose(values[np.isfinite(values)], fixed, rtol=1e-9)
        else ()
    )
    return f"{' to '.join(ends)} {unit}".strip() if ends else "", f"{fixed:.4g}"


def _calls(
    spec: SolverSpec,
    columns: Mapping[str, np.ndarray],
    constants: Mapping[str, float | str],
    count: int,
) -> list[RunInputs]:
    """The model's arguments for each case; the same ones when it takes no column at all."""
    if columns:
        return run_inputs(spec, columns, constants)
    nominal = {
        name: one.nominal
        for name, one in spec.solver.inputs.items()
        if one.nominal is not None and name not in constants
    }
    return [{**nominal, **constants}] * count


def _dataset(
    cases: Cases,
    columns: Mapping[str, np.ndarray],
    outputs: Mapping[str, str],
    reference: Mapping[str, np.ndarray],
    answers: Mapping[str, Mapping[str, np.ndarray]],
    inside: np.ndarray,
    why: list[str],
    notes: list[str],
    space: Space,
) -> xr.Dataset:
    names, dims = list(answers), ("model", "output")
    shape = (len(names), len(outputs))
    predicted = np.full((3, *shape, len(cases.places)), np.nan)
    figures = {name: np.full(shape, np.nan) for name in (*FIGURES, "coverage_95")}
    for j, output in enumerate(outputs):
        for i, name in enumerate(names):
            if output not in answers[name]:
                continue
            predicted[:, i, j] = answers[name][output]
            seen = np.where(inside, predicted[0, i, j], np.nan)
            for key, value in agreement(reference[output], seen, cases.subjects).items():
                figures[key][i, j] = value
            figures["coverage_95"][i, j] = _coverage(reference[output], *predicted[1:, i, j])
    variables: dict[str, tuple[Any, ...]] = {
        "reference": (("output", "case"), np.array([reference[name] for name in outputs])),
        "prediction": ((*dims, "case"), predicted[0]),
        "low": ((*dims, "case"), predicted[1], {"long_name": "lower end of the 95 % interval"}),
        "high": ((*dims, "case"), predicted[2], {"long_name": "upper end of the 95 % interval"}),
        "units": ("output", np.array(list(outputs.values()), dtype=str)),
        "inside": ("case", inside, {"long_name": "inside of the ranges of the parameters"}),
        "outside": ("case", np.array(why, dtype=str), {"long_name": "what lies outside"}),
        "coverage_95": (
            dims,
            figures.pop("coverage_95"),
            {"long_name": "share of the reference values inside the 95 % intervals"},
        ),
        **{
            name: (dims, values, {"long_name": FIGURES[name][0]})
            for name, values in figures.items()
        },
    }
    if cases.subjects is not None:
        variables["subject"] = ("case", cases.words("subject"))
    variables |= {
        f"at_{name}": (
            "case",
            values,
            {"long_name": space[name].description or name, "units": space[name].unit},
        )
        for name, values in columns.items()
    }
    return xr.Dataset(
        variables,
        {"model": names, "output": list(outputs), "case": np.array(cases.labels, dtype=str)},
        {
            "cases": cases.name,
            "definitions": DEFINITIONS,
            "notes": "\n".join(notes),
            "confidence": CONFIDENCE,
        },
    )


def _coverage(reference: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    known = np.isfinite(reference) & np.isfinite(low) & np.isfinite(high)
    held = (low <= reference) & (reference <= high)
    return float(held[known].mean()) if known.any() else np.nan
