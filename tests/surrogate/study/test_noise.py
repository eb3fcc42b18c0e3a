"""A noisy solver from the study file to terminal, report and summary.json."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from surrogate.cli import findings, results
from surrogate.solver import Input, Output
from surrogate.study.study import Study


class Noisy:
    """x + y^2 of variance 0.42, and noise of as much."""

    version = "1"
    deterministic = False
    inputs = {"x": Input(range=(-1, 1)), "y": Input(range=(-1, 1))}
    outputs = {"z": Output(unit="mm")}

    def __init__(self):
        self.noise = np.random.default_rng(0)

    def __call__(self, x, y):
        return {"z": x + y**2 + np.sqrt(0.42) * self.noise.normal()}


STUDY = {
    "study": "noisy",
    "solver": f"{__name__}:Noisy",
    "parameters": {"x": [-1, 1], "y": [-1, 1]},
    "designs": {"train": {"method": "latin_hypercube", "runs": 60, "seed": 1}},
    "surrogates": {"gp": "gaussian_process"},
    "sensitivity": "sobol",
}


def analysed(folder, **words):
    study = Study.from_mapping({**STUDY, **words})
    with ThreadPoolExecutor(1) as executor:
        runs = study.run(results=folder, executor=executor)
    return study, results.analyse(study, folder, runs)


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    return analysed(tmp_path_factory.mktemp("single") / "noisy")


def test_half_noise_is_told_with_the_learning_curves_answer(single):
    """60 runs: intervals are wide, and terminal, report and summary say why and what helps."""
    study, done = single
    told = done.summary["noise"]["z"]
    assert told["share"] == pytest.approx(0.5, abs=0.15)
    assert told["surrogate"] == "gp" and "Run some points several times" in told["sentence"]
    curve = done.summary["learning"]["sentence"]["values"][0][0].splitlines()[0]
    lines = findings.page(study, done).parts
    assert f"{told['sentence']}." in lines and f"z: {curve}" in lines
    page = done.report.read_text().replace("²", "2")
    assert f"{told['sentence']}. Learning curve: {curve}." in page


def test_replicates_narrow_the_intervals(single, tmp_path):
    """Four replicates of the same: what the noise hides no longer counts as missed."""
    widths = []
    for _, done in (single, analysed(tmp_path / "noisy", replicates=4)):
        table = done.summary["sensitivity"]
        low, high = (np.array(table[f"total_{end}"]["values"][0]) for end in ("low", "high"))
        assert (low <= [0.79, 0.21]).all() and (high >= [0.79, 0.21]).all()
        widths.append((high - low).max())
    assert done.summary["noise"]["z"]["points"] == 60
    assert not table["refused"]["values"][0]
    assert widths[1] < 0.6 * widths[0]


def test_a_quiet_solver_has_no_curve_that_nobody_asked_for(tmp_path):
    words = {"solver": "ishigami", "parameters": {"X1": [0, 1], "X2": [0, 1]}}
    _, done = analysed(tmp_path / "noisy", **words)
    assert done.summary["noise"] == {} and done.summary["learning"] is None
