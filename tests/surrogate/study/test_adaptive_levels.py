"""Adaptive designs that choose levels of fidelity, and designs with a budget of seconds."""

import numpy as np
import pytest

from surrogate import Study
from surrogate.adaptive.judge import SPENT
from surrogate.errors import StudyError
from surrogate.runs import dataset as rundata
from surrogate.study.grown_designs import states

ADAPTIVE = {
    "method": "adaptive",
    "initial": {"method": "nested", "runs": {"cheap": 8, "true": 4}, "seed": 1},
    "aim": "accuracy",
    "until": {"seconds": "150 s"},
}


def toy(true=10, **changed):
    words = {
        "study": "toy",
        "solver": "fidelities:Toy",
        "parameters": {"a": [0, 1], "b": [0, 1]},
        "levels": {
            "cheap": {"options": {"mesh": "coarse"}, "seconds": 1},
            "true": {"seconds": true},
        },
        "designs": {
            "train": {**ADAPTIVE, **changed},
            "test": {"method": "latin_hypercube", "runs": 12, "seed": 7},
        },
        "surrogates": {"mf": {"method": "cokriging"}},
    }
    return Study.from_mapping(words)


def counted(runs):
    """Runs of the adaptive design at each level."""
    own = rundata.select(runs, designs=["train"])
    return {name: rundata.at_level(own, name).sizes["run"] for name in ("cheap", "true")}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("levels") / "toy"
    study = toy()
    return study, study.run(workers=1, results=folder), folder


def test_the_seconds_are_spent_and_not_more(done):
    study, runs, folder = done
    own = counted(runs)
    spent = own["cheap"] + 10 * own["true"]
    assert own["true"] > 4 and own["cheap"] > 8
    assert 149 <= spent <= 150
    outcome = study.outcomes(folder)["train"]
    assert outcome.ended == SPENT and outcome.reviews[-1].spent == spent
    assert f"{spent} of at most 150 s of the solver" in str(outcome)
    assert "the seconds are spent" in str(outcome)
    assert outcome.ahead == 0


def test_points_of_the_truth_are_among_the_cheap_ones(done):
    own = rundata.select(done[1], designs=["train"])
    cheap, true = (
        set(map(tuple, rundata.at_level(own, name)["coded"].values.round(9)))
        for name in ("cheap", "true")
    )
    assert true <= cheap
    assert len(cheap) == counted(done[1])["cheap"]  # no run twice


def test_a_dear_truth_is_run_less(done, tmp_path):
    """With as many seconds left for it, fewer runs of the truth are asked for each cheap one."""
    equal = counted(toy(true=1, until={"runs": 40}).run(workers=1, results=tmp_path))
    dear = counted(done[1])
    assert dear["true"] / dear["cheap"] < equal["true"] / equal["cheap"]


def test_a_larger_budget_goes_on_where_it_was(done):
    _, runs, folder = done
    study = toy(until={"seconds": 200})
    more = study.run(workers=1, results=folder)
    before, after = (rundata.select(one, designs=["train"])["coded"].values for one in (runs, more))
    assert len(after) > len(before)
    np.testing.assert_array_equal(after[: len(before)], before)
    again = study.run(workers=1, results=folder)
    assert counted(again) == counted(more)


def test_stored_runs_know_the_levels_that_were_chosen(done, tmp_path):
    """From the dataset of runs alone the design stands as it was, and nothing is run again."""
    study, runs, folder = done
    again = states(study.rules, study.designs, tmp_path, [runs])["train"]
    kept = states(study.rules, study.designs, folder, [])["train"]
    count = len(again.points)  # of a larger budget the folder may hold more
    np.testing.assert_allclose(again.points, kept.points[:count])
    assert again.levels == kept.levels[:count] and {"cheap", "true"} == set(again.levels)
    assert again.reviews == kept.reviews[: len(again.reviews)]


def test_batches_are_the_same_with_any_number_of_workers(tmp_path):
    one, two = (
        toy(batch=3, until={"runs": 24}).run(workers=n, results=tmp_path / str(n)) for n in (1, 2)
    )
    np.testing.assert_array_equal(one["coded"], two["coded"])
    np.testing.assert_array_equal(one["level"], two["level"])


def test_seconds_of_a_single_level_are_those_that_runs_have_taken(tmp_path):
    """A budget that the initial runs have used up lets no point be chosen."""
    words = {
        "study": "one",
        "solver": "fidelities:Toy",
        "parameters": {"a": [0, 1], "b": [0, 1]},
        "designs": {
            "train": {
                **ADAPTIVE,
                "initial": {"method": "latin_hypercube", "runs": 8},
                "until": {"seconds": 1e-9, "runs": 20},
            }
        },
        "surrogates": {"gp": "gaussian_process"},
    }
    study = Study.from_mapping(words)
    assert study.run(workers=1, results=tmp_path / "one").sizes["run"] == 8
    assert study.outcomes(tmp_path / "one")["train"].ended == SPENT
    words["designs"]["train"]["until"] = {"seconds": 3600, "runs": 12}
    assert Study.from_mapping(words).run(workers=1, results=tmp_path / "one").sizes["run"] == 12


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"until": {"q2": 0.9}}, "give runs: 120, or seconds: 2 h, or both"),
        ({"aim": "index_width"}, "aim index_width has runs of the last level only"),
        (
            {"initial": {"method": "nested", "runs": {"cheep": 8, "true": 4}}},
            "level 'cheep' is unknown",
        ),
        ({"until": {"seconds": 0}}, "seconds 0: must be above 0"),
    ],
)
def test_mistakes(changed, sentence):
    with pytest.raises(StudyError, match=sentence):
        toy(**changed)
