"""Names and texts that a solver declares and that no file of runs can hold."""

import numpy as np
import pytest

from surrogate.runs.assembly import assemble
from surrogate.runs.dataset import load, save
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import read
from surrogate.runs.names import name_mistakes
from surrogate.solver import Input, Output
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space((Parameter("x", uniform(0.0, 1.0), unit="mm"),))


def along(name, values=(0.0, 1.0)):
    return Output(dims=(name,), coordinates={name: values})


@pytest.mark.parametrize("name", ["", ".", "\0", "a\0b", "\ud800", "a\nb", "a/b", 5, None, True])
def test_a_name_that_no_file_can_hold_is_a_sentence(name):
    (mistake,) = name_mistakes(SPACE, {name: Output()})
    assert mistake.startswith(f"output {name!r}: a name ") and mistake.endswith("; rename it")
    (mistake,) = name_mistakes(SPACE, {"y": along(name)})
    assert mistake.startswith(f"dimension {name!r}: a name ")
    mistake.encode()  # can be printed


@pytest.mark.parametrize("unit", ["\0", "m\0m", "\ud800"])
def test_a_unit_that_no_file_can_hold_is_a_sentence(unit):
    (mistake,) = name_mistakes(SPACE, {"y": Output(unit=unit)})
    assert mistake.startswith(f"output 'y': the unit {unit!r} cannot hold NUL")
    theirs = Space((Parameter("x", uniform(0.0, 1.0), unit=unit),))
    (mistake,) = name_mistakes(theirs, {"y": Output()})
    assert mistake.startswith(f"parameter 'x': the unit {unit!r} cannot hold NUL")


@pytest.mark.parametrize(
    "values",
    [
        ["a\0b", "c"],
        ["\ud800", "c"],
        np.array([1, "b"], dtype=object),
        1j * np.ones(2),
        [[1, 2]],
        3,
    ],
    ids=["NUL", "surrogate", "objects", "complex", "table", "number"],
)
def test_coordinates_that_no_file_can_hold_are_a_sentence(values):
    (mistake,) = name_mistakes(SPACE, {"y": along("t", values)})
    assert mistake.startswith("output 'y': the coordinates along 't' must be numbers, dates or")


def test_a_dimension_without_coordinates_is_a_sentence():
    (mistake,) = name_mistakes(SPACE, {"y": Output(dims=("t",))})
    assert mistake == "output 'y' has no coordinates along 't'; give it some"


class Odd:
    """A solver whose other texts hold what no file can."""

    version = "1\0\ud800"
    inputs = {"x": Input(unit="mm", description="\0")}
    outputs = {" é.x": Output(description="a\0\ud800"), "b": along("t", ["é", "b"])}

    def __call__(self, x):
        return {" é.x": x, "b": [x, x]}


def test_other_texts_are_kept_as_far_as_a_file_can_hold_them(tmp_path):
    """Descriptions, versions and the study's text never stop a dataset from being written."""
    space = Space((Parameter("x", uniform(0.0, 1.0), unit="mm", description="\ud800"),))
    runs = assemble(
        space, {"train": np.zeros((1, 1))}, SolverSpec("odd", Odd), read("none"), study="a\0b"
    )
    save(runs, tmp_path / "runs.nc")
    back = load(tmp_path / "runs.nc")
    assert back.attrs["study"] == "a?b" and back.attrs["solver_version"] == "1??"
    assert back[" é.x"].attrs["long_name"] == "a??" and back["x"].attrs["long_name"] == "?"
