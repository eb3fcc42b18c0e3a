"""`replicates:` of a solver that is not deterministic, and where its runs fail."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from surrogate.cli import findings, results
from surrogate.errors import SolverError, StudyError
from surrogate.solver import Input, Output
from surrogate.study.study import Study


class Noisy:
    """x + y with noise of standard deviation 0.1; no answer where x is above 0.7."""

    version = "1"
    deterministic = False
    inputs = {"x": Input(range=(0, 1)), "y": Input(range=(0, 1))}
    outputs = {"z": Output()}

    def __init__(self):
        self.noise = np.random.default_rng(0)

    def __call__(self, x, y):
        if x > 0.7:
            raise SolverError("buckles")
        return {"z": x + y + 0.1 * self.noise.normal()}


STUDY = {
    "study": "noisy",
    "solver": f"{__name__}:Noisy",
    "parameters": {"x": [0, 1], "y": [0, 1]},
    "designs": {"train": {"method": "latin_hypercube", "runs": 20, "seed": 1}},
    "replicates": 3,
    "surrogates": {"linear": "linear"},
    "sensitivity": {"method": "sobol"},
}


def test_every_point_is_run_several_times(tmp_path):
    study = Study.from_mapping(STUDY)
    with ThreadPoolExecutor(1) as executor:
        runs = study.run(results=tmp_path, executor=executor)
    assert runs.sizes["run"] == 60
    assert len(np.unique(runs["coded"], axis=0)) == 20
    done = results.analyse(study, tmp_path, runs)
    scatter = done.summary["replicates"]["z"]
    assert scatter["std"] == pytest.approx(0.1, rel=0.25)
    assert scatter["freedom"] == 2 * scatter["points"]
    table = done.summary["regression"]["linear"]["z"]
    assert table["df_pure_error"]["values"] == scatter["freedom"]
    assert table["lack_of_fit_p"]["values"] > 0.01
    page = done.report.read_text()
    assert "the pure error of z has a standard deviation of" in page


def test_the_region_of_failed_runs_is_told(tmp_path):
    """Report, summary and terminal name it; sensitivity goes on with the rest."""
    study = Study.from_mapping(STUDY)
    with ThreadPoolExecutor(1) as executor:
        runs = study.run(results=tmp_path, executor=executor)
    done = results.analyse(study, tmp_path, runs)
    sentence = done.summary["failures"]["sentence"]
    assert sentence.startswith("runs fail where x > 0.7: 18 of 18 there, 0 of 42 elsewhere")
    assert f"R{sentence[1:]}." in done.report.read_text().replace("&gt;", ">")
    assert sentence in findings.page(study, done).parts
    assert done.summary["sensitivity"]


def test_replicates_of_a_deterministic_solver_are_refused():
    words = {**STUDY, "solver": "ishigami", "parameters": {"X1": [0, 1], "X2": [0, 1]}}
    with pytest.raises(StudyError, match="replicates: replicates of a deterministic solver"):
        Study.from_mapping(words)
