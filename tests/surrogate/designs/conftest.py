"""Spaces and reference numbers that the tests of designs share."""

import json
from pathlib import Path

import pytest
import spaces

from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space


@pytest.fixture(scope="session")
def reference():
    """Published designs; see the file's provenance."""
    path = Path(__file__).parents[2] / "reference" / "fractional_factorials.json"
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def cube():
    """cube(k): k uniform parameters."""
    return spaces.cube


@pytest.fixture(scope="session")
def mixed():
    """Two ranges, a two-level and a three-level categorical parameter."""
    return spaces.mixed()


@pytest.fixture(scope="session")
def unbounded():
    """One range and one normal distribution without ends."""
    return Space(
        (
            Parameter("tension", uniform(0.059, 0.137), unit="N/mm"),
            Parameter("c10", distribution("normal", mean=5.0, std=1.0), unit="kPa"),
        )
    )
