"""A split-plot study from its words to the report: both errors are told."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from surrogate.cli import results
from surrogate.solver import Input, Output
from surrogate.study.study import Study


class Furnace:
    """Strength by temperature, set once in a load, and time; loads scatter by 1, runs by 0.3."""

    version = "1"
    deterministic = False
    inputs = {
        "temperature": Input(unit="degC", range=(150, 250)),
        "time": Input(unit="min", range=(10, 30)),
        "load": Input(levels=tuple(f"l{k}" for k in range(8))),
    }
    outputs = {"strength": Output(unit="MPa")}

    def __init__(self):
        self.noise = np.random.default_rng(0)
        self.shift = dict(zip(self.inputs["load"].levels, self.noise.normal(size=8), strict=True))

    def __call__(self, temperature, time, load):
        mean = 0.02 * temperature + 0.1 * time
        return {"strength": mean + self.shift[load] + 0.3 * self.noise.normal()}


STUDY = {
    "study": "furnace",
    "solver": f"{__name__}:Furnace",
    "parameters": {
        "temperature": [150, 250],
        "time": [10, 30],
        "load": {"levels": [f"l{k}" for k in range(8)]},
    },
    "designs": {
        "train": {
            "method": "split_plot",
            "whole_plots": "load",
            "hard_to_change": ["temperature"],
            "levels": {"time": 3},
        }
    },
    "surrogates": {"mixed": {"method": "mixed_model", "options": {"random": "load"}}},
}


def test_both_errors_are_told(tmp_path):
    study = Study.from_mapping(STUDY)
    with ThreadPoolExecutor(1) as executor:
        runs = study.run(results=tmp_path, executor=executor)
    assert runs.sizes["run"] == 24
    done = results.analyse(study, tmp_path, runs)
    table = done.summary["regression"]["mixed"]["strength"]
    assert (table["df_between"]["values"], table["df_within"]["values"]) == (6, 15)
    assert 0.4 < table["sd_between"]["values"] < 2.0
    assert 0.15 < table["sd_within"]["values"] < 0.6
    page = done.report.read_text()
    assert "Standard deviation between levels of load" in page
    assert "are tested with 6 degrees of freedom, the others with 15" in page
