"""Every key of a study file tells editors what it means, with examples that are valid."""

from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest

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
