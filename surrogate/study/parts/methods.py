"""Designs, surrogates, and what is asked of them: a method and its options each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field, model_validator

from surrogate.fitting.best import BEST
from surrogate.study.parts.inputs import SolverPart
from surrogate.study.parts.part import MethodPart, OpenPart, Part
from surrogate.study.parts.values import Name, Texts


class AugmentPart(MethodPart):
    """Points added to a design."""

    method: str = Field(
        description="An augmentation that `surrogate list` shows; its options stand beside it.",
        examples=["fold_over", "center_points", "axial_points"],
    )


class DesignPart(OpenPart):
    """Where to run the solver: a method and its options."""

    method: str = Field(
        description="A design that `surrogate list` shows, or module:function; its options "
        "stand beside it.",
        examples=["latin_hypercube", "fractional_factorial"],
    )
    augment: tuple[AugmentPart, ...] = Field(
        (),
        description="Points to add, step by step; runs of the points before are kept.",
        examples=[["fold_over", {"method": "center_points", "runs": 3}]],
    )


class SurrogatePart(Part):
    """A cheap model: a regressor and its options."""

    method: str = Field(
        description="A regressor that `surrogate list` shows, or module:Class of a regressor of "
        "scikit-learn's kind.",
        examples=["gaussian_process", "sklearn.ensemble:RandomForestRegressor"],
    )
    options: dict[str, Any] = Field(
        {}, description="Options of that regressor.", examples=[{"n_estimators": 300}]
    )
    train: tuple[str, ...] = Field(
        ("train",),
        min_length=1,
        description="Its training designs: one name, or a list.",
        examples=[["screening", "foldover"]],
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        if isinstance(value, str):
            return {"method": value}
        if isinstance(value, Mapping) and isinstance(value.get("train"), str):
            return {**value, "train": [value["train"]]}
        return value


class SensitivityPart(MethodPart):
    """Which parameters matter, read from a surrogate."""

    method: str = Field(
        "sobol",
        description="A sensitivity method that `surrogate list` shows; its options stand beside "
        "it. Default: sobol, of correlated parameters shapley.",
        examples=["sobol", "shapley"],
    )
    surrogate: str = Field(
        BEST,
        description="The surrogate that is evaluated: its name, or best for the best of the "
        "comparison.",
        examples=["gp"],
    )
    confidence: float = Field(
        0.95, gt=0, lt=1, description="Confidence of the intervals of the indices.", examples=[0.9]
    )
    groups: dict[Name, tuple[str, ...]] = Field(
        {},
        description="Parameters whose share of the variance is asked for as a whole.",
        examples=[{"material": ["young", "poisson"]}],
    )


class ScreeningPart(Part):
    """Freeze a parameter when its total index (or Shapley effect) is surely below a limit."""

    freeze_below: float = Field(
        0.02,
        gt=0,
        lt=1,
        description="The limit: a share of the output's variance.",
        examples=[0.05],
    )
    outputs: Texts = Field(
        (),
        description="Outputs that vote: a parameter is frozen when it "
        "hardly moves any of them. Default: all of the study's.",
        examples=[["pressure_b1"]],
    )


class ValidationPart(Part):
    """Cases that no surrogate has seen, and other models to set beside the surrogates."""

    cases: str = Field(
        description="Measurements (.csv), runs (.nc), or another study (.yaml), relative to the "
        "study file.",
        examples=["measured.csv"],
    )
    output: Texts = Field(
        (),
        description="Outputs to compare. Default: every scalar output that the cases have.",
        examples=["tip"],
    )
    subject: str | None = Field(
        None,
        description="Column that tells who a case was measured on, "
        "when one has several. Default: the column 'subject', if any.",
        examples=["patient"],
    )
    models: dict[Name, SolverPart] = Field(
        {},
        description="Other solvers, called on the columns of the cases that they take as inputs.",
        examples=[{"laplace": {"name": "laplace"}}],
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"cases": value} if isinstance(value, str) else value
