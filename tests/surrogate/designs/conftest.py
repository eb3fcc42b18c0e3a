"""Spaces and reference numbers that the tests of designs share."""

import json
from pathlib import Path

import pytest

from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

LETTERS = "ABCDEFGHJKLMNOPQRSTUVWXYZ"


@pytest.fixture(scope="session")
def reference():
    """Published designs; see the file's provenance."""
    path = Path(__file__).parents[2] / "reference" / "fractional_factorials.json"
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def cube():
    """cube(k): k uniform parameters A, B, .. (p0, p1, .. beyond 25)."""

    def build(k):
        names = LETTERS[:k] if k <= len(LETTERS) else [f"p{i}" for i in range(k)]
        return Space(
            tuple(
                Parameter(name, uniform(2.0 + i, 5.0 + 2 * i), unit="mm")
                for i, name in enumerate(names)
            )
        )

    return build


@pytest.fixture(scope="session")
def mixed():
    """Two ranges, a two-level and a three-level categorical parameter."""
    return Space(
        (
            Parameter("tension", uniform(0.059, 0.137), unit="N/mm"),
            Parameter("bandage", levels=("biflex_16", "biflex_17")),
            Parameter("posture", levels=("lying", "sitting", "standing")),
            Parameter("mu", uniform(0.1, 0.3)),
        )
    )


@pytest.fixture(scope="session")
def unbounded():
    """One range and one normal distribution without ends."""
    return Space(
        (
            Parameter("tension", uniform(0.059, 0.137), unit="N/mm"),
            Parameter("c10", distribution("normal", mean=5.0, std=1.0), unit="kPa"),
        )
    )
