"""The part of a study file that is an adaptive design."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from surrogate.adaptive.aim import FIGURES, NAMES
from surrogate.study.parts.methods import DesignPart
from surrogate.study.parts.part import Part
from surrogate.study.parts.solve import Quantity
from surrogate.study.parts.values import Duration, Name, Texts

#: The word that tells an adaptive design from the others.
ADAPTIVE = "adaptive"
#: Aim -> the keys that go with it; of those of `optimum` and `probability` one is needed.
BELONGING = {
    "accuracy": ("output",),
    "index_width": ("output",),
    "optimum": ("minimise", "maximise"),
    "target": ("target",),
    "probability": ("output", "above", "below"),
}
Share = Annotated[float, Field(gt=0, lt=1)]


class AdaptiveUntilPart(Part):
    """When the design ends."""

    runs: int | None = Field(
        None,
        ge=1,
        description="Most runs, the initial design included; this or seconds is needed.",
        examples=[120],
    )
    seconds: Duration = Field(
        None,
        description="Most time of the solver, of all runs together, the initial ones included.",
        examples=["2 h"],
    )
    q2: Share | None = Field(
        None, description="accuracy: Q2 of left-out runs of the design.", examples=[0.99]
    )
    rmse: Quantity | None = Field(
        None,
        description="accuracy: RMSE of left-out runs, in the output's unit or with one.",
        examples=["0.4 mmHg"],
    )
    width: Share | None = Field(
        None,
        description="index_width: width of the widest interval of a total index.",
        examples=[0.05],
    )
    gain: Quantity | None = Field(
        None,
        description="optimum: largest expected improvement of a further run, in the output's unit "
        "or with one.",
        examples=["0.1 kg"],
    )
    unsure: Share | None = Field(
        None,
        description="target, probability: share of the space, by the parameters' law, where the "
        "side of the value is unsure.",
        examples=[0.01],
    )
    patience: int | None = Field(
        None,
        ge=1,
        description="End after so many runs in which the figure did not improve by 5 %. Default: "
        "never.",
        examples=[30],
    )


class AdaptivePart(Part):
    """A design whose next points follow from the answers so far."""

    method: Literal["adaptive"] = Field(
        description="Points follow from the answers so far.", examples=["adaptive"]
    )
    initial: DesignPart = Field(
        description="The runs to begin with: a design.",
        examples=[{"method": "latin_hypercube", "runs": 20}],
    )
    aim: Literal["accuracy", "index_width", "optimum", "target", "probability"] = Field(
        description="What the runs are for.", examples=["index_width"]
    )
    output: Texts = Field(
        (),
        description="accuracy, index_width: outputs that count; default: all that are single "
        "numbers. probability: the output with the limit.",
        examples=["stress"],
    )
    minimise: Name | None = Field(
        None, description="optimum: output to be as small as can be.", examples=["mass"]
    )
    maximise: Name | None = Field(
        None, description="optimum: output to be as large as can be.", examples=["stiffness"]
    )
    target: dict[Name, Quantity] = Field(
        {},
        description="target: an output and the value whose contour is looked for.",
        examples=[{"pressure_b1": "40 mmHg"}],
    )
    above: Quantity | None = Field(
        None, description="probability: of an output above this limit.", examples=["250 MPa"]
    )
    below: Quantity | None = Field(
        None, description="probability: of an output below this limit.", examples=[5]
    )
    until: AdaptiveUntilPart = Field(
        description="When it ends: most runs, and a figure that depends on the aim.",
        examples=[{"width": 0.05, "runs": 120}],
    )
    batch: int | None = Field(
        None,
        ge=1,
        description="Points that are chosen together, and done before the next ones are: the same "
        "points whatever the number of workers. Default: a point as soon as a place is free.",
        examples=[4],
    )
    seed: int | None = Field(
        None, description="Seed of the choice. Default: by the name.", examples=[1]
    )

    @model_validator(mode="after")
    def _goes_together(self) -> AdaptivePart:
        words: dict[str, Any] = {
            key: getattr(self, key)
            for key in ("output", "minimise", "maximise", "target", "above", "below")
        }
        given = [key for key, value in words.items() if value not in (None, (), {})]
        allowed = BELONGING[self.aim]
        wrong = [key for key in given if key not in allowed]
        if wrong:
            raise ValueError(
                f"aim {self.aim} does not take {wrong[0]}; it takes {' or '.join(allowed)}"
            )
        if self.until.runs is None and self.until.seconds is None:
            raise ValueError("until: give runs: 120, or seconds: 2 h, or both")
        if self.aim == "optimum" and len(given) != 1:
            raise ValueError("aim optimum needs one of minimise: OUTPUT and maximise: OUTPUT")
        if self.aim == "target" and len(self.target) != 1:
            raise ValueError("aim target needs one output with its value, target: {OUTPUT: VALUE}")
        if self.aim == "probability" and (
            len(self.output) != 1 or (self.above is None) == (self.below is None)
        ):
            raise ValueError("aim probability needs output: OUTPUT and one of above and below")
        until = self.until
        named = [key for key in NAMES if getattr(until, key) is not None]
        unfit = [key for key in named if key not in FIGURES[self.aim]]
        if unfit:
            raise ValueError(
                f"until: {unfit[0]} is not judged for aim {self.aim}; give "
                f"{' or '.join(FIGURES[self.aim])}"
            )
        if len(named) > 1:
            raise ValueError(f"until: give one of {' and '.join(named)}")
        return self
