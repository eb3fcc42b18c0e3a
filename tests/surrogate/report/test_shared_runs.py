"""Runs that several designs share: a fold-over holds the fraction that it folds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from reader import read

from surrogate import report
from surrogate.report import digits
from surrogate.report.sections.goodness import influence


@pytest.fixture(scope="module")
def shared(study):
    """Sixty runs, and a later design that holds them all once more."""
    content = study(test=0, surrogates=("linear",))
    again = content.runs.assign(design=("run", np.full(60, "folded")))
    return replace(content, runs=xr.concat([content.runs, again], "run", data_vars="minimal"))


def test_time_of_a_shared_run_is_counted_once(shared):
    """The sum of 41 + k mod 7 seconds over sixty runs, not over the 120 rows."""
    tree = read(report.build(shared).html)
    spent = " ".join(digits.duration(sum(41 + k % 7 for k in range(60))).split())
    told = next(tree.all("section", id="runs")).text
    assert f"{spent} of solver time" in told
    assert "60 runs that designs share are counted once" in told
    assert f"{spent} of solver time in 60 runs" in next(tree.all("section", id="provenance")).text


def test_a_shared_run_has_the_number_that_parity_shows(shared):
    """A run off the plane is named by its first number, as the marks of the parity plot are."""
    said = influence(
        shared,
        "pressure_b1",
        "linear",
        shared.regression["linear"]["pressure_b1"].assign(
            cooks_distance=("run", 2.0 * (np.arange(60) == 17))
        ),
    )
    assert said[0].startswith("Run 17: Cook's distance above 1")


def test_mark_of_the_first_design_lies_on_top(shared):
    """Of marks at one place the last drawn is seen: it is the first design's filled disc."""
    tree = read(report.build(shared).html)
    drawn = [
        mark
        for svg in next(tree.all("section", id="designs")).all("svg")
        for mark in svg.all("circle")
    ]
    kinds = [mark.attributes["class"] for mark in drawn]
    assert len(kinds) == 120 * 21
    assert kinds[:60] == ["mark hollow"] * 60 and kinds[60:120] == ["mark filled"] * 60
