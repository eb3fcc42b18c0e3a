"""The JSON Schema of a study file, from which editors complete."""

from __future__ import annotations

import json
from typing import Any

from surrogate.study.catalogue import catalogue
from surrogate.study.parts.study import StudyPart

#: Short forms that the parts take in place of a mapping.
_SHORT_FORMS = {
    "ParameterPart": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
    "ConstantPart": {"type": ["number", "string"]},
    "ValidationPart": {"type": "string"},
    "DataPart": {"type": "string"},
    "TargetPart": {
        "type": ["number", "string", "array"],
        "items": {"type": ["number", "string"]},
        "minItems": 2,
        "maxItems": 2,
    },
}


#: Parts for which the name of their plug-in may stand alone.
_ALONE = ("SolverPart", "AugmentPart", "SurrogatePart", "SensitivityPart")
#: Where a plug-in is named: part, key, kind of plug-in.
_NAMED = (
    ("SolverPart", "name", "solvers"),
    ("DesignPart", "method", "designs"),
    ("AugmentPart", "method", "augmentations"),
    ("SurrogatePart", "method", "regressors"),
    ("SensitivityPart", "method", "sensitivity"),
    ("ExecutionPart", "executor", "executors"),
)


def json_schema() -> dict[str, Any]:
    """JSON Schema of a study file: short forms, and the plug-ins that are installed."""
    schema = StudyPart.model_json_schema(mode="validation")
    parts, names = schema["$defs"], _plugins()
    for part, key, kind in _NAMED:
        parts[part]["properties"][key].pop("type")
        parts[part]["properties"][key]["anyOf"] = names[kind]
    for name, short in _SHORT_FORMS.items():
        parts[name] = {"anyOf": [parts[name], short]}
    for name, _, kind in (row for row in _NAMED if row[0] in _ALONE):
        parts[name] = {"anyOf": [parts[name], *names[kind]]}
    taken = parts["SurrogatePart"]["anyOf"][0]["properties"]["train"]
    taken["anyOf"] = [{"type": taken.pop("type"), "items": taken.pop("items")}, {"type": "string"}]
    schema["anyOf"] = [{"required": ["solver", "parameters", "designs"]}, {"required": ["data"]}]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def schema_text() -> str:
    """The schema as a file."""
    return json.dumps(json_schema(), indent=2) + "\n"


def _plugins() -> dict[str, list[dict[str, str]]]:
    """Kind -> what a study file may write: a name that is installed, or `module:object`."""
    other = {
        "type": "string",
        "pattern": r"^[^:\s]+:[^:\s]+$",
        "description": "module:object, of a module beside the study or of an installed package.",
    }
    return {
        kind: [{"const": name, "description": line} for name, line in lines.items()] + [other]
        for kind, lines in catalogue().items()
    }
