"""The first screen says of each output how good, what matters and what may be frozen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reader import read

from surrogate import report
from surrogate.fitting import fit as fitting
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Quadratic
from surrogate.report import digits
from surrogate.report.sections.leading import explained
from surrogate.report.sections.verdict import called, verdict
from surrogate.solving.goals import Target
from surrogate.solving.problem import Problem
from surrogate.solving.solution import Candidate, Predicted, Solution


def fit_named(study, name, regressor):
    known = study(surrogates=("linear",), train=40).fits["linear"]["pressure_b1"]
    return fitting.fit(
        known.space, known.coded, known.values, regressor, surrogate=name, output="pressure_b1"
    )


def test_surrogates_are_called_what_they_are(study):
    """Kind and name; the name alone would do for `quadratic`, and the class for others."""
    assert called(fit_named(study, "quadratic", Quadratic())) == "the quadratic model"
    assert called(fit_named(study, "cheap", Quadratic())) == "the quadratic model cheap"
    assert called(fit_named(study, "gp", GaussianProcess())) == "the Gaussian process gp"


def test_inputs_explain_their_main_effects_and_what_they_share(study):
    """Of y = a + b + c + ab in [-1, 1] a and b explain V_a + V_b + V_ab = (1/3 + 1/3 + 1/9) / V."""
    table = (
        study(surrogates=("linear",), train=20)
        .sensitivity.sel(output="pressure_b1")
        .isel(parameter=slice(3), parameter_2=slice(3))
    )
    parts = np.array([1 / 3, 1 / 3, 1 / 3, 1 / 9])
    total = parts.sum()
    second = np.full((3, 3), np.nan)
    second[0, 1] = second[1, 0] = parts[3] / total
    table = table.assign(
        first_order=("parameter", parts[:3] / total),
        second_order=(("parameter", "parameter_2"), second),
    )
    assert explained(table, np.array([0, 1])) == pytest.approx(7 / 10)
    assert explained(table, np.array([0, 2])) == pytest.approx(6 / 10)
    assert explained(table, np.arange(3)) == pytest.approx(1.0)


def test_the_sentence_has_the_numbers_of_the_datasets(study):
    content = study(screened=True)
    best = content.best("pressure_b1")
    row = content.row(best, "pressure_b1")
    said = verdict(content, "pressure_b1")
    error = digits.with_unit(digits.figure(row["rmse_test"], 2), "mmHg")
    assert said.sentence.startswith(f"the {best} model predicts it within {error} (RMSE on 20 ")
    assert f"{digits.listing(content.screening.freeze, 6)} may be frozen" in said.sentence
    assert said.q2 == digits.score(row["q2_test"]) and said.error == error
    assert [figure.question for figure in said.figures] == [
        "How good is it?", "What matters?", "What may be frozen?",
    ]  # fmt: skip
    frozen = dict(zip(*(one.words() for one in said.figures[2].plot.numbers[:2]), strict=True))
    assert {name for name, word in frozen.items() if word == "freeze"} == set(
        content.screening.freeze
    )


def test_only_held_out_runs_judge_where_there_are_some(study):
    """Twenty marks for twenty held-out runs; without them the training runs, as said."""
    first = verdict(study(), "pressure_b1").figures[0]
    assert len(list(first.plot.rows)) == 20 and "20 held-out runs" in first.caption
    first = verdict(study(test=0), "pressure_b1").figures[0]
    assert len(list(first.plot.rows)) == 60 and "60 training runs" in first.caption


def test_a_goal_is_shown_where_one_was_set(study):
    """The third figure shows the candidates, the best one with its values."""
    content = study(screened=True)
    predicted = {"pressure_b1": Predicted(40.0, 39.0, 41.0)}
    found = [
        Candidate({"tension": tension}, predicted, probability, {}, None)
        for tension, probability in ((0.11, 0.97), (0.12, 0.91))
    ]
    problem = Problem("forty", (Target("pressure_b1", 40.0, None, None),), free=("tension",))
    solution = Solution(problem, tuple(found), {"pressure_b1": (38.0, 42.0)}, {"pressure_b1": "gp"})
    told = replace(content, solve={"forty": solution})
    figure = verdict(told, "pressure_b1").figures[2]
    assert figure.question == "Which inputs reach the goal?"
    names = [one.name for one in figure.plot.numbers]
    assert names == ["candidate", "tension (N/mm)", "probability"]
    answer = next(read(report.build(told).html).all("section", id="answer")).text
    assert "Goal forty:" in answer and "0.11 N/mm" in answer


def test_the_way_is_shown_where_nothing_is_screened(study):
    figure = verdict(study(), "pressure_b1").figures[2]
    assert figure.question == "Which way does it go?"
    curves = {one.name: one.values for one in figure.plot.numbers}
    assert len(curves) == 5
    fit = study().fits[study().best("pressure_b1")]["pressure_b1"]
    ends = np.zeros((2, 7))
    ends[:, 1] = -1.0, 1.0
    assert curves["along tension"][[0, -1]] == pytest.approx(fit.predict(ends))
