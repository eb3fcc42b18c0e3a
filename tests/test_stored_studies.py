"""The studies that ship with their runs: complete, and what the solver gives today."""

from pathlib import Path

import numpy as np
import pytest

from surrogate import Study
from surrogate.runs import call_and_answer

ROOT = Path(__file__).parent.parent
PERSON = ROOT / "solvers/leg_bandage/data/pressure.yaml"
WITH_RUNS = [path for path in (*sorted((ROOT / "studies").glob("*.yaml")), PERSON)
             if "\nstored:" in path.read_text(encoding="utf-8")]
AGREES = 1e-3
"""mmHg; linear solvers differ by 1e-6."""


def names(path):
    return path.stem


@pytest.mark.parametrize("path", WITH_RUNS, ids=names)
def test_every_run_of_the_study_is_stored(path):
    """Nothing is missing and nothing has failed: report and predictions need no solver."""
    study = Study.from_yaml(path)
    assert study.unused == []
    assert (study.stored()["status"] == "ok").all()


def compare(path, seed):
    study = Study.from_yaml(path)
    runs = study.stored_runs[0].runs
    i = int(np.random.default_rng(seed).integers(runs.sizes["run"]))
    inputs, outputs = call_and_answer(runs, i)
    again = study.recipe.solver(**inputs)
    assert again["pressure_b1"] == pytest.approx(outputs["pressure_b1"], abs=AGREES)


def test_a_stored_run_is_what_the_solver_gives():
    """One run of the largest study, on whatever linear solver is installed."""
    compare(PERSON, 5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("path", WITH_RUNS, ids=names)
def test_stored_runs_are_what_the_solver_gives(path, seed):
    """Two runs of every study."""
    compare(path, seed)
