"""Campaigns: points asked for, answers told, whoever does the runs and whenever they stop."""

import json
import os
import re
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
import yaml

import surrogate
from surrogate import Study
from surrogate.__main__ import main
from surrogate.errors import ResultsError, SolverError, StudyError
from surrogate.execution.shared.claims import ENDED, SharedFolder
from surrogate.runs.record import Record
from surrogate.runs.segment import Segment
from surrogate.study.campaign import Campaign, Point

STUDY = {
    "study": "hardness",
    "solver": {
        "name": "laboratory",
        "options": {
            "inputs": {
                "temperature": {"unit": "degC", "range": [100, 300]},
                "time": {"unit": "s", "range": [1, 100]},
                "gas": {"levels": ["argon", "air"], "nominal": "argon"},
            },
            "outputs": {"hardness": {"unit": "MPa"}},
        },
    },
    "parameters": {"temperature": {"range": [150, 250]}, "time": {"range": [10, 30]}},
    "designs": {
        "train": {
            "method": "central_composite",
            "augment": [{"method": "center_points", "runs": 2}],
        },
        "test": {"method": "halton", "runs": 3},
    },
    "surrogates": {"quadratic": {"method": "quadratic"}},
}


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hardness.yaml").write_text(yaml.safe_dump(STUDY, sort_keys=False))
    return Study.from_yaml("hardness.yaml")


def measured(point):
    """An exact quadratic, so that a told study ends in a Q² of one."""
    t, s = point.inputs["temperature"] / 100, point.inputs["time"] / 10
    return {"hardness": 3 + t - 0.2 * t**2 + 0.1 * t * s}


def finish(campaign):
    for point in campaign.ask(1000):
        campaign.tell(point, measured(point))


def told_by(neighbour, folder, point, hardness):
    """A record of a point in the segment of a `surrogate work`."""
    record = Record(
        point.key, point.inputs, "ok", "", 0.1, 1, 1.8e9, outputs={"hardness": hardness}
    )
    with Segment(folder, neighbour) as segment:
        segment.append(record, {})


def test_what_neighbours_have_done_or_are_at_is_not_handed_out(study):
    """They came before the campaign and go on; they leave what it has handed out."""
    with Campaign(study) as campaign:
        first, second, third, *rest = campaign.ask(1000)
    folder = study.journal()
    shared = SharedFolder(folder)
    with Campaign(study) as campaign:
        shared.show("neighbour", "1")
        told_by("neighbour", folder, first, 7.0)
        assert shared.claim(second.key, 0, "neighbour")
        assert [one.key for one in campaign.ask(1)] == [third.key]
        assert campaign.left == len(rest) + 2
        assert not shared.claim(third.key, 0, "neighbour")
        shared.show("neighbour", f"{ENDED} 0")
        assert [one.key for one in campaign.ask(1000)] == [second.key, *(p.key for p in rest)]
        assert campaign.runs()["hardness"].values[0] == 7.0
    with Campaign(study) as campaign:  # what the one before had handed out and nobody told
        shared.show("another", "1")
        assert [one.key for one in campaign.ask(2)] == [second.key, third.key]


def test_every_point_is_handed_out_once_with_every_input(study):
    """Replicates of a laboratory are points of their own."""
    with Campaign(study) as campaign:
        first, rest = campaign.ask(2), campaign.ask(1000)
        assert campaign.ask() == []
    points = [*first, *rest]
    runs = study.stored()
    assert len({point.key for point in points}) == len(points) == runs.sizes["run"]
    assert [point.design for point in points] == runs["design"].values.tolist()
    for name in ("temperature", "time"):
        assert [point.inputs[name] for point in points] == runs[name].values.tolist()
    assert {point.inputs["gas"] for point in points} == {"argon"}


def test_a_told_study_goes_to_its_report_like_any_other(study, capsys):
    with surrogate.Campaign("hardness.yaml") as campaign:
        finish(campaign)
        assert campaign.left == 0
        # Readers, and a run that has nothing to run, do not mind an open campaign.
        assert command("run", "hardness.yaml") == 0
    summary = json.loads((study.folder / "summary.json").read_text())
    assert summary["comparison"]["q2_test"]["values"] == [[pytest.approx(1, abs=1e-9)]]
    assert (study.folder / "report.html").exists()
    again = Study.from_yaml("hardness.yaml").stored()
    assert again["hardness"].values[0] == measured(first_point(study))["hardness"]


def first_point(study):
    asked = study.asked()
    return Point(asked.keys[0], "train", asked.calls[0])


def command(*words):
    """Exit status of the command, run in this process."""
    with pytest.MonkeyPatch.context() as patch, pytest.raises(SystemExit) as end:
        patch.setattr(sys, "argv", ["surrogate", *words])
        main()
    return end.value.code or 0


def test_half_a_campaign_counts_and_nothing_is_called(study, capsys):
    """The run of a half told study fails no point, and says what is missing."""
    assert command("run", "hardness.yaml") == 1
    assert "tell some answers" in capsys.readouterr().err
    with Campaign(study) as campaign:
        for point in campaign.ask(campaign.left - 2):
            campaign.tell(point, measured(point))
    assert command("run", "hardness.yaml") == 1
    assert "2 not done yet" in capsys.readouterr().err
    assert command("status", "hardness.yaml") == 0
    assert "2 wait for their answers" in " ".join(capsys.readouterr().out.split())
    with Campaign(study) as campaign:
        assert campaign.left == len(campaign.ask(1000)) == 2
    with pytest.raises(StudyError, match="told, so no run can be done afresh"):
        study.run(fresh=True)
    with pytest.raises(SolverError, match="its answers are told"):
        study.spec.solver(temperature=200.0, time=20.0)


def test_answers_come_in_any_order_and_unasked(study):
    """By what ask() gave, by key, and by inputs alone; a list at once."""
    keys = study.asked().keys
    calls = study.asked().calls
    with Campaign(study) as campaign:
        last, nameless = Point(keys[-1], "test", calls[-1]), dict(calls[2])
        del nameless["gas"]
        campaign.tell([last, keys[1], nameless], [{"hardness": value} for value in (9.0, 1.0, 2.0)])
        assert keys[1] not in {point.key for point in campaign.ask(1000)}
    values = study.stored()["hardness"].values
    assert (
        values[[-1, 1, 2]].tolist() == [9.0, 1.0, 2.0] and np.isnan(values).sum() == len(keys) - 3
    )


def test_replicates_told_by_their_inputs_fill_up_one_after_the_other(study):
    center = {"temperature": 200, "time": 20}
    with Campaign(study) as campaign:
        asked = [
            point
            for point in campaign.ask(1000)
            if point.inputs["time"] == 20 and point.inputs["temperature"] == 200
        ]
        for number in range(len(asked)):
            campaign.tell(center, {"hardness": float(number)})
        with pytest.raises(StudyError, match="replicates, all of which have an answer"):
            campaign.tell(center, {"hardness": 1.0})
        runs = campaign.runs()
    found = runs["hardness"].values[np.isfinite(runs["hardness"].values)]
    assert len(asked) > 2 and found.tolist() == list(range(len(asked)))


def test_the_last_answer_counts_and_a_failure_is_an_answer(study):
    with Campaign(study) as campaign:
        first, second = campaign.ask(2)
        campaign.tell(first, {"hardness": 1.0}, seconds=60)
        campaign.tell(first, {"hardness": 2.0}, seconds=90)
        campaign.tell(second, failed="the specimen broke in the clamp")
        left = campaign.left
    runs = study.stored()
    assert runs["hardness"].values[0] == 2.0 and runs["seconds"].values[0] == 90
    assert runs["status"].values[1] == "failed"
    assert runs["message"].values[1] == "the specimen broke in the clamp"
    with Campaign(study) as campaign:
        assert campaign.left == left == runs.sizes["run"] - 2


@pytest.mark.parametrize(
    "points, outputs, sentences",
    [
        ({"temperature": 151, "time": 20}, {"hardness": 1}, ["lies in no design of the study"]),
        (
            {"temperatur": 151},
            {"hardness": 1},
            [
                "no input 'temperatur'; did you mean 'temperature'",
                "no value for 'temperature'",
                "no value for 'time'",
            ],
        ),
        (
            {"temperature": "hot", "time": 20},
            {"hardness": 1},
            ["temperature: 'hot' is not a number; give it in degC"],
        ),
        (
            {"temperature": 200, "time": 20, "gas": "air"},
            {"hardness": 1},
            ["gas: air was told, but this study holds it at argon"],
        ),
        (
            {"temperature": 200, "time": 20},
            {"hardnes": 1},
            ["there is no output 'hardnes'; did you mean 'hardness'"],
        ),
        ({"temperature": 200, "time": 20}, {"hardness": "hard"}, ["it must be real numbers"]),
        ({"temperature": 200, "time": 20}, {"hardness": float("nan")}, ["it must be finite"]),
        ({"temperature": 200, "time": 20}, {}, ["did not return 'hardness'"]),
        ({"temperature": 200, "time": 20}, 5.0, ["it must return a mapping"]),
        ("0" * 32, {"hardness": 1}, ["is the key of no point of this study"]),
        (
            [{"temperature": 200, "time": 20}, {"temperature": 1, "time": 1}],
            [{"hardness": 1}],
            ["outputs: 1 for 2 points"],
        ),
        (
            [{"temperature": 200, "time": 20}, {"temperature": 1, "time": 1}],
            [{"hardness": 1}, {"hardness": 1}],
            ["point 2: temperature=1, time=1 lies in no design"],
        ),
        ({"temperature": 200, "time": 20}, None, ["give either outputs or failed"]),
    ],
)
def test_what_cannot_be_used_is_refused_whole(study, points, outputs, sentences):
    """All mistakes at once; of a list with one wrong entry nothing is written down."""
    with Campaign(study) as campaign:
        left = campaign.left
        with pytest.raises(StudyError) as caught:
            campaign.tell(points, outputs)
        for sentence in sentences:
            assert sentence in str(caught.value)
        assert campaign.left == left
    assert (study.stored()["status"].values == "missing").all()


def test_two_campaigns_on_one_folder_get_a_sentence(study):
    with Campaign(study), pytest.raises(ResultsError, match="in use by this process"):
        Campaign(study)
    with Campaign(study):  # closed, and so free again
        pass
    lost = Campaign(study)
    del lost
    Campaign(study).close()


def test_a_solver_with_code_may_be_driven_too(tmp_path):
    """The answers of a queue of one's own are the runs of `surrogate run`: none is left to do."""
    study = Study.from_mapping(
        {
            "study": "driven",
            "solver": {"name": "ishigami"},
            "parameters": {name: [-3, 3] for name in ("X1", "X2", "X3")},
            "designs": {"train": {"method": "sobol", "runs": 8, "seed": 1}},
            "surrogates": {"linear": {"method": "linear"}},
        }
    )
    with Campaign(study, results=tmp_path) as campaign:
        points = campaign.ask(8)
        campaign.tell(points, [study.spec.solver(**point.inputs) for point in points])
    tally = []
    runs = study.run(results=tmp_path, progress=tally.append)
    assert (tally[-1].reused, tally[-1].done) == (8, 8)
    assert (runs["status"] == "ok").all()


def test_arrays_are_told_as_a_solver_returns_them(tmp_path):
    words = {**STUDY["solver"]["options"], "deterministic": True}
    words["outputs"] = {"curve": {"unit": "MPa", "dims": {"x": {"from": 0, "to": 1, "count": 3}}}}
    study = Study.from_mapping({**STUDY, "solver": {"name": "laboratory", "options": words}})
    with Campaign(study, results=tmp_path) as campaign:
        points = campaign.ask(1000)
        assert len(points) == len(set(study.asked(tmp_path).keys)) < len(study.asked().keys)
        campaign.tell(points[0], {"curve": [1, 2, 3]})
        with pytest.raises(StudyError, match="has 2 entries where the solver declares 3"):
            campaign.tell(points[1], {"curve": [1, 2]})
        assert campaign.runs()["curve"].values[0].tolist() == [1, 2, 3]


def test_the_page_is_true(tmp_path, monkeypatch, capsys):
    """The study and the program of docs/how_to/ask_and_tell.md, as printed."""
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[3] / "docs" / "how_to" / "ask_and_tell.md").read_text(
        encoding="utf-8"
    )
    program, words = re.findall(r"^```(?:python|yaml)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    (tmp_path / "hardness.yaml").write_text(words)
    exec(program, {})
    assert " train {'temperature': 164.64" in capsys.readouterr().out
    status = Study.from_yaml("hardness.yaml").stored()["status"].values.tolist()
    assert status[:2] == ["ok", "failed"] and set(status[2:]) == {"missing"}


DRIVER = """
    import os, signal, sys
    from surrogate import Campaign
    campaign = Campaign("hardness.yaml")
    for number, point in enumerate(campaign.ask(6)):
        if number == 4:
            os.kill(os.getpid(), signal.SIGKILL)
        campaign.tell(point, {"hardness": float(number)})
        print(point.key, flush=True)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_kill_minus_nine_loses_no_answer(study):
    """Told points stay told; those handed out and not answered are handed out again."""
    program = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(DRIVER)],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONWARNINGS": "ignore"},
    )
    told = program.stdout.split()
    assert program.returncode == -signal.SIGKILL and len(told) == 4
    with Campaign(study) as campaign:
        assert campaign.runs()["hardness"].values[:4].tolist() == [0, 1, 2, 3]
        again = campaign.ask(1000)
        assert again[0].key == study.asked().keys[4]
        assert not {point.key for point in again} & set(told)
        assert len(again) == campaign.left == len(study.asked().keys) - 4


@pytest.mark.parametrize(
    "options, sentence",
    [
        ({"inputs": {}, "outputs": {}}, "outputs: is empty; say what is measured"),
        ({"inputs": {"a": {"unit": "furlongg"}}, "outputs": {"y": {}}}, "'furlongg' is not a unit"),
        (
            {"inputs": {"a": {}}, "outputs": {"y": {"regex": "x"}}},
            "outputs.y.regex: is unknown; Allowed: description, dims, unit",
        ),
        ({"inputs": {"a": {"rang": [0, 1]}}, "outputs": {"y": {}}}, "did you mean 'range'"),
        ({"inputs": {"a": {"range": [1, 0]}}, "outputs": {"y": {}}}, "upside down"),
    ],
)
def test_mistakes_of_a_laboratorys_options_have_sentences(options, sentence):
    words = {**STUDY, "solver": {"name": "laboratory", "options": options}}
    with pytest.raises(StudyError, match="hardness|solver|temperature") as caught:
        Study.from_mapping(words)
    assert sentence in str(caught.value)
