"""The entries of `levels:`: the same question, answered at different cost."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from surrogate.study.parts.part import Part
from surrogate.study.parts.values import Duration


class LevelPart(Part):
    """A level of fidelity: options of the study's solver, or another solver."""

    solver: str | None = Field(
        None,
        description="Another solver than the study's. It is called with those inputs that it "
        "takes.",
        examples=["laplace"],
    )
    options: dict[str, Any] = Field(
        {},
        description="Options of that solver; of the study's own solver they come before those "
        "under solver.",
        examples=[{"mesh": "coarse"}],
    )
    seconds: Duration = Field(
        None,
        description="What a run of it counts for adaptive designs. Default: the time that its runs "
        "have taken.",
        examples=["5 s"],
    )
