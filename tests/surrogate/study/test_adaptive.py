"""Adaptive designs end to end: resumed, shared, told, with constraints, levels and failures."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
import yaml
from in_process import command

from surrogate import Campaign, Study
from surrogate.adaptive.judge import REACHED, USED_UP
from surrogate.errors import ResultsError, StudyError
from surrogate.execution.shared.work import Shared

SOLVER = '''
import os, signal
import numpy as np
from surrogate.errors import SolverError
from surrogate.solver import Input, Output


class Bowl:
    """Smallest at (0.3, -0.2) with gas b; without an answer where x > 0.8."""

    version = "1"
    inputs = {
        "x": Input(nominal=0.0, range=(-1.0, 1.0)),
        "y": Input(nominal=0.0, range=(-1.0, 1.0)),
        "n": Input(nominal=1.0, range=(0.0, 9.0)),
        "gas": Input(nominal="a", levels=("a", "b")),
    }
    outputs = {"depth": Output(unit="mm")}

    def __init__(self, fails: bool = False, dies_after: int = 0):
        self.fails, self.left = fails, dies_after
        self.identity_options = {"fails": fails}

    def __call__(self, x, y, n, gas):
        self.left -= 1
        if self.left == 0:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.fails and x > 0.8:
            raise SolverError("too far to the right")
        away = (x - 0.3) ** 2 + (y + 0.2) ** 2
        return {"depth": away + 0.1 * n + 0.5 * (gas == "a") + 0.1 * np.sin(5 * x) * y}
'''
STUDY = {
    "study": "bowl",
    "solver": {"name": "bowl:Bowl"},
    "parameters": {"x": [-1, 1], "y": [-1, 1]},
    "designs": {
        "train": {
            "method": "adaptive",
            "initial": {"method": "latin_hypercube", "runs": 8},
            "aim": "optimum",
            "minimise": "depth",
            "until": {"runs": 15},
        },
        "test": {"method": "halton", "runs": 12},
    },
    "surrogates": {"gp": "gaussian_process"},
    "execution": {"executor": "serial"},
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "bowl.py").write_text(SOLVER)
    sys.modules.pop("bowl", None)
    yield tmp_path
    sys.modules.pop("bowl", None)


def written(folder, **changes):
    """The study in a file, with keys of `train` and of the study changed."""
    data = json.loads(json.dumps(STUDY))
    for key, value in changes.items():
        where = data["designs"]["train"] if key in TRAIN else data
        where[key] = value
        if value is None:
            del where[key]
    (folder / "bowl.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    return Study.from_yaml(folder / "bowl.yaml")


TRAIN = ("initial", "aim", "until", "batch", "minimise", "maximise", "target", "output", "above")


def chosen(runs, name="train", initial=8):
    return runs["coded"].values[runs["design"].values == name][initial:]


def test_a_study_finds_the_smallest_value_and_says_why_it_ended(folder):
    study = written(folder, until={"runs": 40, "gain": "0.002 mm"})
    runs = study.run()
    found = study.outcomes()["train"]
    assert found.ended == REACHED and 8 < found.rows < 40
    depth = runs["depth"].values[runs["design"].values == "train"]
    assert depth.min() < study.run()["depth"].values[:8].min()
    assert found.reviews[-1].estimate == pytest.approx(depth.min(), abs=0.01)
    told = json.loads(runs.attrs["adaptive"])["train"]
    assert told["ended"] == REACHED and "the goal is reached" in told["sentence"]
    assert f"{found.rows} of at most 40 runs, aim: the smallest depth" in str(found)


def test_a_study_that_is_resumed_chooses_the_same_points(folder, tmp_path):
    """Run by run: each state of the folder leads to the same end (one place)."""
    study = written(folder)
    whole = study.run(results=tmp_path / "whole" / "bowl")
    short = written(folder, until={"runs": 11})
    short.run(results=tmp_path / "parts" / "bowl")
    assert short.outcomes(tmp_path / "parts" / "bowl")["train"].ended == USED_UP
    again = written(folder).run(results=tmp_path / "parts" / "bowl")
    first = chosen(whole)
    assert len(first) == 7 and np.array_equal(chosen(again)[:3], first[:3])


def test_kill_9_changes_no_point(folder):
    """The process dies at a run that was chosen; what follows is what would have followed."""
    whole = chosen(written(folder).run(results=folder / "whole" / "bowl"))
    written(folder, until={"runs": 8}).run()
    study = written(folder, solver={"name": "bowl:Bowl", "options": {"dies_after": 5}})
    script = "from surrogate import Study; Study.from_yaml('bowl.yaml').run()"
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    ends = [
        subprocess.run([sys.executable, "-c", script], cwd=folder, env=environment).returncode
        for _ in range(2)
    ]
    assert ends == [-signal.SIGKILL, 0]
    assert np.array_equal(chosen(study.stored()), whole)


def test_a_batch_gives_the_same_points_whatever_the_number_of_workers(folder):
    one = written(folder, batch=3, until={"runs": 14})
    alone = one.run(results=folder / "one" / "bowl")
    three = written(folder, batch=3, until={"runs": 14}, execution={"executor": "threads"})
    together = three.run(results=folder / "three" / "bowl", workers=3)
    assert len(chosen(alone)) == 6 and np.array_equal(chosen(alone), chosen(together))


def test_free_places_get_a_point_each_at_once(folder):
    """Three places and no batch: points under way are counted, none is chosen twice."""
    study = written(folder, execution={"executor": "threads"})
    runs = study.run(workers=3)
    train = runs["coded"].values[runs["design"].values == "train"]
    assert len(train) == 15 == len(np.unique(train, axis=0))
    assert (runs["status"].values == "ok").all()


def test_workers_that_share_the_folder_grow_one_design(folder):
    study = written(folder, until={"runs": 12})
    runs = study.run(executor=Shared(), workers=1)
    assert len(chosen(runs)) == 4 and (runs["status"].values == "ok").all()
    assert study.outcomes()["train"].ended == USED_UP


def test_a_campaign_asks_for_points_that_follow_from_what_is_told(folder):
    """Told one by one it takes the path of the serial run."""
    whole = chosen(written(folder).run(results=folder / "whole" / "bowl"))
    study = written(folder)
    solver = study.spec.solver
    with Campaign(study) as campaign:
        assert campaign.left == 27
        while points := campaign.ask(1):
            campaign.tell(points[0], solver(**points[0].inputs))
        assert campaign.left == 0 and np.array_equal(chosen(campaign.runs()), whole)


def test_a_campaign_chooses_several_points_before_any_is_told(folder):
    with Campaign(written(folder)) as campaign:
        solver = campaign.study.spec.solver
        first = campaign.ask(20)
        campaign.tell(first, [solver(**point.inputs) for point in first])
        more = campaign.ask(4)
        places = {(point.inputs["x"], point.inputs["y"]) for point in more}
        assert len(more) == len(places) == 4 and {point.design for point in more} == {"train"}


def test_integers_levels_and_constraints_are_kept(folder):
    study = written(
        folder,
        parameters={
            "x": [-1, 1],
            "y": [-1, 1],
            "n": {"range": [0, 9], "integer": True},
            "gas": {"levels": ["a", "b"]},
        },
        constraints=["x + y <= 0.2"],
        until={"runs": 20},
    )
    runs = study.run()
    assert study.space.contains(runs["coded"].values).all()
    late = runs.isel(run=np.flatnonzero(runs["design"].values == "train")[8:])
    assert set(late["gas"].values[-3:]) == {"b"} and (late["n"].values == 0).any()


def test_failed_runs_stop_nothing_and_are_not_asked_for_again(folder):
    study = written(
        folder,
        solver={"name": "bowl:Bowl", "options": {"fails": True}},
        maximise="depth",
        minimise=None,
        until={"runs": 25},
    )
    runs = study.run()
    train = runs.isel(run=np.flatnonzero(runs["design"].values == "train"))
    failed = train["status"].values == "failed"
    late = failed[8:]
    assert study.outcomes()["train"].rows == 25
    assert 0 < failed.sum() and late.sum() < 8
    places = train["coded"].values[failed]
    apart = np.linalg.norm(places[:, None] - places, axis=2) + 10 * np.eye(len(places))
    assert len(places) < 2 or apart.min() > 1e-3


def test_all_points_of_a_small_space_end_the_design(folder):
    study = written(
        folder,
        parameters={"n": {"range": [0, 9], "integer": True}, "gas": {"levels": ["a", "b"]}},
        initial={"method": "full_factorial", "levels": 2},
        until={"runs": 50},
    )
    runs = study.run()
    assert int((runs["design"].values == "train").sum()) == 20
    assert "no allowed point is left" in str(study.outcomes()["train"])


def test_stored_runs_hold_the_design_and_its_reviews(folder):
    """A study that ships with its runs needs no run, and says why its design ended."""
    written(folder).run()
    command("store", "bowl.yaml", cwd=folder, check=0)
    study = written(folder, stored="runs/bowl.nc", solver={"name": "bowl:Bowl"})
    runs = study.stored(folder / "new" / "bowl")
    assert (runs["status"].values == "ok").all() and len(chosen(runs)) == 7
    assert study.outcomes(folder / "new" / "bowl")["train"].ended == USED_UP
    assert study.asked(folder / "new" / "bowl").waiting == 0
    again = study.run(results=folder / "new" / "bowl")
    assert np.array_equal(chosen(again), chosen(runs))


def test_an_earlier_design_of_the_same_runs_is_counted(folder):
    """A study with the initial design alone has been run: none of its runs is done again."""
    written(folder).run()
    before = json.loads(json.dumps(STUDY))
    before["study"], before["designs"]["train"] = "before", STUDY["designs"]["train"]["initial"]
    first = Study.from_mapping({**before, "solver": {"name": "bowl:Bowl"}})
    reused = []
    first.run(progress=lambda now: reused.append(now.reused))
    assert reused[0] == 20


def test_check_status_terminal_and_report_tell_of_it(folder):
    written(folder, aim="accuracy", minimise=None, until={"runs": 12, "q2": 0.9999999})
    checked = command("check", "bowl.yaml", cwd=folder, check=0).stdout
    assert "8 of at most 12 runs, aim: accuracy of depth" in " ".join(checked.split())
    assert "after the first 8 runs, a point for each free place, until Q2 1" in " ".join(
        checked.split()
    )
    assert "24 to do" in checked
    done = " ".join(command("run", "bowl.yaml", cwd=folder, check=0).stdout.split())
    assert "design train: 12 of at most 12 runs" in done
    assert "the runs are used up, the goal is not reached" in done
    assert "choosing the points" in done
    status = command("status", "bowl.yaml", "--json", cwd=folder, check=0).stdout
    assert json.loads(status)["adaptive"]["train"]["ended"] == USED_UP
    results = folder / "results" / "bowl"
    summary = json.loads((results / "summary.json").read_text())["adaptive"]["train"]
    assert [one["runs"] for one in summary["reviews"]] == [8, 12] and len(summary["paid"]) == 1
    page = (results / "report.html").read_text()
    assert "Points chosen from the answers" in page and "Reviews of design train" in page


def test_a_damaged_file_is_told(folder):
    study = written(folder)
    study.run()
    path = next((folder / "results" / "bowl" / "designs").glob("adaptive_*/points_00010.json"))
    path.write_text('{"coded": [[1.0')
    with pytest.raises(ResultsError, match="points_00010.json is damaged; restore it"):
        study.stored()


WRONG = {
    "bowl.yaml:.*aim optimum needs one of minimise": {"minimise": None},
    "aim optimum does not take target; it takes minimise or maximise": {"target": {"depth": 1}},
    "until: q2 is not judged for aim optimum; give gain": {"until": {"runs": 20, "q2": 0.9}},
    "the study has no output 'dept'; did you mean 'depth'": {"minimise": "dept"},
    "until: runs 5 is less than the 8 runs of initial": {"until": {"runs": 5}},
    "bowl.yaml:.*runs -3: must be at least 1": {"until": {"runs": -3}},
    "key 'untill' is unknown; did you mean 'until'": {"untill": {"runs": 20}},
    "aim target needs one output": {"aim": "target", "minimise": None},
    "aim probability needs output": {"aim": "probability", "minimise": None, "output": "depth"},
    "option 'rums' is unknown; did you mean 'runs'": {
        "initial": {"method": "latin_hypercube", "rums": 8}
    },
    "unit 'kg' does not convert to 'mm'": {"until": {"runs": 20, "gain": "2 kg"}},
}


@pytest.mark.parametrize("sentence", WRONG)
def test_mistakes_are_told_at_their_place(folder, sentence):
    data = json.loads(json.dumps(STUDY))
    data["designs"]["train"] |= WRONG[sentence]
    data["designs"]["train"] = {
        key: value for key, value in data["designs"]["train"].items() if value is not None
    }
    (folder / "bowl.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    with pytest.raises(StudyError, match=sentence):
        Study.from_yaml(folder / "bowl.yaml")


def test_what_is_held_out_cannot_follow_from_answers(folder):
    data = json.loads(json.dumps(STUDY))
    data["designs"]["test"] = data["designs"]["train"]
    (folder / "bowl.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    with pytest.raises(StudyError, match="'test' is held out to judge the surrogates"):
        Study.from_yaml(folder / "bowl.yaml")


def test_fresh_runs_keep_the_points(folder):
    """Every run is done again, at the points that were chosen; then the design goes on."""
    study = written(folder, until={"runs": 11})
    first = chosen(study.run())
    done = []
    again = written(folder).run(fresh=True, progress=lambda now: done.append(now.reused))
    assert done[0] == 0 and np.array_equal(chosen(again)[:3], first)
    assert len(chosen(again)) == 7
