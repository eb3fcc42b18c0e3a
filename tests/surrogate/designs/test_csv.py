import numpy as np
import pytest

from surrogate.designs.csv import csv
from surrogate.errors import DesignError

GOOD = """\
# measured settings
mu, tension,note,posture,bandage
0.1,0.059,first,lying,biflex_16

0.3,0.137,last,standing,biflex_17
2e-1,0.098,"a, b",sitting,biflex_16
"""


def write(folder, text, name="points.csv"):
    (folder / name).write_text(text, encoding="utf-8")
    return name


def test_reads_by_name(mixed, tmp_path):
    """Columns in any order, comments, empty lines, quotes and other columns are fine."""
    coded = csv(mixed, path=write(tmp_path, GOOD), folder=tmp_path)
    np.testing.assert_allclose(coded, [[-1, -1, -1, -1], [1, 1, 1, 1], [0, -1, 0, 0]], atol=1e-12)
    absolute = csv(mixed, path=str(tmp_path / "points.csv"))
    np.testing.assert_array_equal(absolute, coded)


def test_byte_order_mark_and_semicolons(cube, tmp_path):
    """As spreadsheet programs write it."""
    path = write(tmp_path, "\ufeffA;B\n2;3\n5;7\n")
    np.testing.assert_array_equal(
        csv(cube(2), path=path, delimiter=";", folder=tmp_path), [[-1, -1], [1, 1]]
    )


def test_unbounded(unbounded, tmp_path):
    """An unbounded parameter takes any number."""
    path = write(tmp_path, "tension,c10\n0.098,5\n0.059,-20\n")
    coded = csv(unbounded, path=path, folder=tmp_path)
    assert coded[0, 1] == pytest.approx(0.0) and coded[1, 1] == pytest.approx(-1.0)


@pytest.mark.parametrize(
    "text, said",
    [
        ("A,C\n3,4\n", r"points.csv:1: no column for parameter 'B'; .*Allowed: A, C"),
        ("A,B,B\n3,4,4\n", "column 'B' stands twice"),
        ("A;B\n3;4\n", "is ',' the delimiter"),
        ("A,B\n3,four\n", r"points.csv:2: B: 'four' is not a number"),
        ("A,B\n3,4\n\n9,4\n", r"points.csv:4: A: 9 lies outside \[2, 5\] mm; change"),
        ("A,B\n3,nan\n", r"points.csv:2: B: nan lies outside"),
        ("A,B\n3\n", r"points.csv:2: 1 values where the first line names 2"),
        ("A,B\n", "has no points"),
        ("", "has no points"),
    ],
)
def test_mistakes_name_the_line(cube, tmp_path, text, said):
    """Value, line, what is allowed."""
    with pytest.raises(DesignError, match=said):
        csv(cube(2), path=write(tmp_path, text), folder=tmp_path)


def test_all_mistakes_at_once(mixed, tmp_path):
    """One sentence for each wrong cell; after twenty the rest is counted."""
    path = write(tmp_path, "mu,tension,posture,bandage\n0.9,x,lyin,biflex_16\n")
    with pytest.raises(DesignError) as caught:
        csv(mixed, path=path, folder=tmp_path)
    said = str(caught.value)
    assert len(said.splitlines()) == 3 and "did you mean 'lying'" in said
    path = write(tmp_path, "mu,tension,posture,bandage\n" + "9,x,lying,biflex_16\n" * 30)
    with pytest.raises(DesignError, match="and 40 more"):
        csv(mixed, path=path, folder=tmp_path)


def test_files_that_cannot_be_read(cube, tmp_path):
    """Missing, a folder, not text."""
    for path in ("none.csv", "."):
        with pytest.raises(DesignError, match="cannot be read"):
            csv(cube(2), path=path, folder=tmp_path)
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00A")
    with pytest.raises(DesignError, match="UTF-8"):
        csv(cube(2), path="binary.csv", folder=tmp_path)
    with pytest.raises(DesignError, match="delimiter"):
        csv(cube(2), path="none.csv", delimiter=";;", folder=tmp_path)
