"""A study file as a whole."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag

from surrogate.fitting.best import BEST
from surrogate.study.parts.adaptive import ADAPTIVE, AdaptivePart
from surrogate.study.parts.calibration import CalibrationPart
from surrogate.study.parts.credibility import CredibilityPart
from surrogate.study.parts.data import DataPart
from surrogate.study.parts.execution import ExecutionPart
from surrogate.study.parts.inputs import ConstantPart, ParameterPart, SolverPart
from surrogate.study.parts.learning import LearningPart
from surrogate.study.parts.levels import LevelPart
from surrogate.study.parts.methods import (
    DesignPart,
    ScreeningPart,
    SensitivityPart,
    SurrogatePart,
    ValidationPart,
)
from surrogate.study.parts.part import Part
from surrogate.study.parts.reliability import ReliabilityPart
from surrogate.study.parts.solve import SolvePart
from surrogate.study.parts.values import Name, Texts


def _asked(value: Any) -> Any:
    return {} if value is None else value


def _kind_of_design(value: Any) -> str:
    method = value.get("method") if isinstance(value, dict) else getattr(value, "method", None)
    return ADAPTIVE if method == ADAPTIVE else GIVEN


#: Tags of designs: points that follow from answers, and points that do not.
GIVEN = "given"
KINDS_OF_DESIGN = (ADAPTIVE, GIVEN)
AnyDesign = Annotated[
    Annotated[DesignPart, Tag(GIVEN)] | Annotated[AdaptivePart, Tag(ADAPTIVE)],
    Discriminator(_kind_of_design),
]


class StudyPart(Part):
    """A study file."""

    study: Name = Field(
        description="Name of the study; results go to results/<study>/.", examples=["beam"]
    )
    about: str = Field(
        "",
        description="What is asked, in a sentence for the report.",
        examples=["Which parameters drive the deflection, and which may be frozen?"],
    )
    solver: SolverPart | None = Field(
        None,
        description="The simulation to run: a name, or a name with options.",
        examples=["borehole", {"name": "my_beam:Beam"}],
    )
    data: DataPart | None = Field(
        None,
        description="Runs that are done, in a table: in place of a solver, or beside it.",
        examples=["tests.csv", {"file": "tests.csv", "outputs": ["strength"]}],
    )
    parameters: dict[Name, ParameterPart] = Field(
        {},
        description="Inputs that vary, each with its range, law, values or levels. Every other "
        "input keeps the solver's nominal value. With data, every other column by default.",
        examples=[{"load": {"range": [10, 90], "unit": "N"}, "length": [0.5, 2]}],
    )
    correlation: tuple[tuple[str, str, Annotated[float, Field(gt=-1, lt=1)]], ...] = Field(
        (),
        description="[name, name, correlation] of dependent parameters (Gaussian copula). An "
        "empty list takes the columns of data as independent.",
        examples=[[["speed", "feed", -0.4]]],
    )
    constraints: Texts = Field(
        (),
        description="Inequalities such as 'width + 2*gap <= 80 mm', or mixtures such as "
        "'a + b + c = 1', that all points keep.",
        examples=[["width + 2*gap <= 80 mm"]],
    )
    constants: dict[Name, ConstantPart] = Field(
        {},
        description="Inputs that do not vary but differ from the solver's nominal value.",
        examples=[{"young": {"value": 70, "unit": "GPa"}, "poisson": 0.33}],
    )
    outputs: tuple[str, ...] | None = Field(
        None,
        description="Outputs that are analysed. Default: all of the solver's.",
        examples=[["peak_stress"]],
    )
    levels: dict[Name, LevelPart] = Field(
        {},
        description="Levels of fidelity, cheapest first; the last is the truth, of which all "
        "results speak. A nested design runs them, the surrogate cokriging learns from all.",
        examples=[
            {"cheap": {"options": {"mesh": "coarse"}}, "true": {"options": {"mesh": "fine"}}}
        ],
    )
    designs: dict[Name, AnyDesign] = Field(
        {},
        description="Where to run the solver. Surrogates learn from the design train, unless "
        "they name others; test is held out.",
        examples=[
            {
                "train": {"method": "latin_hypercube", "runs": 40, "seed": 1},
                "test": {"method": "latin_hypercube", "runs": 20, "seed": 7},
            }
        ],
    )
    replicates: int = Field(
        1,
        ge=1,
        description="Runs at every point, of a solver that is not deterministic.",
        examples=[5],
    )
    surrogates: dict[Name, SurrogatePart] = Field(
        {},
        description="Cheap models that are fitted and compared: a method, or a method with "
        "options.",
        examples=[{"quadratic": "quadratic", "gp": {"method": "gaussian_process"}}],
    )
    sensitivity: SensitivityPart | None = Field(
        None,
        description="How the indices are computed that say which parameters matter: a method, or "
        "a method with options.",
        examples=["sobol", {"method": "sobol", "surrogate": BEST}],
    )
    screening: ScreeningPart | None = Field(
        None,
        description="Which parameters may be frozen; the reduced study is written.",
        examples=[{"freeze_below": 0.02}],
    )
    learning: Annotated[
        LearningPart | None,
        BeforeValidator(_asked, json_schema_input_type=LearningPart | None),
    ] = Field(
        None,
        description="Learning curves: the error against the number of runs, what doubling them "
        "would bring, and how many a goal needs. The word alone asks for them without a goal.",
        examples=[{"until": {"q2": 0.99}}, {"until": {"rmse": "0.4 mmHg"}, "surrogate": "gp"}],
    )
    solve: dict[Name, SolvePart] = Field(
        {},
        description="Goals, each with a name: which inputs reach it, and how surely.",
        examples=[{"forty": {"target": {"pressure_b1": "40 mmHg"}, "probability": 0.9}}],
    )
    reliability: dict[Name, ReliabilityPart] = Field(
        {},
        description="Failures, each with a name: how probable it is that an output passes a limit.",
        examples=[{"burst": {"output": "stress", "above": "250 MPa"}}],
    )
    validation: ValidationPart | None = Field(
        None,
        description="Measurements, or a better model, that surrogates are compared with.",
        examples=["measured.csv"],
    )
    calibration: CalibrationPart | None = Field(
        None,
        description="Inputs that are learnt from measurements, with what is known of them before.",
        examples=[{"cases": "measured.csv", "free": ["tension"]}],
    )
    credibility: CredibilityPart | None = Field(
        None,
        description="What a reviewer asks and no run can tell, for `surrogate dossier`.",
        examples=[{"question": "Which bandage gives 40 mmHg?", "consequence": "low: wrap again"}],
    )
    execution: ExecutionPart = Field(
        default_factory=lambda: ExecutionPart.model_validate({}),
        description="Where the runs are carried out, how many at once, and their limits.",
        examples=[{"places": 2, "timeout": "30 min", "retries": 1}],
    )
    stored: Texts = Field(
        (),
        description="Files of runs that ship with the study "
        "(`surrogate store`), relative to the study file.",
        examples=["runs/beam.nc"],
    )
