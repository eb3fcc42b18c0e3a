"""Every key of a study file tells editors what it means, with examples that are valid."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from surrogate.stages.reduced_study import _forget
from surrogate.study import template
from surrogate.study.catalogue import catalogue
from surrogate.study.parts.study import StudyPart
from surrogate.study.schema import json_schema

SCHEMA = json_schema()


def keys() -> Iterator[tuple[str, dict[str, Any]]]:
    """`part.key` of every key, with its schema."""
    parts = {"StudyPart": SCHEMA, **SCHEMA["$defs"]}
    for name, part in parts.items():
        mapping = part if "properties" in part else part["anyOf"][0]
        for key, found in mapping["properties"].items():
            yield f"{name}.{key}", found


@pytest.fixture(scope="module")
def validator():
    """Of the schema, which is checked once."""
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    return jsonschema.Draft202012Validator(SCHEMA)


@pytest.mark.parametrize(("key", "found"), list(keys()), ids=[key for key, _ in keys()])
def test_a_key_has_a_description_and_valid_examples(validator, key, found):
    assert found.get("description", "").endswith("."), key
    assert found.get("examples"), key
    here = validator.evolve(schema={**found, "$defs": SCHEMA["$defs"]})
    for example in found["examples"]:
        here.validate(example)


@pytest.mark.parametrize("key", StudyPart.model_fields)
def test_the_reader_accepts_the_examples_of_the_first_level(key):
    """pydantic agrees with the schema."""
    for example in StudyPart.model_fields[key].examples or []:
        StudyPart.model_validate({"study": "beam", key: example})


def test_every_part_says_what_it_is():
    for name, part in SCHEMA["$defs"].items():
        described = part if "properties" in part else part["anyOf"][0]
        assert described["description"].endswith("."), name


@pytest.mark.parametrize(
    ("short", "long"),
    [
        ({"sensitivity": "shapley"}, {"sensitivity": {"method": "shapley"}}),
        ({"surrogates": {"gp": "lasso"}}, {"surrogates": {"gp": {"method": "lasso"}}}),
        (
            {"designs": {"train": {"method": "m:x", "augment": ["fold_over"]}}},
            {"designs": {"train": {"method": "m:x", "augment": [{"method": "fold_over"}]}}},
        ),
    ],
)
def test_a_method_is_named_alone(validator, short, long):
    """The name stands for a mapping that holds nothing else, in the schema too."""
    study = {"study": "beam", "solver": "b:B", "parameters": {}, "designs": {}}
    assert StudyPart.model_validate(study | short) == StudyPart.model_validate(study | long)
    found = StudyPart.model_validate(study | short).sensitivity
    assert found is None or "method" in found.model_fields_set
    for words in (short, long):
        validator.validate(study | words)


def test_a_reduced_study_takes_a_sensitivity_named_alone():
    """Groups are only looked for where there can be some."""
    data = {"sensitivity": "shapley"}
    _forget(data, ["mu"])
    assert data == {"sensitivity": "shapley"}


STUDIES = sorted((Path(__file__).parents[3] / "studies").glob("*.yaml"))
#: Misspelt or wrong, and the path at which an editor marks it.
WRONG = {
    "a key": ({"surogates": {}}, []),
    "a key of a part": ({"execution": {"timeot": "1 h"}}, ["execution"]),
    "a solver": ({"solver": "boreholle"}, ["solver"]),
    "a solver with options": ({"solver": {"name": "boreholle"}}, ["solver", "name"]),
    "a design": ({"designs": {"t": {"method": "sobool"}}}, ["designs", "t", "method"]),
    "an augmentation": (
        {"designs": {"t": {"method": "sobol", "augment": [{"method": "foldover"}]}}},
        ["designs", "t", "augment", 0, "method"],
    ),
    "a regressor": ({"surrogates": {"gp": "gausian_process"}}, ["surrogates", "gp"]),
    "a sensitivity method": ({"sensitivity": {"method": "sobo"}}, ["sensitivity", "method"]),
    "an executor": ({"execution": {"executor": "slurn"}}, ["execution", "executor"]),
    "a value": ({"screening": {"freeze_below": "low"}}, ["screening", "freeze_below"]),
}
SOUND = {
    "study": "s",
    "solver": "my_module:MySolver",
    "parameters": {"x": [0, 1]},
    "designs": {"train": {"method": "my_module:design", "runs": 3}},
    "surrogates": {"f": {"method": "sklearn.ensemble:RandomForestRegressor"}},
}


@pytest.mark.parametrize("study", STUDIES, ids=lambda path: path.stem)
def test_every_study_that_ships_is_valid(validator, study):
    validator.validate(yaml.safe_load(study.read_text(encoding="utf-8")))


def places(error) -> Iterator[list[Any]]:
    """Where an error is marked, and the errors of the forms that it might have had."""
    yield list(error.absolute_path)
    for inner in error.context or ():
        yield from places(inner)


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_misspelt_is_marked_at_its_place(validator, wrong):
    """`module:object` is as good as a name that is installed."""
    validator.validate(SOUND)
    changed, place = WRONG[wrong]
    (error,) = validator.iter_errors({**SOUND, **changed})
    assert max(places(error), key=len) == place


def test_every_plug_in_is_offered_with_a_line():
    """Editors list what is installed, each with what it is."""
    offered: dict[str, str] = {}
    parts = json_schema()["$defs"]
    for part in parts.values():
        mapping = part if "properties" in part else part["anyOf"][0]
        for found in mapping["properties"].values():
            known = [one for one in found.get("anyOf", ()) if "const" in one]
            offered |= {one["const"]: one["description"] for one in known}
    for kind, lines in catalogue().items():
        for name, line in lines.items():
            assert name in offered and (offered[name] or not line), (kind, name)


def test_a_new_study_names_a_schema_that_lies_beside_it(tmp_path, validator):
    """Without a network, and wherever the folder goes."""
    path = template.write("mine", tmp_path)
    first, text = path.read_text(encoding="utf-8").split("\n", 1)
    name = first.removeprefix("# yaml-language-server: $schema=")
    schema = json.loads((tmp_path / name).read_text(encoding="utf-8"))
    assert schema == json_schema()
    validator.validate(yaml.safe_load(text))
