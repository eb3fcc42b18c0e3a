"""`surrogate new NAME --data FILE`: the study of a table that it writes runs as it is."""

import numpy as np
import pytest
import xarray as xr
from made_up import table_of_beams

from surrogate.cli import results
from surrogate.errors import StudyError
from surrogate.study import template
from surrogate.study.study import Study


def written(folder, file, content=None):
    if content is not None:
        (folder / file).write_text(content)
    return template.write("mine", folder, folder / file)


def test_the_study_of_a_table_runs_as_it_is(tmp_path):
    path = written(tmp_path, "beams.csv", table_of_beams())
    text = path.read_text()
    assert "load:     {range: [10, 50], unit: N}" in text
    assert "material: {levels: [brass, steel]}" in text
    assert "leave_out: [run, measured]" in text and "# measured holds dates" in text
    assert "# Missing answers: 1" in text
    study = Study.from_yaml(path)
    done = results.analyse(study, tmp_path / "r", study.run(results=tmp_path / "r"))
    assert done.summary["comparison"]["q2_cv"]["values"][1][0] > 0.9
    assert done.summary["sensitivity"]


def test_surrogates_that_the_rows_do_not_suffice_for_are_comments(tmp_path):
    rows = "\n".join(f"{x},{x % 3},{x % 4},{x * 2}" for x in range(7))
    text = written(tmp_path, "t.csv", f"a,b,c,y\n{rows}\n").read_text()
    assert "# quadratic: quadratic   # needs 10 different points" in text
    assert "  linear: linear\n" in text
    assert "{range: [0, 2], integer: true}   # guessed" in text


@pytest.mark.parametrize("kind", ["semicolons", "tabs", "split", "names", "nc", "xlsx", "parquet"])
def test_tables_of_every_kind(tmp_path, kind):
    """A table from another program becomes a study that can be checked, whatever its dress."""
    r = np.random.default_rng(0)
    x, z = r.uniform(size=(2, 20)).round(3)
    y = (3 * x + z**2).round(4)
    if kind == "semicolons":
        lines = ["Temp (°C);Druck [bar];Kraft [N]"]
        lines += [f"{a};{b};{c}".replace(".", ",") for a, b, c in zip(x, z, y, strict=True)]
        path = written(tmp_path, "t.csv", "\n".join(lines))
    elif kind == "tabs":
        lines = ["x\tz\ty", *(f"{a}\t{b}\t{c}" for a, b, c in zip(x, z, y, strict=True))]
        path = written(tmp_path, "t.tsv", "\n".join(lines))
    elif kind == "split":
        lines = [
            f"{a},{b},{c},{'test' if c > 2 else 'train'}" for a, b, c in zip(x, z, y, strict=True)
        ]
        path = written(tmp_path, "t.csv", "\n".join(["x,z,y,set", *lines]))
        assert "test: {column: set}" in path.read_text()
    elif kind == "names":
        lines = [f"{a},{b},{c}" for a, b, c in zip(x, z, y, strict=True)]
        path = written(tmp_path, "t.csv", "\n".join(["status,2nd value %,y", *lines]))
        assert 'rename: {"status": "status_"}' in path.read_text()
    elif kind == "nc":
        xr.Dataset({"x": ("n", x, {"units": "m"}), "z": ("n", z), "y": ("n", y)}).to_netcdf(
            tmp_path / "t.nc", engine="h5netcdf"
        )
        path = written(tmp_path, "t.nc")
    elif kind == "xlsx":
        book = pytest.importorskip("openpyxl").Workbook()
        for row in [("x [mm]", "z", "y"), *zip(x, z, y, strict=True)]:
            book.active.append(row)
        book.save(tmp_path / "t.xlsx")
        path = written(tmp_path, "t.xlsx")
    else:
        arrow = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        parquet.write_table(arrow.table({"x": x, "z": z, "y": y}), tmp_path / "t.parquet")
        path = written(tmp_path, "t.parquet")
    study = Study.from_yaml(path)
    assert study.space.size == 2 and len(study.outputs) == 1
    assert sum(design.runs for design in study.designs.values()) == 20
    runs = study.run(results=tmp_path / "r")
    np.testing.assert_allclose(np.sort(runs[study.outputs[0]]), np.sort(y), rtol=1e-12)


def test_a_table_that_is_not_understood_writes_nothing(tmp_path):
    with pytest.raises(StudyError, match="row 3, column 'x': 'abc' is not a number"):
        written(tmp_path, "t.csv", "x,y\n1,2\nabc,3\n2,5\n")
    assert not (tmp_path / "mine.yaml").exists()
