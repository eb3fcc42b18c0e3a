"""Studies with levels of fidelity: runs of each, the truth in every result, all mistakes."""

import numpy as np
import pytest
from fidelities import Toy

from surrogate import Study
from surrogate.errors import StudyError
from surrogate.runs import dataset as rundata
from surrogate.runs.levels import costs
from surrogate.stages.fits import lower_runs


def toy(**changed):
    words = {
        "study": "toy",
        "solver": "fidelities:Toy",
        "parameters": {"a": [0, 1], "b": [0, 1]},
        "levels": {"cheap": {"options": {"mesh": "coarse"}}, "true": {}},
        "designs": {
            "pairs": {"method": "nested", "runs": {"cheap": 32, "true": 8}, "seed": 1},
            "test": {"method": "latin_hypercube", "runs": 12, "seed": 7},
        },
        "surrogates": {
            "mf": {"method": "cokriging", "train": "pairs"},
            "gp": {"method": "gaussian_process", "train": "pairs"},
        },
        **changed,
    }
    return Study.from_mapping({key: part for key, part in words.items() if part is not None})


def value(runs, mesh):
    return [Toy(mesh)(a, b, 1.0)["y"] for a, b in zip(*(runs[n].values for n in "ab"), strict=True)]


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("levels") / "toy"
    study = toy()
    return study, study.run(workers=1, results=folder), folder


def test_each_row_is_of_its_level(done):
    """Cheap rows first, then the truth at points among them; the test design is the truth."""
    runs = done[1]
    assert runs["level"].values.tolist() == ["cheap"] * 32 + ["true"] * 20
    cheap, true = rundata.at_level(runs, "cheap"), rundata.at_level(runs)
    np.testing.assert_allclose(cheap["y"].values, value(cheap, "coarse"))
    np.testing.assert_allclose(true["y"].values, value(true, "fine"))
    points = set(map(tuple, cheap["coded"].values.round(9)))
    assert set(map(tuple, true["coded"].values[:8].round(9))) <= points


def test_results_are_of_the_truth(done):
    """Both surrogates are judged on the truth; other than co-kriging, they learn from it alone."""
    study, runs, _ = done
    fits = study.fit(runs)
    assert [len(fits[name]["y"].values) for name in ("mf", "gp")] == [8, 8]
    table = study.compare(fits, runs)
    errors = dict(zip(table["surrogate"].values, table["rmse_test"].values[:, 0], strict=True))
    assert errors["mf"] < 0.2 * errors["gp"]
    assert float(table["q2_test"].sel(surrogate="mf", output="y")) > 0.999
    assert study.best(table) == {"y": "mf"}
    assert rundata.output_names(runs) == ["y"]
    lower = lower_runs(study.surrogates["mf"], "y", runs)
    assert [len(one.values) for one in lower] == [32] and lower[0].inputs == (0, 1)


def test_a_second_call_runs_nothing_and_what_is_done_counts_by_level(done):
    study, runs, folder = done
    again = toy().run(workers=1, results=folder)
    assert (again["finished"].values == runs["finished"].values).all()
    found = costs(toy().stored(folder))
    assert {name: one["runs"]["ok"] for name, one in found.items()} == {"cheap": 32, "true": 20}
    assert found["cheap"]["seconds"] == pytest.approx(
        rundata.at_level(runs, "cheap")["seconds"].values.sum()
    )


def test_the_call_of_a_row_gives_its_answer_again(done):
    study, runs, _ = done
    for row in (0, 35):
        call, answer = rundata.call_and_answer(runs, row)
        assert study.spec.solver(**call)["y"] == answer["y"]


def test_a_study_of_one_level_has_the_same_runs(done):
    """Identities are those of the level's own solver."""
    folder, designs = done[2], {"test": toy().words["designs"]["test"]}
    alone = toy(study="alone", levels=None, designs=designs, surrogates={})
    asked = alone.found(folder.parent / "alone").asked(folder.parent / "alone")
    assert asked.keys == toy().asked(folder).keys[-12:]


def test_stored_runs_hold_all_levels(done, tmp_path):
    """A file of the study serves it, a study of the truth, and one with fewer cheap runs."""
    from surrogate.runs import stored

    study, runs, folder = done
    stored.write(runs, tmp_path / "runs.nc")
    study = toy(stored=[str(tmp_path / "runs.nc")])
    assert rundata.counts(study.stored(tmp_path / "none"))["ok"] == 52
    assert study.unused == []


def test_a_cheap_level_with_fewer_inputs(tmp_path):
    """Its solver is not called with the inputs that it does not take."""
    study = toy(levels={"blind": {"solver": "fidelities:Blind"}, "true": {}}, designs={
        "pairs": {"method": "nested", "runs": {"blind": 32, "true": 12}, "seed": 1},
    })  # fmt: skip
    runs = study.run(workers=1, results=tmp_path / "toy")
    cheap = rundata.at_level(runs, "blind")
    np.testing.assert_allclose(cheap["y"].values, np.sin(6 * cheap["a"].values) + 1.0)
    fits = study.fit(runs)
    assert fits["mf"]["y"].estimator.lower[0].inputs == (0,)
    assert fits["mf"]["y"].q2 > fits["gp"]["y"].q2


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"levels": {"true": {}}}, "levels: name at least two levels"),
        ({"levels": None}, "designs.pairs.runs: runs name levels of fidelity, but the study has"),
        ({"levels": None}, "surrogates.mf.method: cokriging learns from levels of fidelity"),
        (
            {"levels": {"low": {"options": {"mesh": "coarse"}}, "true": {}}},
            "level 'cheap' is unknown",
        ),
        (
            {"levels": {"cheap": {"options": {"mush": "coarse"}}, "true": {}}},
            "levels.cheap.options",
        ),
        (
            {"levels": {"cheap": {"solver": "fidelities:Inches"}, "true": {}}},
            "output 'y' is in inch, of the last level in mm",
        ),
        (
            {"surrogates": {"mf": {"method": "cokriging", "train": "even"}}, "designs": {
                "even": {"method": "latin_hypercube", "runs": 20},
            }},
            "cokriging needs runs of every level",
        ),
    ],
)  # fmt: skip
def test_mistakes(changed, sentence):
    with pytest.raises(StudyError, match=sentence.replace(".", r"\.")):
        toy(**changed)


def test_a_level_may_be_called_true_without_quotes():
    """YAML takes true for a boolean."""
    study = Study.from_text(
        "study: toy\nsolver: fidelities:Toy\nparameters: {a: [0, 1]}\n"
        "levels: {cheap: {options: {mesh: coarse}}, true: {}}\n"
        "designs:\n  pairs: {method: nested, runs: {cheap: 8, true: 4}}\n"
        "surrogates:\n  mf: {method: cokriging, train: pairs}\n"
    )
    assert study.designs["pairs"].levels == ["cheap"] * 8 + ["true"] * 4
