"""runs.nc in place of the journal: the same dataset, and only while it is of that journal."""

import shutil
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr

from surrogate.cli import results
from surrogate.runs import journal
from surrogate.stages.digest import of_runs
from surrogate.study.study import Study

STUDY = {
    "study": "kept",
    "solver": {"name": "misbehaving:Misbehaving"},
    "parameters": {"x": [1, 9], "way": {"levels": ["well", "refuse"]}},
    "designs": {
        "train": {"method": "latin_hypercube", "runs": 16, "seed": 1},
        "more": {"method": "full_factorial", "levels": 2},
    },
    "surrogates": {"linear": {"method": "linear", "train": ["train", "more"]}},
}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("done") / "kept"
    study = Study.from_mapping(STUDY)
    with ThreadPoolExecutor(1) as executor:
        runs = study.run(results=folder, executor=executor)
    results.analyse(study, folder, runs)
    return folder


@pytest.fixture
def folder(done, tmp_path):
    return shutil.copytree(done, tmp_path / "kept")


@pytest.fixture
def reads(monkeypatch):
    """Files of records that are read, in turn."""
    found = []
    read_file = journal._read_file

    def watched(path, of):
        found.append(path)
        return read_file(path, of)

    monkeypatch.setattr(journal, "_read_file", watched)
    return found


def from_journal(folder):
    """The dataset as it is without runs.nc."""
    path = folder / "runs.nc"
    path.rename(aside := path.with_suffix(".aside"))
    try:
        return Study.from_mapping(STUDY).stored(folder)
    finally:
        aside.rename(path)


def test_the_dataset_is_the_same_and_no_record_is_read(folder, reads):
    runs = Study.from_mapping(STUDY).stored(folder)
    assert not reads
    expected = from_journal(folder)
    assert reads and set(expected["status"].values) == {"ok", "failed"}
    assert of_runs(runs) == of_runs(expected)
    created = {"created": ""}
    xr.testing.assert_identical(runs.assign_attrs(created), expected.assign_attrs(created))


def test_how_runs_ended_is_known_without_the_outputs(folder, reads):
    history, unfound = Study.from_mapping(STUDY).begun(folder)
    assert not reads and not unfound
    expected = from_journal(folder)
    assert set(expected.data_vars) - set(history.data_vars) == {"square", "ramp"}
    for name in history.data_vars:
        assert history[name].equals(expected[name])


def grown(folder):
    """A run that is none of the study's stands in the journal."""
    with journal.Journal(folder / "journal") as book:
        record = next(iter(book.records.values()))
        book.append(type(record)(**{**vars(record), "key": "0" * 32}))


def other_bit(folder):
    content = bytearray((folder / "runs.nc").read_bytes())
    content[len(content) // 2] ^= 1
    (folder / "runs.nc").write_bytes(content)


def gone(folder):
    (folder / "runs.nc").unlink()


def blanked(folder):
    path = folder / "journal" / journal.RECORDS
    path.write_bytes(path.read_bytes().replace(b'"key"', b'"kez"', 1))


@pytest.mark.parametrize("change", [grown, other_bit, gone, blanked])
def test_the_journal_counts_when_either_has_changed(folder, reads, change):
    change(folder)
    reads.clear()
    runs = Study.from_mapping(STUDY).stored(folder)
    assert reads
    assert (runs["status"] == "missing").sum() == (change is blanked)


def test_other_points_are_looked_for_in_the_journal(folder, reads):
    designs = {**STUDY["designs"], "more": {"method": "full_factorial", "levels": 3}}
    runs = Study.from_mapping({**STUDY, "designs": designs}).stored(folder)
    assert reads
    new = runs["x"].values[runs["status"].values == "missing"]
    np.testing.assert_array_equal(new, [5.0, 5.0])


def test_a_command_that_runs_reads_the_journal_once(folder, reads):
    heard = []
    blanked(folder)
    with ThreadPoolExecutor(1) as executor:
        study = Study.from_mapping(STUDY)
        runs = study.run(results=folder, executor=executor, tell=heard.append)
    assert len(reads) == 1
    assert len(heard) == 1 and "line 1: the record is damaged" in heard[0]
    assert (runs["status"] != "missing").all() and runs.attrs["damaged"] == "[]"
    assert of_runs(runs) == of_runs(from_journal(folder))
