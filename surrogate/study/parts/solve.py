"""The part `solve:` of a study file: goals, limits, and what may be chosen."""

from __future__ import annotations

from typing import Any

from pydantic import Field, model_validator

from surrogate.fitting.best import BEST
from surrogate.study.parts.part import Part
from surrogate.study.parts.values import Name, Number, Texts

#: A number in the output's unit, or a text with a unit.
Quantity = Number | str


class TargetPart(Part):
    """A value that an output is to hit."""

    value: Quantity | None = Field(
        None,
        description="The value to hit, in the output's unit or with one.",
        examples=["40 mmHg", 40],
    )
    within: Quantity | None = Field(
        None,
        description="How far from the value still counts as hit. Default: 5 % of the range that "
        "the output spans in the runs.",
        examples=["2 mmHg"],
    )
    range: tuple[Quantity, Quantity] | None = Field(
        None, description="In place of value: smallest and largest.", examples=[[38, 42]]
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, given: Any) -> Any:
        if isinstance(given, list | tuple):
            return {"range": given}
        return given if isinstance(given, dict) else {"value": given}

    @model_validator(mode="after")
    def _one_of_two(self) -> TargetPart:
        if (self.value is None) == (self.range is None):
            raise ValueError("give either value (and within) or range")
        if self.range is not None and self.within is not None:
            raise ValueError("within goes with value, not with range")
        return self


class DesirePart(Part):
    """How much a value of an output is worth, from 0 to 1 (Derringer and Suich 1980)."""

    maximise: tuple[Quantity, Quantity] | None = Field(
        None,
        description="Worthless below the first value, perfect from the second.",
        examples=[[60, 95]],
    )
    minimise: tuple[Quantity, Quantity] | None = Field(
        None,
        description="Perfect up to the first value, worthless above the second.",
        examples=[[10, 30]],
    )
    target: tuple[Quantity, Quantity, Quantity] | None = Field(
        None,
        description="Worthless outside of the first and last value, perfect at the middle one.",
        examples=[[35, 40, 45]],
    )
    exponent: float = Field(
        1.0, gt=0, description="Above 1: only good values are worth much.", examples=[2]
    )
    importance: float = Field(
        1.0, gt=0, description="Weight of this output among the others.", examples=[3]
    )

    @model_validator(mode="after")
    def _one_of_three(self) -> DesirePart:
        if sum(one is not None for one in (self.maximise, self.minimise, self.target)) != 1:
            raise ValueError("give one of maximise, minimise and target")
        return self


class SolvePart(Part):
    """Inputs that reach a goal."""

    target: dict[Name, TargetPart] = Field(
        {},
        description="Outputs with the value that each is to hit.",
        examples=[{"pressure_b1": "40 mmHg"}],
    )
    minimise: Texts = Field((), description="Outputs to be as small as can be.", examples=["mass"])
    maximise: Texts = Field(
        (), description="Outputs to be as large as can be.", examples=[["stiffness"]]
    )
    desirability: dict[Name, DesirePart] = Field(
        {},
        description="Outputs with what their values are worth.",
        examples=[{"yield": {"maximise": [60, 95]}, "cost": {"minimise": [10, 30]}}],
    )
    subject_to: Texts = Field(
        (),
        description="Inequalities between outputs, inputs and numbers that the answer must keep.",
        examples=[["stress <= 250 MPa"]],
    )
    free: Texts = Field(
        (),
        description="Parameters to choose; the others are held at their nominal value, or at the "
        "middle of their range. Default: all that are neither uncertain nor fixed.",
        examples=[["stretch", "overlap"]],
    )
    uncertain: Texts = Field(
        (),
        description="Parameters that nobody controls; they follow the study's distributions.",
        examples=[["mu_skin", "leg_length"]],
    )
    fix: dict[Name, Quantity] = Field(
        {}, description="Parameters that are held at a value.", examples=[{"mu_skin": 0.2}]
    )
    probability: float | None = Field(
        None,
        gt=0,
        lt=1,
        description="How surely the solver is to meet goal and limits. Default: limits with 0.9, "
        "and objectives by their mean.",
        examples=[0.9],
    )
    candidates: int = Field(5, ge=1, le=50, description="How many answers at most.", examples=[3])
    surrogate: str = Field(
        BEST, description="A surrogate's name, or best of each output.", examples=["gp"]
    )

    @model_validator(mode="after")
    def _one_kind(self) -> SolvePart:
        kinds = [bool(self.target), bool(self.minimise or self.maximise), bool(self.desirability)]
        if sum(kinds) > 1:
            raise ValueError(
                "give one of target, minimise or maximise, and desirability; what must hold "
                "besides goes into subject_to"
            )
        if not any(kinds) and not self.subject_to:
            raise ValueError(
                "says no goal; give target, minimise, maximise, desirability or subject_to"
            )
        return self
