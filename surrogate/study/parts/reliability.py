"""The part `reliability:` of a study file: limits that outputs should not pass."""

from __future__ import annotations

from pydantic import Field, model_validator

from surrogate.fitting.best import BEST
from surrogate.reliability.problem import METHODS
from surrogate.study.parts.part import Part
from surrogate.study.parts.solve import Quantity
from surrogate.study.parts.values import Name


class ReliabilityPart(Part):
    """A failure whose probability is asked for."""

    output: Name = Field(..., description="The output that fails.", examples=["stress"])
    above: Quantity | None = Field(
        None,
        description="It fails above this value, in the output's unit or with one.",
        examples=["250 MPa"],
    )
    below: Quantity | None = Field(
        None, description="In place of above: it fails below this value.", examples=[1.5]
    )
    surrogate: str = Field(
        BEST, description="A surrogate's name, or best of the output.", examples=["gp"]
    )
    method: str = Field(
        "auto",
        description=f"How the probability is sampled: {', '.join(METHODS)}. Auto takes crude "
        "sampling where failures are frequent and subset simulation where they are rare.",
        examples=["subset"],
    )

    @model_validator(mode="after")
    def _one_side(self) -> ReliabilityPart:
        if (self.above is None) == (self.below is None):
            raise ValueError("give either above or below")
        return self
