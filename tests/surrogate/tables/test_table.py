"""Tables as other programs write them: understood, or told with row and column."""

import datetime as dt

import numpy as np
import pytest

from surrogate.errors import StudyError
from surrogate.tables.table import read


def table(tmp_path, text, name="t.csv", encoding="utf-8", **options):
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return read(path, **options)


def numbers(found, name):
    return found[name].values.tolist()


@pytest.mark.parametrize(
    "text, expected",
    [
        ("a,b\n1.5,2\n3,4\n", [1.5, 3.0]),
        ("a;b\n1,5;2\n3;4\n", [1.5, 3.0]),
        ("a\tb\n1,5\t2\n3\t4\n", [1.5, 3.0]),
        ("a|b\n1.5|2\n3|4\n", [1.5, 3.0]),
        ('a,b\n"1,5",2\n"3,0",4\n', [1.5, 3.0]),
        ("a;b\n1.234,5;2\n3;4\n", [1234.5, 3.0]),
        ('a,b\n"1,234.5",2\n3,4\n', [1234.5, 3.0]),
        ("a;b\n1 234,5;2\n3;4\n", [1234.5, 3.0]),
        ("a;b\n1'234.5;2\n3;4\n", [1234.5, 3.0]),
        ("a;b\n1,234;0,5\n3;4,5\n", [1.234, 3.0]),  # column b has decimal commas
        ("a,b\n1.234,2\n3.456,4\n", [1.234, 3.456]),
        ("a,b\n1e3,2\n-.5E-1,4\n", [1000.0, -0.05]),
        ("a,b\n\u22121.5,2\n3,4\n", [-1.5, 3.0]),
        ("a,b\r\n1.5,2\r\n3,4\r\n", [1.5, 3.0]),
        ("\ufeffa,b\n1.5,2\n3,4\n", [1.5, 3.0]),
        ("# from a machine\na,b\n\n1.5,2\n , \n3,4\n", [1.5, 3.0]),
        ("a , b\n 1.5 , 2\n 3 ,4\n", [1.5, 3.0]),
        ("a,b,\n1.5,2,\n3,4,\n", [1.5, 3.0]),
    ],
)
def test_numbers_in_any_notation(tmp_path, text, expected):
    found = table(tmp_path, text)
    assert list(found.columns) == ["a", "b"] and numbers(found, "a") == expected


def test_utf16_and_windows_1252(tmp_path):
    assert numbers(table(tmp_path, "größe,b\n1,2\n", encoding="utf-16"), "größe") == [1.0]
    found = table(tmp_path, "größe,b\n1,2\n", encoding="cp1252")
    assert numbers(found, "größe") == [1.0] and "Windows-1252" in found.notes[0]


def test_units_in_the_header_and_below_it(tmp_path):
    found = table(tmp_path, "load [N],Temp (°C),rate (left),n [-]\n1,2,3,4\n5,6,7,8\n")
    assert {name: c.unit for name, c in found.columns.items()} == {
        "load": "N",
        "Temp": "degC",
        "rate_left": "",
        "n": "",
    }
    below = table(tmp_path, "load,stress,n\nN,[MPa],-\n1,2,3\n5,6,7\n")
    assert [c.unit for c in below.columns.values()] == ["N", "MPa", ""]
    assert below.lines == (3, 4) and below["n"].kind == "integer"


def test_names_that_a_study_can_use(tmp_path):
    found = table(tmp_path, "a-b,a b,2nd\n1,2,3\n", rename={"2nd": "second"})
    assert list(found.columns) == ["a_b", "a_b_2", "second"]
    with pytest.raises(StudyError, match="rename: t.csv has no column 'zz'"):
        table(tmp_path, "a,b\n1,2\n", rename={"zz": "x"})


def test_kinds(tmp_path):
    found = table(
        tmp_path,
        "x,n,kind,when,y\n1.5,3,soft,2024-01-31,1\n2.5,4,stiff,2024-02-01,NA\n,5,soft,01.02.2024,2\n",
    )
    assert [c.kind for c in found.columns.values()] == [
        "number",
        "integer",
        "category",
        "date",
        "integer",
    ]
    assert found["y"].missing.tolist() == [False, True, False]
    assert found["x"].missing.tolist() == [False, False, True]
    assert found["kind"].varies and found.rows == 3


def test_duplicated_rows_are_found(tmp_path):
    found = table(tmp_path, "a,b,y\n1,2,3\n1,2,4\n5,6,7\n1,2,3\n")
    assert found.duplicates(["a", "b"]).tolist() == [0, 0, 2, 0]


def test_empty_columns_are_told(tmp_path):
    found = table(tmp_path, "a,empty,b\n1,,2\n3,,4\n")
    assert list(found.columns) == ["a", "b"]
    assert "empty columns are left out: empty" in found.notes[0]


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("", "t.csv is empty"),
        ("a,b\n", "has names of columns, but no rows below them"),
        ("1.5,2\n3,4\n", "the first row holds numbers; it must name the columns"),
        ("a,a\n1,2\n", "two columns are called 'a'"),
        ("a,b\n1,2\n3,4,5\n", "t.csv:3: 3 cells where the first row names 2"),
        ("a,\n1,2\n", "t.csv:1: column 2 has values but no name"),
        ("a,b\n1,2\n3,4\nx,6\n5,6\n", "row 4, column 'a': 'x' is not a number"),
        ("a,b\n1,2\n\ninf,6\n5,6\n", "row 4, column 'a': 'inf' is not finite"),
        ("a;b\n1,234;2\n3,456;4\n", "numbers such as 1,234 can be read with a decimal comma or"),
        ("a,b\n1\0,2\n", "is not a text file"),
    ],
)
def test_what_is_not_understood_is_a_sentence(tmp_path, text, sentence):
    with pytest.raises(StudyError, match=sentence):
        table(tmp_path, text)


def test_all_mistakes_come_at_once(tmp_path):
    body = "".join(f"{i},{'bad' if i % 5 == 0 else i}\n" for i in range(100))
    with pytest.raises(StudyError) as caught:
        table(tmp_path, "a,b\n" + body)
    assert len(caught.value.mistakes) == 11 and "and 10 more" in caught.value.mistakes[-1]


def test_files_that_are_no_tables(tmp_path):
    for name, sentence in (
        ("t.pdf", "files of kind '.pdf' are not read; use .csv"),
        ("t.xlsx", "no Excel workbook|need openpyxl"),
        ("t.parquet", "no Parquet file|need pyarrow"),
        ("t.nc", "no netCDF file"),
    ):
        with pytest.raises(StudyError, match=sentence):
            table(tmp_path, "rubbish", name=name)
    with pytest.raises(StudyError, match="cannot be read"):
        read(tmp_path / "nowhere.csv")


def test_excel(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    for row in (["a [mm]", "kind", "when"], [1, "x", dt.date(2024, 1, 1)], [None] * 3, [2.5, "y"]):
        sheet.append(row)
    book.create_sheet("more").append(["z"])
    book["more"].append([3])
    book.save(tmp_path / "t.xlsx")
    found = read(tmp_path / "t.xlsx")
    assert numbers(found, "a") == [1.0, 2.5] and found["a"].unit == "mm"
    assert found["when"].kind == "date" and found.lines == (2, 4)
    assert "sheet 'Sheet' is read, of 2" in found.notes[0]
    assert numbers(read(tmp_path / "t.xlsx", sheet="more"), "z") == [3.0]
    with pytest.raises(StudyError, match="has no sheet 'mor'"):
        read(tmp_path / "t.xlsx", sheet="mor")


def test_parquet(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(
        pyarrow.table({"a": [1.5, None], "kind": ["x", "y"]}), tmp_path / "t.parquet"
    )
    found = read(tmp_path / "t.parquet")
    assert np.isnan(numbers(found, "a")[1]) and found["kind"].kind == "category"


def test_netcdf(tmp_path):
    import xarray as xr

    data = xr.Dataset(
        {"a": ("run", [1.0, 2.0], {"units": "mm"}), "f": (("run", "x"), np.zeros((2, 3)))},
        coords={"x": [0.0, 1.0, 2.0]},
    )
    data.to_netcdf(tmp_path / "t.nc")
    found = read(tmp_path / "t.nc")
    assert found["a"].unit == "mm" and numbers(found, "a") == [1.0, 2.0]
    assert "left out: f" in found.notes[0]
