"""Only a run searches for the points of a design; `check` where they must be judged before it."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from searches import calls

from surrogate import Study
from surrogate.cli import predicting, results, serving, standing, validating
from surrogate.designs import exchange, latin_hypercube, optimal, space_filling
from surrogate.errors import ResultsError, StudyError
from surrogate.study import prediction

METHODS = ["searches:counted", "searches:judged"]
CASES = "X1,X2,X3,y\n0.1,0.2,0.3,1.0\n0.2,-0.3,0.1,1.2\n0.4,0.3,-0.1,0.9\n"


def study(train, **changes):
    calls.clear()
    fit = {"linear": {"method": "linear"}, "quadratic": {"method": "quadratic"}}
    return Study.from_mapping(
        {
            "study": "searched",
            "solver": "ishigami",
            "parameters": {name: [-1, 1] for name in ("X1", "X2", "X3")},
            "designs": {"train": train},
            "surrogates": fit,
            **changes,
        }
    )


def run(one, folder):
    with ThreadPoolExecutor(1) as executor:
        return one.run(results=folder, executor=executor)


def verbs(one, folder, cases):
    """Each verb that runs nothing, but for `check`."""
    point = ["X1=0", "X2=0", "X3=0"]
    return {
        "status": lambda: standing.status(one, folder),
        "report": lambda: results.analyse(one, folder, again=True),
        "predict": lambda: prediction.predict(one, folder, None, point, None),
        "validate": lambda: results.validate(one, folder, cases),
        "store": lambda: results.store(one, folder, folder / "stored.nc"),
        "serve": lambda: serving.surrogate_model(one, folder, None),
    }


@pytest.fixture
def cases(tmp_path):
    (tmp_path / "cases.csv").write_text(CASES)
    return tmp_path / "cases.csv"


@pytest.mark.parametrize("method", METHODS)
def test_no_verb_searches_for_a_study_without_runs(tmp_path, cases, method):
    """Each verb says that there are no runs; reading and counting need no points."""
    one = study({"method": method, "runs": 14})
    for name, verb in verbs(one, tmp_path / "r", cases).items():
        if name == "status":
            assert verb().data["runs"]["missing"] == 14
        else:
            with pytest.raises(ResultsError, match=r"no (finished )?runs?"):
                verb()
    assert calls == []


@pytest.mark.parametrize("method", METHODS)
def test_no_verb_searches_for_a_design_that_was_added(tmp_path, cases, method):
    """The report tells of the new design and is made from the runs that there are."""
    train = {"method": method, "runs": 14}
    run(study(train), tmp_path)
    assert calls == [14]
    test = {"method": method, "runs": 5, "seed": 3}
    two = study(train, designs={"train": train, "test": test})
    for verb in verbs(two, tmp_path, cases).values():
        verb()
    done = results.analyse(two, tmp_path, again=True)
    assert done.summary["runs"]["ok"] == 14
    (told,) = done.summary["not_done"]
    assert told == "design test: its 5 points are not found yet, and none of its runs is done; " \
        "do `surrogate run`"  # fmt: skip
    assert told in done.trouble
    assert told in results.validate(two, tmp_path, cases)[0].attrs["notes"]
    assert calls == []
    whole = results.analyse(two, tmp_path, run(two, tmp_path))
    assert calls == [5] and whole.fresh and whole.summary["not_done"] == []


def test_surrogates_of_a_design_without_points_are_not_done(tmp_path):
    """Those of the other designs are."""
    train = {"method": "searches:counted", "runs": 14}
    run(study(train), tmp_path)
    late = {"method": "linear", "train": ["more"]}
    two = study(
        train,
        designs={"train": train, "more": {"method": "searches:counted", "runs": 9, "seed": 3}},
        surrogates={"linear": {"method": "linear"}, "late": late},
    )
    done = results.analyse(two, tmp_path)
    assert done.summary["comparison"]["surrogate"]["values"][0] == "linear"
    assert any("late" in sentence for sentence in done.summary["not_done"])
    assert calls == []


def test_check_searches_for_what_it_judges_only(tmp_path):
    """Points that all differ need no judgement; others may be too few or be aliased."""
    standing.check(study({"method": "searches:counted", "runs": 14}), tmp_path)
    assert calls == []
    one = study({"method": "searches:judged", "runs": 14})
    standing.check(one, tmp_path)
    assert calls == [14]
    run(one, tmp_path)
    standing.check(study({"method": "searches:judged", "runs": 14}), tmp_path)
    assert calls == []


@pytest.mark.parametrize("act", [standing.check, run])
def test_points_that_are_too_few_are_told_before_a_run(tmp_path, act):
    """A design with as many runs as coefficients, but one point, is no design for them."""
    with pytest.raises(StudyError, match="surrogates.quadratic: quadratic has 10 .* has 1 diff"):
        act(study({"method": "searches:one_point", "runs": 14}), tmp_path)
    assert not (tmp_path / "journal").exists()


def test_what_an_augmentation_refuses_is_told_with_its_place(tmp_path):
    """Mirrored runs that a search has found already are not there when the study is read."""
    more = [{"method": "fold_over"}]
    one = study(
        {"method": "searches:one_point", "runs": 14, "augment": more},
        surrogates={"l": {"method": "linear"}},
    )
    with pytest.raises(StudyError, match="designs.train: fold_over adds nothing"):
        run(one, tmp_path)


@pytest.mark.parametrize("method", ["latin_hypercube", "d_optimal"])
def test_the_searches_that_come_along_are_marked(tmp_path, monkeypatch, method):
    """Reading optimises nothing."""
    monkeypatch.setattr(latin_hypercube, "maximin", None)
    monkeypatch.setattr(exchange, "_search", None)
    one = study({"method": method, "runs": 14})
    assert standing.status(one, tmp_path).data["runs"]["missing"] == 14


@pytest.mark.parametrize(
    "more, points",
    [({"method": "space_filling"}, 19), ({"method": "d_optimal", "model": "linear"}, 19)],
)
def test_augmentations_that_search_are_searches(tmp_path, monkeypatch, more, points):
    """They count their points at reading, find them for a run, and are not found again."""
    asked = {"method": "sobol", "runs": 14, "augment": [{**more, "runs": 5}]}
    with monkeypatch.context() as stopped:
        stopped.setattr(optimal, "best_of", None)
        stopped.setattr(space_filling, "scattered", None)
        one = study(asked, surrogates={"l": {"method": "linear"}})
        assert standing.status(one, tmp_path).data["runs"]["missing"] == points
    run(one, tmp_path)
    monkeypatch.setattr(optimal, "best_of", None)
    monkeypatch.setattr(space_filling, "scattered", None)
    again = study(asked, surrogates={"l": {"method": "linear"}})
    assert standing.status(again, tmp_path).data["runs"]["ok"] == points


def test_an_augmentation_that_cannot_be_is_told_at_reading():
    """Fewer runs in all than the model has terms."""
    more = [{"method": "d_optimal", "runs": 1, "model": "quadratic"}]
    with pytest.raises(StudyError, match="give at least 6"):
        study({"method": "sobol", "runs": 4, "augment": more})


def test_check_shows_the_aliasing_of_a_d_optimal_design(tmp_path):
    """The four runs from which three parameters are estimated best: the half fraction."""
    one = study({"method": "d_optimal", "runs": 4, "seed": 1}, surrogates={})
    assert standing.check(one, tmp_path).data["aliasing"]["train"]["resolution"] == 3


def test_predict_and_validate_tell_how_far_their_fits_are(tmp_path, cases):
    """As an analysis does; what is kept is not fitted again and not told."""
    one, steps = study({"method": "searches:counted", "runs": 14}), []
    run(one, tmp_path)
    point = ["X1=0", "X2=0", "X3=0"]
    predicting.predict(one, tmp_path, "linear", point, None, steps.append)
    assert [step.label for step in steps if step.stage == "fits"] == ["linear of y", ""]
    validating.validate(one, tmp_path, cases, steps.append)
    labels = [step.label for step in steps if step.stage == "fits"]
    assert labels == ["linear of y", "", "quadratic of y", ""]
