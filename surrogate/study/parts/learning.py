"""The part `learning:` of a study file: whether there are enough runs."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from surrogate.fitting.best import BEST
from surrogate.study.parts.part import Part
from surrogate.study.parts.values import Number, Texts


class UntilPart(Part):
    """What the surrogate is to reach: one of three figures."""

    q2: Annotated[float, Field(gt=0, lt=1)] | None = Field(
        None, description="Q2 on runs that the surrogate has not seen.", examples=[0.99]
    )
    rmse: Number | str | None = Field(
        None,
        description="RMSE, in the output's unit or with one; of outputs with that dimension.",
        examples=["0.4 mmHg", 0.4],
    )
    index_width: Annotated[float, Field(gt=0, lt=1)] | None = Field(
        None,
        description="Width of the widest interval of a total index; needs sensitivity: sobol.",
        examples=[0.05],
    )

    @model_validator(mode="after")
    def _one_of_three(self) -> UntilPart:
        if sum(one is not None for one in (self.q2, self.rmse, self.index_width)) != 1:
            raise ValueError("give one of q2, rmse and index_width")
        return self


class LearningPart(Part):
    """Learning curves: the error against the number of runs, and how many a goal needs."""

    until: UntilPart | None = Field(
        None, description="The goal; the runs that it needs are estimated.", examples=[{"q2": 0.99}]
    )
    outputs: Texts = Field(
        (),
        description="Outputs that the goal is for. Default: all scalar ones that it fits.",
        examples=["pressure_b1"],
    )
    surrogate: str = Field(
        BEST,
        description="Whose curve: a surrogate's name, all, or best: the best one of each output, "
        "and linear and quadratic ones beside it.",
        examples=["gp"],
    )
    subsets: int = Field(20, ge=5, description="Random subsets of each size.", examples=[50])
