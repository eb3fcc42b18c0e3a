"""Promises are put to the test by runs of the solver, which become a design of the study."""

import json

import numpy as np
import pytest

from surrogate.errors import ResultsError
from surrogate.stages.solve import figures_of
from surrogate.study import solving
from surrogate.study.analysis import walk
from surrogate.study.solving import Goals, stated
from surrogate.study.study import Study

TEXT = """\
study: line
solver: {name: borehole}
parameters:
  rw: [0.05, 0.15]
  L: {range: [1120, 1680], unit: m}
designs:
  train: {method: latin_hypercube, runs: 16, seed: 1}
surrogates: {quadratic: {method: quadratic}, gp: {method: gaussian_process}}
solve:
  eighty: {target: {flow: [75, 85]}}
  sure:   {target: {flow: [60, 100]}, free: [rw], uncertain: [L], probability: 0.8}
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    study = Study.from_text(TEXT)
    folder = tmp_path_factory.mktemp("line")
    study.run(results=folder, workers=1)
    return study, folder


def solved(finished, name, **how):
    """The solution of a goal, verified by the solver."""
    study, folder = finished
    answer = solving.solve(study, folder, stated(study, name, Goals()))
    return solving.check(study, folder, answer, workers=1, **how).solution


def test_verified_candidates_carry_what_the_solver_says(finished):
    study, folder = finished
    before = study.stored(folder).sizes["run"]
    found = solved(finished, "eighty")
    solver = study.spec.solver
    for one in found.candidates:
        answer = float(
            solver(**{**{n: i.nominal for n, i in solver.inputs.items()}, **one.inputs})["flow"]
        )
        assert one.verified.values["flow"] == (pytest.approx(answer, rel=1e-12),)
        assert one.verified.met == (75.0 <= answer <= 85.0)
    again = Study.from_text(TEXT).stored(folder)
    assert again.sizes["run"] == before + len(found.candidates)
    assert set(again["design"].values) == {"train", "verified_eighty"}
    assert walk(Study.from_text(TEXT), folder).value("solve")["eighty"] == found
    data = figures_of(found)["candidates"][0]
    assert data["kept"] == {"runs": 1, "met": found.candidates[0].verified.met, "failed": 0}
    assert set(data) >= {"inputs", "predicted", "probability", "verified"}
    assert set(data["predicted"]["flow"]) == {"value", "low", "high"}
    json.dumps(data)


def test_verifying_again_runs_nothing_twice(finished):
    solved(finished, "eighty")
    study, folder = finished
    journal = sorted(study.journal(folder).glob("*.jsonl"))
    before = sum(len(path.read_bytes()) for path in journal)
    solved(finished, "eighty")
    assert sum(len(path.read_bytes()) for path in journal) == before


def test_verifying_leaves_other_missing_runs_alone(finished):
    _, folder = finished
    wider = Study.from_text(
        TEXT.replace("surrogates:", "  more: {method: halton, runs: 5}\nsurrogates:")
    )
    asked = []
    answer = solving.solve(wider, folder, stated(wider, "sure", Goals()))
    found = solving.check(wider, folder, answer, runs=3, workers=1, progress=asked.append).solution
    assert found.candidates[0].verified.runs >= 3
    assert asked[-1].done == asked[-1].total
    runs = Study.from_text(wider.text).stored(folder)
    status = runs["status"].values[runs["design"].values == "more"]
    assert status.tolist() == ["missing"] * 5


def test_with_uncertain_inputs_the_best_candidate_is_run_at_draws_of_their_law(finished):
    found = solved(finished, "sure", runs=12)
    best, *others = found.candidates
    assert best.verified.runs == 12
    assert all(one.verified is None for one in others)
    share, low, high = best.verified.share
    assert low <= best.probability <= high
    study, folder = finished
    runs = Study.from_text(TEXT).stored(folder)
    rows = runs.isel(run=np.flatnonzero(runs["design"].values == "verified_sure"))
    assert len(np.unique(rows["L"])) == 12 and len(np.unique(rows["rw"])) == 1


def test_no_surrogate_learns_from_verifying_runs(finished):
    study, folder = finished
    solved(finished, "eighty")
    fits = walk(Study.from_text(TEXT), folder).value("fits")
    assert len(fits["gp"]["flow"].values) == 16


def test_a_study_may_learn_from_its_verifying_runs(finished):
    study, folder = finished
    count = len(solved(finished, "eighty").candidates)
    wider = TEXT.replace(
        "{method: quadratic}", "{method: quadratic, train: [train, verified_eighty]}"
    )
    fits = walk(Study.from_text(wider), folder).value("fits")
    assert len(fits["quadratic"]["flow"].values) == 16 + count


def test_a_damaged_file_of_points_is_a_sentence(finished, tmp_path):
    path = tmp_path / "designs" / "verified_eighty.json"
    path.parent.mkdir()
    path.write_text("{")
    with pytest.raises(ResultsError, match="is damaged"):
        Study.from_text(TEXT).stored(tmp_path)


def test_points_that_the_parameters_no_longer_hold_are_left_out(finished):
    study, folder = finished
    solved(finished, "eighty")
    narrow = Study.from_text(TEXT.replace("[0.05, 0.15]", "[0.149, 0.15]"))
    assert "verified_eighty" not in set(narrow.stored(folder)["design"].values)


def test_a_study_with_goals_answers_them_in_its_files(finished):
    study, folder = finished
    solved(finished, "eighty")
    walk(Study.from_text(TEXT), folder).write()
    summary = json.loads((folder / "summary.json").read_text())["solve"]
    assert set(summary) == {"eighty", "sure"}
    page = (folder / "report.html").read_text()
    assert "Inputs that reach the goals" in page and "Crosses: what the solver said" in page
    import xarray as xr

    tree = xr.open_datatree(folder / "solve.nc", engine="h5netcdf")
    assert tree["eighty"]["probability"].sizes == {
        "candidate": len(summary["eighty"]["candidates"])
    }
