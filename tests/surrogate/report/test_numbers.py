"""Figures on the page are the figures in the datasets."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from made_up import fraction
from reader import read

from surrogate import report
from surrogate.report import digits
from surrogate.report.parity import parity
from surrogate.report.sections.fields import judged
from surrogate.sensitivity.one_at_a_time import one_at_a_time


def table(tree, caption: str) -> list[list[str]]:
    """Words of the rows of the table whose caption starts so."""
    for figure in tree.all("figure"):
        captions = list(figure.all("figcaption"))
        if captions and captions[0].text.startswith(caption):
            return [
                [cell.text for cell in row.children if not isinstance(cell, str)]
                for row in next(figure.all("tbody")).all("tr")
            ]
    raise AssertionError(f"no table '{caption}'")


def number(words: str) -> float:
    """The first number in words as printed."""
    plain = words.replace("\N{NARROW NO-BREAK SPACE}", "").replace(digits.MINUS, "-")
    return float(re.match(r"-?[\d.]+", plain)[0])


@pytest.fixture(scope="module")
def shown(study):
    """A study and its page as a tree."""
    content = study(failed={4: "lost contact"}, screened=True)
    return content, read(report.build(content).html)


def test_comparison_numbers(shown):
    """Q2 and RMSE of each surrogate, to the digits shown."""
    content, tree = shown
    for row, name in zip(table(tree, "Surrogates of"), content.fits, strict=True):
        known = content.comparison.sel(surrogate=name, output="pressure_b1")
        keys = ("q2_cv", "rmse_cv", "q2_test", "rmse_test", "max_error_test")
        assert row[0].startswith(name)
        for words, key in zip(row[1:], keys, strict=False):
            assert number(words) == pytest.approx(float(known[key]), rel=6e-3, abs=6e-4)


def test_best_surrogate_is_the_comparisons(shown):
    """The answer names the best surrogate with its error on held-out runs and its unit."""
    content, tree = shown
    best = str(content.comparison["best"].sel(output="pressure_b1").item())
    error = float(content.comparison["rmse_test"].sel(surrogate=best, output="pressure_b1"))
    answer = next(tree.all("section", id="answer")).text
    assert f"the {best} model predicts it within {digits.figure(error, 2)} mmHg" in answer
    assert "RMSE on 20 held-out runs" in answer
    assert "1 of 80 runs failed" in answer


def test_regression_table(shown):
    """Coefficients, errors and statistics of the linear model, row by row."""
    content, tree = shown
    known = content.regression["linear"]["pressure_b1"]
    rows = table(tree, "Regression table of linear")
    assert len(rows) == known.sizes["term"]
    for row, k in zip(rows, range(len(rows)), strict=True):
        error = float(known["standard_error"][k])
        assert number(row[1]) == pytest.approx(float(known["coefficient"][k]), abs=0.06 * error)
        assert number(row[2]) == pytest.approx(error, rel=0.05)
        assert number(row[3]) == pytest.approx(float(known["t"][k]), rel=6e-3)


def test_sensitivity_numbers(shown):
    """First-order and total indices with their intervals and both parts, largest total first."""
    content, tree = shown
    known = content.sensitivity.sel(output="pressure_b1")
    order = np.argsort(-known["total"].values)
    rows = table(tree, "First-order and total indices")
    for row, k in zip(rows, order, strict=True):
        assert row[0] == content.space.names[k]
        for column, key in (
            (1, "first_order"),
            (2, "first_order_sampling"),
            (3, "first_order_surrogate"),
            (4, "total"),
            (5, "total_sampling"),
            (6, "total_surrogate"),
        ):
            value = float(known[key][k])
            assert number(row[column]) == pytest.approx(value, rel=0.05, abs=6e-4)
        low, high = map(number, re.search(r"\((\S+) to (\S+)\)", row[4]).groups())
        assert low == pytest.approx(float(known["total_low"][k]), abs=6e-4)
        assert high == pytest.approx(float(known["total_high"][k]), abs=6e-4)


def test_screening_is_the_decision(shown):
    """Each parameter's decision, the variance kept, and the reduced study file are shown."""
    content, tree = shown
    decision = content.screening
    rows = table(tree, "The decision on each parameter")
    assert [row[0] for row in rows if row[1] == "keep"] == list(decision.keep)
    assert [row[0] for row in rows if row[1].startswith("freeze")] == list(decision.freeze)
    assert decision.freeze and decision.keep
    cost = table(tree, "Cost of freezing")
    assert number(cost[0][1]) == pytest.approx(100 * decision.variance_kept[0].share, rel=5e-3)
    section = next(tree.all("section", id="screening"))
    assert content.reduced_study.strip() in section.text


def test_runs_table_holds_all_runs(shown):
    """Every run with its inputs, output and status; a failed one has no output."""
    content, tree = shown
    rows = table(tree, "Every run")
    assert [row[0] for row in rows] == [str(k) for k in range(80)]
    assert [row[2] for row in rows].count("failed") == 1
    assert rows[4][2] == "failed" and "lost contact" in rows[4] and digits.NOTHING in rows[4]
    values = [number(row[3 + content.space.size]) for row in rows if row[2] == "ok"]
    assert values == pytest.approx(content.values("pressure_b1")[content.ok], abs=6e-3)


def test_parity_marks_stand_where_the_numbers_are(shown):
    """Held-out marks of the parity plot, read back from the drawing, equal the predictions."""
    content, tree = shown
    fit = content.fits["quadratic"]["pressure_b1"]
    data = parity(content, fit, "pressure_b1")
    assert (~data.learnt).sum() == 20 and data.learnt.sum() == 59 and data.honest
    held = content.words("design")[content.ok] == "test"
    assert np.array_equal(held, ~data.learnt)
    assert data.predicted[held] == pytest.approx(fit.predict(content.coded[content.ok][held]))
    assert data.predicted[~held] == pytest.approx(fit.left_out)
    drawing = next(
        svg
        for svg in next(tree.all("section", id="output-pressure_b1")).all("svg")
        if "predicted against simulated" in next(svg.all("title")).text
    )
    marks = {mark.attributes["data-run"]: mark for mark in drawing.all("circle")}
    assert len(marks) == 79
    for place, values in (("cx", data.observed), ("cy", data.predicted)):
        shown_at = np.array([float(marks[str(run)].attributes[place]) for run in data.run])
        per_unit, at_zero = axis(drawing, place)
        assert (shown_at - at_zero) / per_unit == pytest.approx(values, abs=0.12 / abs(per_unit))


def axis(drawing, place: str) -> tuple[float, float]:
    """Drawing units per value and the place of zero, read from the outer tick words."""
    ticks = [
        tick
        for tick in drawing.all("text", class_="tick")
        if (tick.attributes["text-anchor"] == "middle") == (place == "cx")
    ]
    words = [number(tick.text) for tick in ticks]
    # Words of the y axis stand 4 units below their line, so that they are centred on it.
    at = [float(tick.attributes[place[1]]) - (4.0 if place == "cy" else 0.0) for tick in ticks]
    per_unit = (at[-1] - at[0]) / (words[-1] - words[0])
    return per_unit, at[0] - per_unit * words[0]


def test_saturated_fit_and_aliases_are_said(study):
    """Eight runs of a 2^(7-4) fraction for eight coefficients: saturated, resolution III."""
    content = study(train=fraction()[:8], test=0, surrogates=("linear",), sensitivity=False)
    tree = read(report.build(content).html)
    answer = next(tree.all("section", id="answer")).text
    assert "as many coefficients as runs" in answer and "resolution III" in answer
    assert "The model is saturated" in next(tree.all("section", id="output-pressure_b1")).text
    rows = table(tree, "Alias table of design train")
    chains = content.aliasing["train"].chains
    assert len(rows) == len(chains) == 7
    assert rows[0] == ["mu_skin", "tension × alpha1, leg_length × alpha2, alpha3 × alpha4"]


def test_refused_indices_are_stamped(study):
    """Indices that are not to be trusted carry a stamp, and the answer does not use them."""
    why, told = "Not to be trusted: Q2 = 0.41.", "Not to be trusted: Q² = 0.41."
    tree = read(report.build(study(refused=why)).html)
    stamps = [element for element in tree.all("span", class_="stamp")]
    assert len(stamps) == 3 and stamps[0].text == "not to be trusted"
    answer = next(tree.all("section", id="answer")).text
    assert "what matters is not answered" in answer and told in answer


def test_point_q2_of_a_field(study):
    """Q2 at each point is 1 - SSE / SST over the held-out runs, computed here point by point."""
    content = study(outputs=("pressure_line",), surrogates=("linear",))
    seen = judged(content, "pressure_line")
    held = content.words("design") == "test"
    values = content.values("pressure_line")[held]
    predicted = content.fits["linear"]["pressure_line"].predict(content.coded[held])
    k = 7
    wrong = sum((values[i, k] - predicted[i, k]) ** 2 for i in range(20))
    total = sum((values[i, k] - values[:, k].mean()) ** 2 for i in range(20))
    assert seen.q2[k] == pytest.approx(1.0 - wrong / total)
    assert "20 held-out runs" in seen.how
    errors = [np.abs(values[i] - predicted[i]).mean() for i in range(20)]
    assert content.numbers[held][int(np.argmax(errors))] == seen.run[seen.worst]


def test_any_measure_is_drawn_with_its_unit(study):
    """Elementary effects are in the output's unit; the answer names the largest."""
    content = study(surrogates=("quadratic",), sensitivity=False)
    fit = content.fits["quadratic"]["pressure_b1"]
    moved = one_at_a_time(fit, content.space)
    tree = read(report.build(replace(content, sensitivity=moved)).html)
    rows = table(tree, "The same in numbers")
    assert [number(row[1]) for row in rows] == pytest.approx(moved["effect"].values[0], rel=6e-3)
    assert "effect (mmHg)" in next(tree.all("section", id="output-pressure_b1")).text
    answer = next(tree.all("section", id="answer")).text
    assert "tension has the largest effect" in answer


def test_answers_of_several_outputs_are_sentences(study):
    """Shapley effects are called so, and intervals that are too narrow say whose they are."""
    content = study(outputs=("pressure_b1", "slope"), surrogates=("quadratic",))
    shares = content.sensitivity["total"].rename("shapley")
    content.comparison["coverage_95"][:] = 0.5
    told = shares.to_dataset().assign_attrs(method="shapley", surrogate="quadratic")
    tree = read(report.build(replace(content, sensitivity=told)).html)
    answer = next(tree.all("section", id="answer")).text
    told = np.sort(shares.sel(output="slope").values)[::-1]
    assert (
        f"mu_skin and tension explain {min(100, 100 * told[:2].sum()):.0f} % of its variance"
        in answer
    )
    assert "intervals of quadratic contain only 50 % of the held-out values of slope" in answer
    assert (
        "Method: Shapley effects of surrogate quadratic."
        in next(tree.all("section", id="output-slope")).text
    )
