"""The comparison of surrogates: what stands beside what, and what the drawing says of it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
from made_up import with_fewer_runs
from reader import read

from surrogate import report
from surrogate.fitting import fit as fitting
from surrogate.fitting.comparison import compare
from surrogate.regressors.polynomial import Linear
from surrogate.report.figures.accuracy import accuracy_plot
from surrogate.report.sections.accuracy import blocks


def test_scores_off_the_scale_stand_clear_of_each_other_and_of_discs():
    """Numbers of 9-unit letters and discs of 4 units in a row do not touch; none is left out."""
    cv, test = [-31.1, -0.662, -12.6, 0.05], [-1.05, 0.32, 0.02, -0.4]
    tree = read(str(accuracy_plot(list("abcd"), cv, test, "y").marks))
    for value, disc in ((-31.1, None), (-0.662, 0.32), (-12.6, 0.02), (-0.4, 0.05)):
        words = f"{value:.3g}".replace("-", "\N{MINUS SIGN}") + ("0" if value == -0.4 else "") * 2
        label = next(mark for mark in tree.all("text") if mark.text == words)
        left, row = (float(label.attributes[key]) for key in "xy")
        right = left + 6.0 * len(words)
        others = [
            float(mark.attributes["x"])
            for mark in tree.all("text", y=f"{row:g}")
            if mark is not label and mark.attributes["class"] == "small"
        ]
        assert not any(left < other < right for other in others)
        large = [
            float(mark.attributes["cx"])
            for mark in tree.all("circle", r="4.2")
            if float(mark.attributes["cy"]) == row - 4.0
        ]
        assert len(large) == (disc is not None)
        assert not any(left - 20.0 < x < right for x in large)


def test_surrogates_of_different_runs_are_not_said_to_share_folds(study):
    """A plane of thirty runs beside one of sixty: only the held-out runs are common."""
    content = study(surrogates=("linear", "quadratic"))
    caption = "on the same folds and the same held-out runs"
    assert (
        caption
        in next(read(report.build(content).html).all("section", id="output-pressure_b1")).text
    )
    other = with_fewer_runs(content, 30)
    told = next(read(report.build(other).html).all("section", id="output-pressure_b1")).text
    assert caption not in told and "Their training designs differ" in told


def test_calibration_counts_the_runs_that_it_was_counted_on(study):
    """A third design that no surrogate has seen widens no band: coverage is of the test design."""
    content = study(surrogates=("linear",))
    aside = content.words("design").copy()
    aside[:9] = "aside"
    fit = content.fits["linear"]["pressure_b1"]
    fewer = fitting.fit(
        content.space,
        fit.coded[9:],
        fit.values[9:],
        Linear(),
        surrogate="linear",
        output="pressure_b1",
    )
    held = content.words("design") == "test"
    tests = {"pressure_b1": (content.coded[held], content.values("pressure_b1")[held])}
    fits = {"linear": {"pressure_b1": fewer}}
    other = replace(
        content,
        runs=content.runs.assign(design=("run", aside.astype(str))),
        fits=fits,
        comparison=compare(fits, tests),
    )
    captions = " ".join(re.findall(r"Within the band, \d+ runs", str(blocks(other, "pressure_b1"))))
    assert captions == f"Within the band, {np.sum(held)} runs"
