"""Every key of a study file tells editors what it means, with examples that are valid."""

from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest

from surrogate.stages.reduced_study import _forget
from surrogate.study.parts import StudyPart
from surrogate.study.schema import json_schema


def keys() -> Iterator[tuple[str, dict[str, Any]]]:
    """`part.key` of every key, with its schema."""
    schema = json_schema()
    parts = {"StudyPart": schema, **schema["$defs"]}
    for name, part in parts.items():
        mapping = part if "properties" in part else part["anyOf"][0]
        for key, found in mapping["properties"].items():
            yield f"{name}.{key}", found


@pytest.mark.parametrize(("key", "found"), list(keys()), ids=[key for key, _ in keys()])
def test_a_key_has_a_description_and_valid_examples(key, found):
    assert found.get("description", "").endswith("."), key
    assert found.get("examples"), key
    for example in found["examples"]:
        jsonschema.validate(example, {**found, "$defs": json_schema()["$defs"]})


@pytest.mark.parametrize("key", StudyPart.model_fields)
def test_the_reader_accepts_the_examples_of_the_first_level(key):
    """pydantic agrees with the schema."""
    for example in StudyPart.model_fields[key].examples or []:
        StudyPart.model_validate({"study": "beam", key: example})


def test_every_part_says_what_it_is():
    schema = json_schema()
    for name, part in schema["$defs"].items():
        described = part if "properties" in part else part["anyOf"][0]
        assert described["description"].endswith("."), name


@pytest.mark.parametrize(
    ("short", "long"),
    [
        ({"sensitivity": "shapley"}, {"sensitivity": {"method": "shapley"}}),
        ({"surrogates": {"gp": "lasso"}}, {"surrogates": {"gp": {"method": "lasso"}}}),
        (
            {"designs": {"train": {"method": "x", "augment": ["fold_over"]}}},
            {"designs": {"train": {"method": "x", "augment": [{"method": "fold_over"}]}}},
        ),
    ],
)
def test_a_method_is_named_alone(short, long):
    """The name stands for a mapping that holds nothing else, in the schema too."""
    study = {"study": "beam", "solver": "b", "parameters": {}, "designs": {}}
    assert StudyPart.model_validate(study | short) == StudyPart.model_validate(study | long)
    found = StudyPart.model_validate(study | short).sensitivity
    assert found is None or "method" in found.model_fields_set
    for words in (short, long):
        jsonschema.validate(study | words, json_schema())


def test_a_reduced_study_takes_a_sensitivity_named_alone():
    """Groups are only looked for where there can be some."""
    data = {"sensitivity": "shapley"}
    _forget(data, ["mu"])
    assert data == {"sensitivity": "shapley"}
