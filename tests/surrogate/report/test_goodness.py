"""Sentences about the polynomials."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_up import with_fewer_runs

from surrogate.fitting import fit as fitting
from surrogate.regressors.polynomial import Linear
from surrogate.regressors.regression import nested
from surrogate.report import digits
from surrogate.report.sections.goodness import comparisons, influence, sentences


def test_nested_models_are_tested_in_order(study):
    """F and p are those of `regression.nested`, for linear < interactions < quadratic."""
    content = study()
    said = comparisons(content, "pressure_b1", ["quadratic", "linear", "interactions"])
    models = {name: content.fits[name]["pressure_b1"].estimator.model_ for name in content.fits}
    known = [
        nested(models["linear"], models["interactions"]),
        nested(models["interactions"], models["quadratic"]),
    ]
    assert [words.split(":")[0] for words in said] == [
        "interactions against linear",
        "quadratic against interactions",
    ]
    for words, test in zip(said, known, strict=True):
        assert f"F = {digits.figure(test.f)}" in words
        assert (" not significant " in words) == (test.p >= 0.05)


def test_models_of_other_runs_are_not_tested(study):
    """Fits of different runs are no nested pair; nothing is said of them."""
    content = study(surrogates=("linear", "quadratic"))
    other = with_fewer_runs(content, 30)
    assert comparisons(other, "pressure_b1", ["linear", "quadratic"]) == []


def test_a_run_off_the_plane_is_named(study):
    """A value shifted by 40 mmHg at run 17 is found by its studentised residual."""
    content = study(surrogates=("linear",))
    fit = content.fits["linear"]["pressure_b1"]
    values = fit.values + 40.0 * (np.arange(60) == 17)
    wrong = fitting.fit(
        content.space, fit.coded, values, Linear(), surrogate="linear", output="pressure_b1"
    )
    other = replace(content, fits={"linear": {"pressure_b1": wrong}})
    said = influence(other, "pressure_b1", "linear", wrong.estimator.regression_table())
    assert any(
        words.startswith("Run 17: externally studentised residual above 3") for words in said
    )


def test_lack_of_fit_is_told_where_there_are_replicates(study):
    """Two noisy answers at each point: the F test of lack of fit is printed as computed."""
    content = study(train=30, test=0, surrogates=("linear",))
    coded = np.repeat(content.fits["linear"]["pressure_b1"].coded, 2, axis=0)
    noise = np.random.default_rng(3).normal(0.0, 0.05, len(coded))
    values = np.repeat(content.fits["linear"]["pressure_b1"].values, 2) + noise
    fit = fitting.fit(content.space, coded, values, Linear(), surrogate="linear", output="p")
    table = fit.estimator.regression_table()
    said = next(words for words in sentences(table, "mmHg") if words.startswith("Lack of fit"))
    assert f"F = {digits.figure(float(table['lack_of_fit_f']))}" in said
    assert float(table["lack_of_fit_p"]) < 0.05 and "terms are missing" in said
    assert pytest.approx(float(table["r2"]), abs=1e-3) == float(
        sentences(table, "")[0].split("= ")[1].split(",")[0]
    )
