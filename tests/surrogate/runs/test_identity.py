"""The identity of a run: the same from one version to the next, to the last digit."""

import hashlib
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surrogate.errors import StudyError
from surrogate.runs.identity import SolverSpec, keys_in, run_inputs
from surrogate.solver import Input, Output

VALUES = st.one_of(st.floats(allow_nan=False, allow_infinity=False), st.text())
CALLS = st.lists(st.dictionaries(st.text(), VALUES, max_size=4), max_size=4)


@given(calls=CALLS)
def test_a_key_is_the_digest_of_the_call_as_sorted_json(calls):
    """Whatever names and values are (`%` and quotes too), and whether or not calls agree in names.

    Keys of journals and stored files of all versions depend on it.
    """
    expected = [
        hashlib.sha256(b"context" + json.dumps(call, sort_keys=True).encode()).hexdigest()[:32]
        for call in calls
    ]
    assert keys_in("context", calls, True) == expected


class Any:
    version, outputs = "1", {"y": Output()}
    inputs = {"x": Input(), "way": Input(levels=("a", "b"), nominal="a"), "z": Input(nominal=-0.0)}

    def __call__(self, **inputs):
        return {"y": 0.0}


@pytest.mark.parametrize(
    "column",
    [
        [0.1, -0.0, 3.0],
        [1, 2, 3],
        np.float32([0.1, 0.2, 0.3]),
        np.array([2**63 + 1], dtype=np.uint64),
        ["1.5", "2"],
        np.array([0.25, 1], dtype=object),
        7,
    ],
    ids=str,
)
def test_a_column_gives_the_numbers_that_its_values_give_one_by_one(column):
    calls = run_inputs(SolverSpec("any", Any), {"x": column, "way": ["b"] * np.size(column)})
    expected = [float(value) + 0.0 for value in np.atleast_1d(column).tolist()]
    assert [call["x"] for call in calls] == expected
    assert all(str(call["x"]) != "-0.0" and call["way"] == "b" for call in calls)
    assert str(calls[0]["z"]) == "0.0"


def test_one_bad_value_in_a_long_column_is_named():
    for bad, said in ((np.nan, "x: nan is not finite"), (np.inf, "x: inf is not finite")):
        with pytest.raises(StudyError, match=said):
            run_inputs(SolverSpec("any", Any), {"x": [*range(1000), bad]})
