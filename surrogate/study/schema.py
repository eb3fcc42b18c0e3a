"""The JSON Schema of a study file, from which editors complete."""

from __future__ import annotations

from typing import Any

from surrogate.study.parts import StudyPart

#: Short forms that the parts take in place of a mapping.
_SHORT_FORMS = {
    "SolverPart": {"type": "string"},
    "ParameterPart": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
    "ConstantPart": {"type": ["number", "string"]},
    "AugmentPart": {"type": "string"},
    "SurrogatePart": {"type": "string"},
    "SensitivityPart": {"type": "string"},
    "ValidationPart": {"type": "string"},
    "DataPart": {"type": "string"},
}


def json_schema() -> dict[str, Any]:
    """JSON Schema of a study file, short forms included."""
    schema = StudyPart.model_json_schema(mode="validation")
    for name, short in _SHORT_FORMS.items():
        schema["$defs"][name] = {"anyOf": [schema["$defs"][name], short]}
    taken = schema["$defs"]["SurrogatePart"]["anyOf"][0]["properties"]["train"]
    taken["anyOf"] = [{"type": taken.pop("type"), "items": taken.pop("items")}, {"type": "string"}]
    schema["anyOf"] = [{"required": ["solver", "parameters", "designs"]}, {"required": ["data"]}]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
