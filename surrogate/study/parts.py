"""The parts of a study file: which keys each has and what kind of value each takes.

Whether names exist, units convert and ranges hold is decided in
`surrogate.study.reading`, where names become objects.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    model_validator,
)

from surrogate.errors import StudyError

Number = Annotated[float, Field(strict=False, allow_inf_nan=False)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]


def _seconds(value: Any) -> float | None:
    from surrogate.space import units  # pint: not for those who only want the schema

    try:
        return None if value is None else units.seconds(value)
    except StudyError as error:
        raise ValueError(str(error)) from None


def _bytes(value: Any) -> float | None:
    from surrogate.space import units

    try:
        return None if value is None else units.size(value)
    except StudyError as error:
        raise ValueError(str(error)) from None


#: Bytes.
Size = Annotated[
    float | None, BeforeValidator(_bytes, json_schema_input_type=str | float), Field(gt=0)
]

Duration = Annotated[
    float | None, BeforeValidator(_seconds, json_schema_input_type=str | float), Field(gt=0)
]


def _listed(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


#: One text, or a list of them.
Texts = Annotated[
    tuple[str, ...], BeforeValidator(_listed, json_schema_input_type=str | tuple[str, ...])
]


def _names_only(value: Any) -> Any:
    if isinstance(value, list | tuple) and value and all(_is_number(one) for one in value):
        shown = ", ".join(f"{one:g}" for one in value)
        raise ValueError(f"levels are names; for numbers write values: [{shown}]")
    return value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


class Part(BaseModel):
    """A mapping of a study file that takes only the keys it names."""

    model_config = ConfigDict(extra="forbid", frozen=True, hide_input_in_errors=True)


class OpenPart(Part):
    """A mapping whose further keys are options of the plug-in that it names."""

    model_config = ConfigDict(extra="allow")

    @property
    def options(self) -> dict[str, Any]:
        """The further keys."""
        return dict(self.__pydantic_extra__ or {})


class SolverPart(Part):
    """Which simulation to run."""

    name: str = Field(description="Entry point, or module:object.")
    options: dict[str, Any] = Field({}, description="Options of that solver.")

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"name": value} if isinstance(value, str) else value


class ParameterPart(OpenPart):
    """What varies: a range, a distribution with its words, values, or levels."""

    range: tuple[Number, Number] | None = Field(None, description="Smallest and largest value.")
    distribution: str | None = Field(
        None,
        description="uniform, normal, lognormal, triangular "
        "or a continuous scipy.stats name; a range truncates it. "
        "From the column of data: fit (the likeliest law), data (the values, smoothed).",
    )
    integer: bool = Field(False, description="Whole numbers of the range only.")
    values: tuple[Number, ...] | None = Field(
        None, description="The only values of an ordered quantity, such as sizes in a catalogue."
    )
    levels: Annotated[
        tuple[str, ...] | None,
        BeforeValidator(_names_only, json_schema_input_type=tuple[str, ...] | None),
    ] = Field(None, description="Names, for a categorical input.")
    unit: str | None = Field(None, description="Converted to the solver's unit.")

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"range": value} if isinstance(value, list | tuple) else value


class DataOutputPart(Part):
    """A column that holds what was measured or computed."""

    unit: str | None = Field(None, description="Default: that of the table's header.")


class DataTestPart(Part):
    """Which rows are held out to test the surrogates."""

    fraction: float | None = Field(None, gt=0, lt=1, description="Share of the rows, at random.")
    seed: int = Field(0, ge=0, description="Of that choice.")
    column: str | None = Field(None, description="A column that says train or test.")

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

    file: str = Field(description="csv, tsv, xlsx, parquet or nc, relative to the study file.")
    sheet: str | None = Field(None, description="Of an Excel file; default: its first.")
    outputs: DataOutputs = Field(
        {}, description="Columns that are outputs; default: guessed, and told."
    )
    rename: dict[str, Name] = Field({}, description="Header as written -> name in the study.")
    leave_out: Texts = Field((), description="Columns that are neither inputs nor outputs.")
    test: DataTestPart | None = Field(None, description="Rows that are held out.")

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"file": value} if isinstance(value, str) else value


class ConstantPart(Part):
    """A fixed value of an input."""

    value: Number | str
    unit: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return value if isinstance(value, Mapping) else {"value": value}


class AugmentPart(OpenPart):
    """Points added to a design."""

    method: str


class DesignPart(OpenPart):
    """Where to run the solver: a method and its options."""

    method: str = Field(description="See `surrogate list`.")
    augment: tuple[AugmentPart, ...] = Field((), description="fold_over, center_points, ...")


class SurrogatePart(Part):
    """A cheap model: a regressor and its options."""

    method: str = Field(description="See `surrogate list`, or module:Class of scikit-learn.")
    options: dict[str, Any] = {}
    train: tuple[str, ...] = Field(("train",), min_length=1, description="Its training designs.")

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        if isinstance(value, str):
            return {"method": value}
        if isinstance(value, Mapping) and isinstance(value.get("train"), str):
            return {**value, "train": [value["train"]]}
        return value


class SensitivityPart(OpenPart):
    """Which parameters matter, read from a surrogate."""

    method: str = Field("sobol", description="Default: sobol, of correlated parameters shapley.")
    surrogate: str = Field("best", description="A surrogate's name, or best.")
    confidence: float = Field(0.95, gt=0, lt=1)
    groups: dict[Name, tuple[str, ...]] = Field(
        {}, description="Parameters whose share of the variance is asked for as a whole."
    )


class ScreeningPart(Part):
    """Freeze a parameter when its total index (or Shapley effect) is surely below a limit."""

    freeze_below: float = Field(0.02, gt=0, lt=1)
    outputs: Texts = Field(
        (),
        description="Outputs that vote: a parameter is frozen when it "
        "hardly moves any of them. Default: all of the study's.",
    )


class ValidationPart(Part):
    """Cases that no surrogate has seen, and other models to set beside the surrogates."""

    cases: str = Field(description="Measurements (.csv), runs (.nc), or another study (.yaml).")
    output: Texts = Field((), description="Default: every scalar output that the cases have.")
    subject: str | None = Field(
        None,
        description="Column that tells who a case was measured on, "
        "when one has several; default: the column 'subject', if any.",
    )
    models: dict[Name, SolverPart] = Field(
        {},
        description="Other solvers, called on the columns of the cases that they take as inputs.",
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
    )
    options: dict[str, Any] = Field({}, description="Options of that executor.")
    places: int | None = Field(
        None, ge=1, description="Runs at once; default: one a core, or all that a cluster has."
    )
    workers: int | None = Field(None, ge=1, description="Another word for places.")
    memory: Size = Field(None, description="Most memory of a run: 4 GB.")
    timeout: Duration = Field(None, description="Longest time of a run: 30 s, 30 min, 2 h.")
    retries: int = Field(0, ge=0, description="Further attempts of a failed run.")

    @property
    def at_once(self) -> int | None:
        """Runs at once; None for as many as there is room for."""
        return self.places or self.workers


class StudyPart(Part):
    """A study file."""

    study: Name = Field(description="Results go to results/<study>/.")
    about: str = Field("", description="What is asked, for the report.")
    solver: SolverPart | None = None
    data: DataPart | None = Field(None, description="Runs that are done, in a table.")
    parameters: dict[Name, ParameterPart] = {}
    correlation: tuple[tuple[str, str, Annotated[float, Field(gt=-1, lt=1)]], ...] = Field(
        (), description="[name, name, correlation] of dependent parameters (Gaussian copula)."
    )
    constraints: Texts = Field(
        (),
        description="Inequalities such as 'width + 2*gap <= 80 mm', or mixtures such as "
        "'a + b + c = 1', that all points keep.",
    )
    constants: dict[Name, ConstantPart] = {}
    outputs: tuple[str, ...] | None = Field(None, description="Default: all of the solver's.")
    designs: dict[Name, DesignPart] = {}
    replicates: int = Field(
        1, ge=1, description="Runs at every point, of a solver that is not deterministic."
    )
    surrogates: dict[Name, SurrogatePart] = {}
    sensitivity: SensitivityPart | None = None
    screening: ScreeningPart | None = None
    validation: ValidationPart | None = None
    execution: ExecutionPart = Field(default_factory=lambda: ExecutionPart.model_validate({}))
    stored: Texts = Field(
        (),
        description="Files of runs that ship with the study "
        "(`surrogate store`), relative to the study file.",
    )
