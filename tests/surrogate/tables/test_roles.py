"""Which columns look like inputs and outputs."""

import pytest

from surrogate.errors import StudyError
from surrogate.tables.roles import roles
from surrogate.tables.table import read


def guess(tmp_path, text):
    path = tmp_path / "t.csv"
    path.write_text(text)
    return roles(read(path))


def test_the_last_number_is_the_output(tmp_path):
    found = guess(
        tmp_path,
        "run,when,load,kind,fixed,strength\n1,2024-01-01,5,a,3,7.5\n"
        "2,2024-01-02,6,b,3,8.5\n3,2024-01-03,6,a,3,8.1\n4,2024-01-04,7,b,3,8.2\n",
    )
    assert found.inputs == ("load", "kind") and found.outputs == ("strength",)
    assert found.left_out == {
        "run": "numbers the rows",
        "when": "holds dates",
        "fixed": "does not vary",
    }


def test_names_of_outputs(tmp_path):
    found = guess(tmp_path, "y1,y2,a,b,split\n1,2,3,4,train\n5,6,7,8,test\n9,1,2,2,train\n")
    assert found.outputs == ("y1", "y2") and found.inputs == ("a", "b")
    assert found.split == "split"


def test_nothing_left_is_a_sentence(tmp_path):
    with pytest.raises(StudyError, match="'a' does not vary"):
        guess(tmp_path, "a,b\n1,2\n1,3\n")


def test_a_column_that_counts_many_rows_is_no_input(tmp_path):
    """Whatever it is called, 1, 2 .. 12 tells nothing of the output; 1, 2, 3 may be levels."""
    rows = "".join(f"{k},{k % 5}.5,{k % 7}\n" for k in range(1, 13))
    found = guess(tmp_path, "Versuch,a,y\n" + rows)
    assert found.inputs == ("a",) and found.left_out == {"Versuch": "numbers the rows"}
    assert guess(tmp_path, "teeth,a,y\n1,4,3\n2,4.5,7\n3,6,8\n").inputs == ("teeth", "a")
