"""Searched designs: found once, for a run; kept; never moved by a later version of the search."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from surrogate import Study
from surrogate.cli import standing
from surrogate.designs import latin_hypercube as module
from surrogate.errors import ResultsError, StudyError
from surrogate.runs import dataset as rundata
from surrogate.runs import stored
from surrogate.study import prediction

DATA = {
    "study": "kept",
    "solver": "ishigami",
    "parameters": {name: [-1, 1] for name in ("X1", "X2", "X3")},
    "designs": {"train": {"method": "latin_hypercube", "runs": 12}},
    "surrogates": {"linear": {"method": "linear"}},
}


def study(**changes):
    return Study.from_mapping({**DATA, **changes})


def run(one, folder):
    with ThreadPoolExecutor(1) as executor:
        return one.run(results=folder, executor=executor)


@pytest.fixture
def searches(monkeypatch):
    """Runs of each search there was."""
    seen, search = [], module.maximin

    def counted(ranks, rng, effort):
        seen.append(len(ranks))
        return search(ranks, rng, effort)

    monkeypatch.setattr(module, "maximin", counted)
    return seen


@pytest.fixture
def another_search(monkeypatch):
    """A later version of the search that finds other points."""
    monkeypatch.setattr(module, "maximin", lambda ranks, rng, effort: ranks[::-1])


def test_no_verb_searches_before_a_run(tmp_path, searches):
    """`check` and `status` count the runs of a fresh study, `predict` says that there are none."""
    one = study(designs={"train": {"method": "latin_hypercube", "runs": 1000}})
    assert standing.check(one, tmp_path).data["runs"]["missing"] == 1000
    assert standing.status(one, tmp_path).data["runs"]["missing"] == 1000
    with pytest.raises(ResultsError, match="no finished runs"):
        prediction.predict(one, tmp_path, None, ["X1=0", "X2=0", "X3=0"], None)
    assert searches == []


def test_check_searches_for_no_points_to_hold_against_constraints(tmp_path, searches):
    """The bandage declares constraints: those of points that are not found yet are not counted."""
    parameters = {"nu12": [0.0, 0.4], "K2": [0.05, 0.3], "stretch": [1.2, 1.4]}
    one = study(solver="leg_bandage", parameters=parameters, outputs=["pressure_b1"])
    assert standing.check(one, tmp_path).data["broken_constraints"] == {}
    assert searches == []


def test_a_design_is_found_once(tmp_path, searches):
    """The first run searches; later verbs, in other processes, read the points."""
    runs = run(study(), tmp_path)
    assert searches == [12]
    again = study()
    assert standing.check(again, tmp_path).data["runs"]["ok"] == 12
    assert standing.status(again, tmp_path).data["runs"]["ok"] == 12
    assert prediction.predict(again, tmp_path, None, ["X1=0", "X2=0", "X3=0"], None).rows
    np.testing.assert_array_equal(run(again, tmp_path)["coded"], runs["coded"])
    assert searches == [12]


def test_a_new_design_beside_a_kept_one_is_counted(tmp_path, searches):
    """Runs of the design that is to be found are left to do; those of the other are done."""
    run(study(), tmp_path)
    more = [{"method": "center_points", "runs": 2}]
    test = {"method": "latin_hypercube", "runs": 6, "seed": 1, "augment": more}
    two = study(designs={**DATA["designs"], "test": test})
    counts = standing.status(two, tmp_path).data["runs"]
    assert (counts["ok"], counts["missing"]) == (12, 8)
    found = prediction.predict(two, tmp_path, None, ["X1=0", "X2=0", "X3=0"], None)
    assert len(found.rows) == 1 and found.note.startswith("8 runs of the study are not done yet")
    assert searches == [12]
    assert run(two, tmp_path).sizes["run"] == 20


@pytest.mark.parametrize(
    "change",
    [
        {"parameters": {name: [-1, 1] for name in ("X1", "X3", "X2")}},
        {"parameters": {**DATA["parameters"], "X2": [-1, 2]}},
        {"designs": {"train": {"method": "latin_hypercube", "runs": 12, "seed": 3}}},
        {"designs": {"train": {"method": "latin_hypercube", "runs": 13}}},
    ],
)
def test_another_study_has_another_design(tmp_path, searches, change):
    """Space, options and seed belong to the identity of a design."""
    run(study(), tmp_path)
    run(study(**change), tmp_path)
    assert len(searches) == 2


def test_stored_runs_keep_their_points(tmp_path, another_search, monkeypatch):
    """Runs that ship with a study count whatever the search finds today."""
    with monkeypatch.context() as patch:
        patch.undo()
        runs = run(study(), tmp_path / "first")
    stored.write(runs, tmp_path / "runs.nc")
    shipped = study(stored=str(tmp_path / "runs.nc"))
    found = shipped.stored(tmp_path / "second")
    assert shipped.unused == []
    assert (found["status"] == "ok").all()
    np.testing.assert_array_equal(found["coded"], runs["coded"])


def test_results_of_before_keep_their_points(tmp_path, another_search, monkeypatch):
    """A results folder without designs/, as 0.1.0 left it, holds the points in runs.nc."""
    with monkeypatch.context() as patch:
        patch.undo()
        runs = run(study(), tmp_path)
    for path in (tmp_path / "designs").iterdir():
        path.unlink()
    rundata.save(runs, tmp_path / "runs.nc")
    np.testing.assert_array_equal(study().stored(tmp_path)["coded"], runs["coded"])


@pytest.mark.parametrize("damage", [lambda text: text[:50], lambda text: text.replace("0.", "0.0")])
def test_a_damaged_file_is_told(tmp_path, damage):
    """Points that were not written are not used."""
    run(study(), tmp_path)
    (path,) = (tmp_path / "designs").iterdir()
    path.write_text(damage(path.read_text()))
    with pytest.raises(ResultsError, match="is damaged"):
        study().stored(tmp_path)


def test_options_are_checked_without_a_search(searches):
    """A mistake is told at once, with its place."""
    with pytest.raises(StudyError, match="designs.train: effort: 0 must be a number"):
        study(designs={"train": {"method": "latin_hypercube", "runs": 9, "effort": 0}})
    assert searches == []
