"""What designs will tell about polynomials before anything is run, as the command prints it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surrogate.cli.table import Table
from surrogate.designs.design import Design
from surrogate.designs.model import MODELS, Model
from surrogate.errors import StudyError
from surrogate.fitting.precision import ALPHA, Precision, precision
from surrogate.study.study import Study

ORDERS = {1: "main effects", 2: "interactions and squares", 3: "higher terms"}
#: Sentences about what cannot be told apart that are printed.
LISTED = 8


def foreseen(study: Study, model: str | None, effect: float) -> dict[str, Precision]:
    """Precision of each polynomial surrogate on its training designs, by `surrogate of designs`.

    model: instead, of that model on every design; linear, interactions, quadratic or terms
    such as 'a, b, a:b'. Designs whose points are not found yet are left out, and of levels
    of fidelity all but the truth, which polynomials learn from. Raises
    `StudyError` when the model names what is not there.
    """
    if not effect > 0:
        raise StudyError(f"--effect: {effect:g} must be above 0")
    if model is None:
        asked: list[tuple[str | Sequence[str], tuple[str, ...]]] = [
            (one.method, one.train) for one in study.surrogates.values() if one.method in MODELS
        ]
    else:
        listed = [word.strip() for word in model.split(",")]
        asked = [
            (model if model in MODELS else listed, (name,))
            for name in study.designs
            if name != "test"
        ]
    found = {}
    for words, names in asked:
        designs = [study.designs[name] for name in names]
        if all(design.at_hand for design in designs):
            said = words if isinstance(words, str) else model
            found[f"{said} from {' + '.join(names)}"] = _of(study, words, designs, effect)
    return found


def _of(
    study: Study, words: str | Sequence[str], designs: Sequence[Design], effect: float
) -> Precision:
    coded = np.vstack([design.truth for design in designs])
    return precision(Model(study.space, words), coded, effect)


def pages(found: Mapping[str, Precision], effect: float) -> list[str | Table]:
    """A table for each, a row for the terms of an order; and what cannot be told apart."""
    parts: list[str | Table] = []
    for name, one in found.items():
        title = f"{name}: {one.runs} runs, {one.freedom} degrees of freedom for the error"
        headings = ("terms", "number", "standard error", "VIF", f"power, effect {effect:g}")
        parts += [Table(title, headings, [*_rows(one)]), *_confounded(one), ""]
    if found:
        parts.append(
            "standard error of a coefficient and effect (low to high end) in standard deviations "
            f"of the error; power: chance that a t-test at {ALPHA:.0%} finds the effect\n"
        )
    return parts


def _rows(one: Precision) -> list[tuple[Any, ...]]:
    orders = np.array([min(order, 3) for _, order in one.terms])
    return [
        (
            said,
            int((orders == order).sum()),
            *(_range(values[orders == order]) for values in (one.error, one.inflation)),
            _range(one.power[orders == order]) if one.freedom else "no error to test with",
        )
        for order, said in ORDERS.items()
        if (orders == order).any()
    ]


def _range(values: np.ndarray) -> str:
    low, high = f"{values.min():.2g}", f"{values.max():.2g}"
    return low if low == high else f"{low} to {high}"


def _confounded(one: Precision) -> list[str]:
    if not one.confounded:
        return []
    more = len(one.confounded) - LISTED
    listed = "; ".join(one.confounded[:LISTED]) + (f"; {more} more" if more > 0 else "")
    return [f"cannot be told apart: {listed}"]


def data(found: Mapping[str, Precision]) -> dict[str, Any]:
    """The same for `--json`, a figure a term."""
    return {
        name: {
            "runs": one.runs,
            "degrees_of_freedom": one.freedom,
            "terms": [term for term, _ in one.terms],
            "standard_error": one.error.tolist(),
            "vif": one.inflation.tolist(),
            "power": [None if np.isnan(value) else float(value) for value in one.power],
            "confounded": list(one.confounded),
        }
        for name, one in found.items()
    }
