"""The shape of a study file: which keys it has and what kind of value each takes.

`surrogate schema` prints it as JSON Schema. Whether names exist, units convert
and ranges hold is decided in `surrogate.study.reading`, where names become objects.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)

from surrogate.errors import StudyError, nearest
from surrogate.space import units

Number = Annotated[float, Field(strict=False, allow_inf_nan=False)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]


def _seconds(value: Any) -> float | None:
    try:
        return None if value is None else units.seconds(value)
    except StudyError as error:
        raise ValueError(str(error)) from None


Duration = Annotated[
    float | None, BeforeValidator(_seconds, json_schema_input_type=str | float), Field(gt=0)
]


def _listed(value: Any) -> Any:
    return (value,) if isinstance(value, str) else value


#: One text, or a list of them.
Texts = Annotated[
    tuple[str, ...], BeforeValidator(_listed, json_schema_input_type=str | tuple[str, ...])
]


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
    """What varies: a range, a distribution with its words, or levels."""

    range: tuple[Number, Number] | None = Field(None, description="Smallest and largest value.")
    distribution: str | None = Field(
        None,
        description="uniform, normal, lognormal, triangular "
        "or a continuous scipy.stats name; a range truncates it.",
    )
    levels: tuple[str, ...] | None = Field(None, description="Names, for a categorical input.")
    unit: str | None = Field(None, description="Converted to the solver's unit.")

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return {"range": value} if isinstance(value, list | tuple) else value


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
    train: tuple[str, ...] = Field(
        ("train",), min_length=1, description="Designs that it learns from."
    )

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

    method: str = "sobol"
    surrogate: str = Field("best", description="A surrogate's name, or best.")
    confidence: float = Field(0.95, gt=0, lt=1)
    groups: dict[Name, tuple[str, ...]] = Field(
        {}, description="Parameters whose share of the variance is asked for as a whole."
    )


class ScreeningPart(Part):
    """Freeze a parameter when its total index is surely below a limit."""

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

    workers: int | None = Field(None, ge=1, description="Processes; default: one a core.")
    timeout: Duration = Field(None, description="Longest time of a run: 30 s, 30 min, 2 h.")
    retries: int = Field(0, ge=0, description="Further attempts of a failed run.")


class StudyPart(Part):
    """A study file."""

    study: Name = Field(description="Results go to results/<study>/.")
    about: str = Field("", description="What is asked, for the report.")
    solver: SolverPart
    parameters: dict[Name, ParameterPart]
    correlation: tuple[tuple[str, str, Annotated[float, Field(gt=-1, lt=1)]], ...] = Field(
        (), description="[name, name, correlation] of dependent parameters (Gaussian copula)."
    )
    constants: dict[Name, ConstantPart] = {}
    outputs: tuple[str, ...] | None = Field(None, description="Default: all of the solver's.")
    designs: dict[Name, DesignPart]
    surrogates: dict[Name, SurrogatePart] = {}
    sensitivity: SensitivityPart | None = None
    screening: ScreeningPart | None = None
    validation: ValidationPart | None = None
    execution: ExecutionPart = ExecutionPart()
    stored: Texts = Field(
        (),
        description="Files of runs that ship with the study "
        "(`surrogate store`), relative to the study file.",
    )


Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Mistake:
    """A sentence about the part of the study at `path` (about its key when `on_key`)."""

    path: Path
    sentence: str
    on_key: bool = False


#: Sections whose entries are checked one by one: a broken entry leaves the others standing.
_SECTIONS = ("parameters", "constants", "designs", "surrogates")
_STAND_INS = {"study": "unnamed", "solver": "unnamed", "parameters": {}, "designs": {}}


def read(data: Any) -> tuple[StudyPart | None, list[Mistake], set[Path]]:
    """The sound part of a study's data, every mistake of shape, and what was left out.

    A part that is needed but broken gets an empty stand-in, so that the rest can
    be checked. The study is None when it is not even a mapping.
    """
    if not isinstance(data, Mapping):
        return None, [Mistake((), "a study is a mapping that starts with 'study: NAME'")], set()
    data, mistakes, broken = dict(data), [], set()
    while True:
        try:
            return StudyPart.model_validate(data), mistakes, broken
        except ValidationError as error:
            items = [item for item in error.errors() if not _covered(item["loc"], broken)]
            mistakes += [_mistake(item) for item in items]
            removed = {_entry(tuple(item["loc"])) for item in items}
            broken |= removed
            for path in removed:
                _leave_out(data, path)


def _covered(path: Path, broken: set[Path]) -> bool:
    return any(tuple(path[:n]) in broken for n in range(1, len(path) + 1))


def _entry(path: Path) -> Path:
    """The part that is left out when something at `path` is wrong."""
    return path[:2] if path[0] in _SECTIONS and len(path) > 1 else path[:1]


def _leave_out(data: dict, path: Path) -> None:
    if len(path) == 1:
        data.pop(path[0], None)
        data.update({key: part for key, part in _STAND_INS.items() if key == path[0]})
    else:
        data[path[0]] = {key: v for key, v in data[path[0]].items() if key != path[1]}


def _mistake(item: Mapping[str, Any]) -> Mistake:
    """One sentence for one of pydantic's errors."""
    path, kind, given = tuple(item["loc"]), item["type"], item.get("input")
    key = path[-1] if path else ""
    if kind == "extra_forbidden":
        return Mistake(
            path, f"key '{key}' is unknown; {nearest(str(key), _keys_at(path[:-1]))}", on_key=True
        )
    if kind == "missing" and isinstance(key, int):
        return Mistake(path[:-1], f"{_shown(path)}: must have {key + 1} entries")
    if kind == "missing":
        close = get_close_matches(str(key), [str(word) for word in given], n=1)
        meant = f"; is '{close[0]}' meant to be '{key}'?" if close else ""
        return Mistake(path[:-1], f"key '{key}' is needed here{meant}", on_key=len(path) > 1)
    if kind == "string_pattern_mismatch":
        name = given if isinstance(given, str) else key
        return Mistake(
            [p for p in path if p != "[key]"],
            f"name '{name}' may hold letters, digits and _ only, and starts with a letter",
            on_key="[key]" in path,
        )
    return Mistake(path, f"{_shown(path)} {given!r}: {_wanted(kind, item)}")


def _shown(path: Path) -> str:
    words = [str(p) for p in path if not isinstance(p, int)]
    return words[-1] if words else "study"


_KINDS = {
    "float_parsing": "must be a number",
    "float_type": "must be a number",
    "int_parsing": "must be a whole number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "string_type": "must be a text",
    "dict_type": "must be a mapping (key: value)",
    "model_type": "must be a mapping (key: value)",
    "model_attributes_type": "must be a mapping (key: value)",
    "tuple_type": "must be a list [.., ..]",
    "finite_number": "must be a finite number",
    "bool_parsing": "must be true or false",
}


def _wanted(kind: str, item: Mapping[str, Any]) -> str:
    context = item.get("ctx", {})
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        word = {
            "greater_than": "above",
            "greater_than_equal": "at least",
            "less_than": "below",
            "less_than_equal": "at most",
        }[kind]
        limit = next(value for name, value in context.items() if name in ("gt", "ge", "lt", "le"))
        return f"must be {word} {limit:g}"
    if kind == "too_short" or kind == "too_long":
        wanted = context.get("min_length", context.get("max_length"))
        return (
            f"must have {wanted} entries"
            if kind == "too_long"
            else f"must have at least {wanted} {'entry' if wanted == 1 else 'entries'}"
        )
    if kind == "missing_argument":
        return "must have two entries"
    if kind == "value_error":
        return str(context.get("error", item["msg"]))
    return _KINDS.get(kind, item["msg"][:1].lower() + item["msg"][1:])


def _keys_at(path: Path) -> list[str]:
    """Keys that a mapping of the study file at `path` takes."""
    if path[:2] == ("validation", "models") and len(path) > 2:
        return list(SolverPart.model_fields)
    parts = {
        "solver": SolverPart,
        "parameters": ParameterPart,
        "constants": ConstantPart,
        "designs": DesignPart,
        "surrogates": SurrogatePart,
        "sensitivity": SensitivityPart,
        "screening": ScreeningPart,
        "validation": ValidationPart,
        "execution": ExecutionPart,
    }
    return list((parts[path[0]] if path else StudyPart).model_fields)


#: Short forms that the parts take in place of a mapping.
_SHORT_FORMS = {
    "SolverPart": {"type": "string"},
    "ParameterPart": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
    "ConstantPart": {"type": ["number", "string"]},
    "SurrogatePart": {"type": "string"},
    "ValidationPart": {"type": "string"},
}


def json_schema() -> dict[str, Any]:
    """JSON Schema of a study file; editors complete from it."""
    schema = StudyPart.model_json_schema(mode="validation")
    for name, short in _SHORT_FORMS.items():
        schema["$defs"][name] = {"anyOf": [schema["$defs"][name], short]}
    taken = schema["$defs"]["SurrogatePart"]["anyOf"][0]["properties"]["train"]
    taken["anyOf"] = [{"type": taken.pop("type"), "items": taken.pop("items")}, {"type": "string"}]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
