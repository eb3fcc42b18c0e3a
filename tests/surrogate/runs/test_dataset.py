import json
import os
import subprocess
import sys
from dataclasses import replace
from datetime import UTC, datetime

import h5py
import numpy as np
import pytest
import xarray as xr
from misbehaving import WAYS, Misbehaving, Noise

from surrogate.errors import ResultsError, StudyError
from surrogate.execution.execute import execute
from surrogate.runs import assembly, names
from surrogate.runs import dataset as rundata
from surrogate.runs.identity import SolverSpec, keys, run_inputs
from surrogate.runs.journal import JournalContents, read
from surrogate.runs.record import Record
from surrogate.solver import Output
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(
    (
        Parameter("x", uniform(0.0, 4.0), unit="mm", description="width of a bandage"),
        Parameter("way", levels=("well", "raise", "hang")),
    )
)
SPEC = SolverSpec("misbehaving", Misbehaving)
TRAIN = np.array([[-1.0, -1.0], [0.5, -1.0], [1.0, 0.0], [0.25, -1.0]])
TEST = np.array([[0.5, -1.0], [0.0, 1.0], [0.75, -1.0]])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Journal of all points but the last one of the test design."""
    folder = tmp_path_factory.mktemp("journal")
    columns = assembly.physical_columns(SPACE, {"train": TRAIN, "test": TEST[:2]})
    execute(SPEC, columns, constants={"offset": 3}, journal=folder, workers=2, timeout=1.0)
    return folder


@pytest.fixture(scope="module")
def runs(folder):
    return assembly.assemble(
        SPACE,
        {"train": TRAIN, "test": TEST},
        SPEC,
        read(folder),
        constants={"offset": 3},
        study="study: é\n",
        seeds={"test": 7},
    )


def test_has_the_variables_and_attributes_that_scripts_count_on(runs):
    """The runs dataset of the design page: names, dimensions, units, provenance."""
    assert dict(runs.sizes) == {"run": 7, "parameter": 2, "place": 3}
    assert {name: runs[name].dims for name in runs} == {
        "coded": ("run", "parameter"),
        "x": ("run",),
        "way": ("run",),
        "square": ("run",),
        "ramp": ("run", "place"),
        **dict.fromkeys(
            ["design", "status", "message", "seconds", "attempts", "finished", "origin"], ("run",)
        ),
    }
    assert runs["parameter"].values.tolist() == ["x", "way"]
    assert runs["place"].values.tolist() == [0.0, 1.0, 2.0]
    assert (runs["coded"].values == np.concatenate([TRAIN, TEST])).all()
    assert runs["x"].attrs == {"units": "mm", "long_name": "width of a bandage"}
    assert runs["square"].attrs == {"units": "mm^2", "long_name": "x squared"}
    assert runs["way"].values.tolist() == ["well", "well", "raise", "well", "well", "hang", "well"]
    assert runs["design"].values.tolist() == ["train"] * 4 + ["test"] * 3
    assert all("long_name" in runs[name].attrs for name in runs)
    assert runs.attrs["study"] == "study: é\n" and runs.attrs["solver"] == "misbehaving"
    assert runs.attrs["solver_version"] == "1"
    assert rundata.described(runs, "constants") == {"offset": 3}
    assert rundata.described(runs, "seeds") == {"test": 7}
    assert rundata.described(runs, "versions")["numpy"] == np.__version__
    age = datetime.now(UTC) - datetime.fromisoformat(runs.attrs["created"])
    assert 0 <= age.total_seconds() < 600


def test_a_failed_run_is_a_row_of_nan_that_says_why(runs):
    x = np.array([0.0, 3.0, 4.0, 2.5, 3.0, 2.0, 3.5])
    status = ["ok", "ok", "failed", "ok", "ok", "timed_out", "missing"]
    good = np.array(status) == "ok"
    assert (runs["x"].values == x).all()
    assert runs["status"].values.tolist() == status
    assert np.array_equal(runs["square"].values, np.where(good, x**2 + 3, np.nan), equal_nan=True)
    expected = np.where(good[:, None], x[:, None] * np.arange(3), np.nan)
    assert np.array_equal(runs["ramp"].values, expected, equal_nan=True)
    messages = runs["message"].values.tolist()
    assert "ZeroDivisionError: no stiffness" in messages[2]
    assert "stopped after 1 s" in messages[5]
    assert [message == "" for message in messages] == [True, True, False, True, True, False, True]
    assert runs["attempts"].values.tolist() == [1, 1, 1, 1, 1, 1, 0]
    assert np.isnan(runs["seconds"].values).tolist() == [False] * 6 + [True]
    assert np.isnat(runs["finished"].values).tolist() == [False] * 6 + [True]
    age = np.datetime64(datetime.now(UTC).replace(tzinfo=None)) - runs["finished"].values[0]
    assert np.timedelta64(0, "s") <= age < np.timedelta64(600, "s")


def test_a_point_in_two_designs_is_two_rows_of_one_run(runs, folder):
    assert len(read(folder).records) == 5
    rows = runs.isel(run=[1, 4])
    for name in ("square", "seconds", "finished"):
        assert rows[name][0] == rows[name][1]


def test_comes_back_from_a_file_as_it_was(runs, tmp_path):
    """Bit by bit, also through xarray's own opening, and with nothing pickled in the file."""
    path = tmp_path / "results" / "runs.nc"
    rundata.save(runs, path)
    assert rundata.load(path).identical(runs)
    with xr.open_dataset(path) as opened:
        xr.testing.assert_identical(opened.load(), runs)
        assert opened["way"].attrs["levels"] == ["well", "raise", "hang"]
    assert [item.name for item in path.parent.iterdir()] == ["runs.nc"]
    with h5py.File(path) as file:
        kinds = {name: file[name].dtype for name in file}
    assert all(kind.kind in "fi" or h5py.check_string_dtype(kind) for kind in kinds.values())


def test_a_message_of_any_bytes_is_stored(tmp_path):
    """What a crashing program printed may hold NUL and broken UTF-8, which netCDF does not take."""
    space = Space((Parameter("x", uniform(0.0, 4.0)),))
    point = {"train": np.zeros((1, 1))}
    (key,) = keys(SPEC, run_inputs(SPEC, assembly.physical_columns(space, point)))
    broken = Record(key, {}, "failed", "core\0dumped \udcff é", 0.0, 1, 0.0)
    found = assembly.assemble(space, point, SPEC, JournalContents({key: broken}, tmp_path))
    rundata.save(found, tmp_path / "runs.nc")
    assert rundata.load(tmp_path / "runs.nc")["message"].values.tolist() == ["core?dumped ? é"]


def test_a_dataset_in_which_nothing_ran_comes_back(tmp_path):
    runs = assembly.assemble(SPACE, {"train": TRAIN}, SPEC, read(tmp_path))
    rundata.save(runs, tmp_path / "runs.nc")
    assert rundata.load(tmp_path / "runs.nc").identical(runs)
    assert rundata.counts(runs) == {"ok": 0, "failed": 0, "timed_out": 0, "missing": 4}
    assert rundata.seconds_left(runs) is None


@pytest.mark.parametrize("unit", ["", "days", "s", "seconds", "degC", "µm", "1/°", "hours"])
def test_units_are_words_and_never_change_numbers(tmp_path, unit):
    """A unit of time must not turn an output into dates; letters of any language survive."""

    class Timed(Misbehaving):
        outputs = {"square": Output(unit=unit)}

    execute(SPEC, {"x": [2.0]}, journal=tmp_path / "j", workers=1)
    space = Space((Parameter("x", distribution("normal", mean=2, std=1), unit=unit),))
    runs = assembly.assemble(
        space, {"train": np.zeros((1, 1))}, SolverSpec("misbehaving", Timed), read(tmp_path / "j")
    )
    rundata.save(runs, tmp_path / "runs.nc")
    back = rundata.load(tmp_path / "runs.nc")
    assert back["square"].dtype == float and back["square"].values == [4.0]
    assert back["square"].attrs["units"] == back["x"].attrs["units"] == unit


def test_levels_keep_their_names(tmp_path):
    """Level names with spaces and letters of any language, and names of coordinates."""
    levels = ("biflex 16", "Verband ü", "包帯")
    space = Space((Parameter("x", uniform(0.0, 1.0)), Parameter("kind", levels=levels)))

    class Kinds(Misbehaving):
        inputs = {
            "x": Misbehaving.inputs["x"],
            "kind": replace(Misbehaving.inputs["way"], levels=levels, nominal=None),
        }
        outputs = {"square": Output(dims=("place",), coordinates={"place": np.array(levels)})}

    coded = np.array([[0.0, -1.0], [0.0, 0.0], [0.0, 1.0]])
    runs = assembly.assemble(space, {"train": coded}, SolverSpec("kinds", Kinds), read(tmp_path))
    rundata.save(runs, tmp_path / "runs.nc")
    back = rundata.load(tmp_path / "runs.nc")
    assert back["kind"].values.tolist() == back["place"].values.tolist() == list(levels)


def test_saving_is_all_or_nothing(runs, tmp_path, monkeypatch):
    """A disk that is full leaves the earlier file, and no half of the new one."""
    path = tmp_path / "runs.nc"
    rundata.save(runs, path)

    def full(file):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ResultsError, match="cannot write .*runs.nc: No space left on device"):
        rundata.save(runs.isel(run=[0]), path)
    assert rundata.load(path).identical(runs)
    assert os.listdir(tmp_path) == ["runs.nc"]


@pytest.mark.skipif(os.name == "nt", reason="limits of POSIX")
def test_a_disk_that_fills_under_a_dataset_is_a_sentence(tmp_path):
    """HDF5 ends a process by a segmentation fault when a write of its own fails."""
    code = (
        "import resource, sys, numpy, xarray; from surrogate import errors\n"
        "from surrogate.runs import dataset\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "whole = xarray.Dataset({'x': numpy.arange(9e3)})\n"
        "for data in (whole, xarray.DataTree.from_dict({'/a/b': whole})):\n"
        "    try:\n"
        "        dataset.save(data, sys.argv[1])\n"
        "    except errors.ResultsError as error:\n"
        "        print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, tmp_path / "runs.nc"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("runs.nc: File too large; make room") == 2
    assert os.listdir(tmp_path) == []


def test_missing_and_damaged_files_are_sentences(tmp_path):
    with pytest.raises(ResultsError, match="does not exist; run the study first"):
        rundata.load(tmp_path / "runs.nc")
    (tmp_path / "runs.nc").write_bytes(b"no netCDF")
    with pytest.raises(ResultsError, match="cannot be read .* run the study again"):
        rundata.load(tmp_path / "runs.nc")


def test_training_takes_good_runs_of_the_named_designs(runs):
    coded, values = rundata.training(runs, "square")
    assert (coded == TRAIN[[0, 1, 3]]).all() and values.tolist() == [3.0, 12.0, 9.25]
    coded, values = rundata.training(runs, "ramp", ["train", "test"])
    assert coded.shape == (4, 2) and values.shape == (4, 3)
    with pytest.raises(ResultsError, match="no output 'sqare'; did you mean 'square'"):
        rundata.training(runs, "sqare")
    for name in ("x", "coded", "seconds"):
        with pytest.raises(ResultsError, match=f"no output '{name}'; Allowed: ramp, square"):
            rundata.training(runs, name)
    with pytest.raises(ResultsError, match="no runs of design 'tset'; did you mean 'test'"):
        rundata.training(runs, "square", ["tset"])


def test_training_without_a_good_run_is_empty(runs):
    bad = runs.isel(run=runs["status"].values != "ok")
    for name, shape in (("square", (0,)), ("ramp", (0, 3))):
        coded, values = rundata.training(bad, name, ["train", "test"])
        assert coded.shape == (0, 2) and values.shape == shape


def test_selects_and_counts(runs):
    assert rundata.counts(runs) == {"ok": 4, "failed": 1, "timed_out": 1, "missing": 1}
    assert rundata.select(runs, statuses=["failed", "timed_out"]).sizes["run"] == 2
    assert rundata.select(runs, designs=["test"], statuses=["ok"])["x"].values.tolist() == [3.0]
    expected = float(runs["seconds"].mean())  # of one run: a second worker is no help
    assert rundata.seconds_left(runs, workers=2) == pytest.approx(expected, rel=1e-12)
    assert rundata.seconds_left(runs.isel(run=slice(0, 6))) == 0.0


def test_repetitions_of_a_stochastic_solver_are_rows_of_their_own(tmp_path):
    space, noise = Space((Parameter("x", uniform(0.0, 1.0)),)), SolverSpec("noise", Noise)
    designs = {"train": np.zeros((3, 1)), "test": np.zeros((2, 1))}
    execute(noise, assembly.physical_columns(space, designs), journal=tmp_path, workers=2)
    runs = assembly.assemble(space, designs, noise, read(tmp_path))
    assert len(set(runs["y"].values.tolist())) == 5
    assert runs.attrs["deterministic"] == "false"


def test_names_that_stand_for_two_things_are_mistakes():
    """Each clash is a sentence, and assembling refuses with all of them."""
    space = Space(tuple(Parameter(name, uniform(0.0, 1.0)) for name in ("status", "angle", "u")))
    outputs = {
        "coded": Output(),
        "u": Output(),
        "p": Output(dims=("angle",), coordinates={"angle": np.arange(3.0)}),
        "q": Output(
            dims=("angle", "run"), coordinates={"angle": np.arange(4.0), "run": np.arange(2)}
        ),
    }
    mistakes = names.name_mistakes(space, outputs)
    for start in (
        "parameter 'status': the name is reserved",
        "output 'coded': the name is reserved",
        "dimension 'run' of output 'q': the name is reserved",
        "'u' is both a parameter and an output",
        "'angle' is both a dimension of output",
        "outputs 'p' and 'q' have different coordinates along 'angle'",
    ):
        assert sum(mistake.startswith(start) for mistake in mistakes) == 1
    assert len(mistakes) == 6
    assert names.name_mistakes(SPACE, Misbehaving.outputs) == []

    slashes = {"a/b": Output(dims=("r/z",), coordinates={"r/z": np.arange(2)})}
    assert [m.partition(":")[0] for m in names.name_mistakes(SPACE, slashes)] == [
        "output 'a/b'",
        "dimension 'r/z'",
    ]

    class Clashing(Misbehaving):
        outputs = {"message": Output()}

    with pytest.raises(StudyError, match="output 'message': the name is reserved"):
        assembly.assemble(SPACE, {"train": TRAIN}, SolverSpec("clashing", Clashing), read("none"))


def test_the_reserved_names_are_those_of_the_dataset(runs):
    own = {*SPACE.names, *Misbehaving.outputs, "place"}
    assert set(runs.variables) | {"run"} == names.RESERVED_NAMES | own
    assert json.loads(runs.attrs["solver_options"]) == {} and "well" in WAYS
