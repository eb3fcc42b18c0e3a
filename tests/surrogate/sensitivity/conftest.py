"""Textbook functions on coded points, and exact indices to compare with."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.textbook import Borehole, Ishigami, Piston, SobolG

REFERENCE = json.loads(
    (Path(__file__).parents[2] / "reference" / "sobol_indices.json").read_text(encoding="utf-8")
)
SOLVERS = {"ishigami": Ishigami(), "sobol_g": SobolG(), "borehole": Borehole(), "piston": Piston()}


@dataclass(frozen=True)
class Case:
    """A function of coded points with its exact indices: (d,), (d,), (d, d) with NaN diagonal."""

    space: Space
    function: object
    first_order: np.ndarray
    total: np.ndarray
    second_order: np.ndarray
    facts: dict


def _array(values) -> np.ndarray:
    return np.array(list(values.values()) if isinstance(values, dict) else values)


def _case(name: str) -> Case:
    solver, facts = SOLVERS[name], REFERENCE["sobol_indices"][name]
    space = Space(
        tuple(
            Parameter(key, uniform(*given.range), unit=given.unit)
            for key, given in solver.inputs.items()
        )
    )
    output = next(iter(solver.outputs))

    def function(coded):
        return solver(**space.decode(coded))[output]

    second = np.full((space.size, space.size), np.nan)
    upper = np.triu_indices(space.size, 1)
    second[upper] = second.T[upper] = _array(facts["second_order"])
    return Case(
        space, function, _array(facts["first_order"]), _array(facts["total"]), second, facts
    )


@pytest.fixture
def textbook():
    """`textbook(name)` is the Case of ishigami, sobol_g, borehole or piston."""
    return _case


@pytest.fixture
def reference():
    """All facts of tests/reference/sobol_indices.json."""
    return REFERENCE
