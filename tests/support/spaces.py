"""Spaces that tests of several chapters share."""

from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

LETTERS = "ABCDEFGHJKLMNOPQRSTUVWXYZ"


def cube(k):
    """k uniform parameters A, B, .. (p0, p1, .. beyond 25)."""
    names = LETTERS[:k] if k <= len(LETTERS) else [f"p{i}" for i in range(k)]
    return Space(
        tuple(
            Parameter(name, uniform(2.0 + i, 5.0 + 2 * i), unit="mm")
            for i, name in enumerate(names)
        )
    )


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
