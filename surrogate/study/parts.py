"""The parts of a study file: which keys each has, what they mean, what kind of value each takes.

Description and example of a key go into the JSON Schema, from which editors complete and the
documentation is made. Whether names exist, units convert and ranges hold is decided in
`surrogate.study.reading`, where names become objects.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from surrogate.study.calibration_part import CalibrationPart
from surrogate.study.credibility_part import CredibilityPart
from surrogate.study.learning_part import LearningPart
from surrogate.study.part import OpenPart, Part
from surrogate.study.solve_part import SolvePart
from surrogate.study.values import Duration, Name, Number, Size, Texts, names_only


class SolverPart(Part):
    """Which simulation to run."""

    name: str = Field(
        description="One that `surrogate list` shows, or module:object beside the study.",
        examples=["borehole", "my_beam:Beam"],
    )
    options: dict[str, Any] = Field(
        {}, description="Options of that solver.", examples=[{"mesh": "coarse"}]
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"name": value} if isinstance(value, str) else value


class ParameterPart(OpenPart):
    """What varies: a range, a distribution with its words, values, or levels."""

    range: tuple[Number, Number] | None = Field(
        None, description="Smallest and largest value.", examples=[[0.1, 0.3]]
    )
    distribution: str | None = Field(
        None,
        description="uniform, normal, lognormal, triangular "
        "or a continuous scipy.stats name; its words (mean, std, ...) stand beside it, and a "
        "range truncates it. "
        "From the column of data: fit (the likeliest law), data (the values, smoothed).",
        examples=["normal", "lognormal", "fit"],
    )
    integer: bool = Field(False, description="Whole numbers of the range only.", examples=[True])
    values: tuple[Number, ...] | None = Field(
        None,
        description="The only values of an ordered quantity, such as sizes in a catalogue.",
        examples=[[10, 12, 16, 20]],
    )
    levels: Annotated[
        tuple[str, ...] | None,
        BeforeValidator(names_only, json_schema_input_type=tuple[str, ...] | None),
    ] = Field(None, description="Names, for a categorical input.", examples=[["soft", "stiff"]])
    unit: str | None = Field(
        None,
        description="Unit of the numbers here; they are converted to the solver's unit. "
        "Default: the solver's unit.",
        examples=["N/mm", "degC"],
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"range": value} if isinstance(value, list | tuple) else value


class DataOutputPart(Part):
    """A column that holds what was measured or computed."""

    unit: str | None = Field(
        None,
        description="Unit of the column. Default: that of the table's header.",
        examples=["MPa"],
    )


class DataTestPart(Part):
    """Which rows are held out to test the surrogates."""

    fraction: float | None = Field(
        None, gt=0, lt=1, description="Share of the rows, chosen at random.", examples=[0.2]
    )
    seed: int = Field(0, ge=0, description="Seed of the random choice of rows.", examples=[1])
    column: str | None = Field(
        None, description="A column that says train or test.", examples=["split"]
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> DataTestPart:
        if (self.fraction is None) == (self.column is None):
            raise ValueError("give either fraction (and seed) or column")
        return self


def _outputs_by_name(value: Any) -> Any:
    names = (value,) if isinstance(value, str) else value
    return {name: {} for name in names} if isinstance(names, list | tuple) else value


DataOutputs = Annotated[
    dict[str, DataOutputPart],
    BeforeValidator(
        _outputs_by_name, json_schema_input_type=str | list[str] | dict[str, DataOutputPart]
    ),
]


class DataPart(Part):
    """A table of runs that are done: in place of a solver, or beside it."""

    file: str = Field(
        description="The table: csv, tsv, xlsx, parquet or nc, relative to the study file.",
        examples=["tests.csv"],
    )
    sheet: str | None = Field(
        None, description="Sheet of an Excel file. Default: its first.", examples=["Tests 2024"]
    )
    outputs: DataOutputs = Field(
        {},
        description="Columns that are outputs. Default: guessed, and told.",
        examples=[{"strength": {"unit": "MPa"}}, ["strength", "weight"]],
    )
    rename: dict[str, Name] = Field(
        {},
        description="Names in the study for headers of the table.",
        examples=[{"Temp (degC)": "temperature"}],
    )
    leave_out: Texts = Field(
        (),
        description="Columns that are neither inputs nor outputs.",
        examples=[["operator", "date"]],
    )
    test: DataTestPart | None = Field(
        None,
        description="Rows that are held out to test the surrogates.",
        examples=[{"fraction": 0.2, "seed": 1}],
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"file": value} if isinstance(value, str) else value


class ConstantPart(Part):
    """A fixed value of an input."""

    value: Number | str = Field(
        description="The value: a number, or the name of a level.", examples=[0.6, "soft"]
    )
    unit: str | None = Field(
        None, description="Unit of the value. Default: the solver's unit.", examples=["mm"]
    )

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return value if isinstance(value, Mapping) else {"value": value}


class MethodPart(OpenPart):
    """A method and its options; its name alone where it needs none."""

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"method": value} if isinstance(value, str) else value


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
        "best",
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


class ExecutionPart(Part):
    """How the runs are carried out."""

    executor: str = Field(
        "local",
        description="Where: local, threads, serial, dask, slurm, pbs, lsf, sge, shared_folder, "
        "or module:function that gives an executor of concurrent.futures.",
        examples=["slurm"],
    )
    options: dict[str, Any] = Field(
        {}, description="Options of that executor.", examples=[{"jobs": 20, "walltime": "12 h"}]
    )
    places: int | None = Field(
        None,
        ge=1,
        description="Runs at once. Default: one a core, or all that a cluster has.",
        examples=[8],
    )
    workers: int | None = Field(None, ge=1, description="Another word for places.", examples=[2])
    memory: Size = Field(
        None,
        description="Most memory of a run, with the programs that it starts (Linux). A run that "
        "holds more is ended and is a failed run.",
        examples=["4 GB"],
    )
    timeout: Duration = Field(
        None,
        description="Longest time of a run. A run that takes longer is ended and is a failed run.",
        examples=["30 s", "30 min", "2 h"],
    )
    retries: int = Field(
        0,
        ge=0,
        description="Further attempts of a run that crashed, hung or raised an exception.",
        examples=[1],
    )

    @property
    def at_once(self) -> int | None:
        """Runs at once; None for as many as there is room for."""
        return self.places or self.workers


def _asked(value: Any) -> Any:
    return {} if value is None else value


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
    designs: dict[Name, DesignPart] = Field(
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
        examples=["sobol", {"method": "sobol", "surrogate": "best"}],
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
