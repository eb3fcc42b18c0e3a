"""The words under `execution:` of a study: checked with their places, before anything runs."""

import textwrap
from concurrent.futures import ThreadPoolExecutor

import jsonschema
import pytest
import yaml

from surrogate import Study
from surrogate.errors import StudyError
from surrogate.study.schema import json_schema

STUDY = """\
study: small
solver: ishigami
parameters: {X1: [-3, 3], X2: [-3, 3], X3: [-3, 3]}
designs: {train: {method: sobol, runs: 4, seed: 1}}
execution:
  EXECUTION
"""


def study(words):
    return Study.from_text(STUDY.replace("EXECUTION", words.replace("\n", "\n  ")))


def my_threads(count: int = 2) -> ThreadPoolExecutor:
    """An executor of the user's."""
    return ThreadPoolExecutor(count)


def anything(count=2):
    """Not known to give an executor: it must not be called."""
    raise AssertionError


MISTAKES = {
    "executor: dusk": "6:13: executor 'dusk' is unknown; did you mean 'dask'?",
    "executor: dask\noptions: {adress: x}": "7:13: option 'adress' is unknown; did you mean 'addr",
    "executor: dask\noptions: {workers: many}": "7:22: option 'workers': 'many' is not accepted",
    "executor: threads\nmemory: 4 GB": "7:11: executor threads cannot watch the memory of a run",
    "memory: 4 parsecs": "6:11: memory '4 parsecs': size '4 parsecs' is not understood",
    "places: 0": "6:11: places 0: must be at least 1",
    "places: 2\nworkers: 3": "7:12: workers and places mean the same; drop one",
    "executor: 'subprocess:run'": "6:13: 'subprocess:run' is not called: an executor is a class",
    "executor: slurm\noptions: {memory: 4 parsecs}": "7:21: memory: size '4 parsecs' is not und",
    "executor: slurm\noptions: {memory: 16}": "7:21: memory: 16 has no unit; write it as in 16 GB",
    "executor: pbs\noptions: {walltime: 0 s}": "7:23: walltime: 0 s must be above 0; for exampl",
    "executor: lsf\noptions: {walltime: 12:00:00}": "7:23: walltime: duration '12:00:00' is not",
    "executor: lsf\noptions: {walltime: 720}": "7:23: walltime: 720 has no unit; write it as",
    "executor: sge\noptions: {jobs: 0}": "7:19: jobs: 0 must be 1 or more",
    "executor: slurm\noptions: {cores: many}": "7:20: option 'cores': 'many' is not accepted",
    "executor: slurm\noptions: {setup: module load x}": "7:20: option 'setup': 'module load x' is",
    "executor: slurm\noptions: {wall_time: 1 h}": "7:13: option 'wall_time' is unknown; did you",
    "executor: slurm\noptions: {walltime: 1 h}\ntimeout: 2 h": "7:23: walltime 1 h is too short",
    "executor: shared_folder\noptions: {lease: 0}": "7:20: lease: 0 s must be above 0",
    f"executor: '{__name__}:anything'": "is not called: an executor is a class",
}


@pytest.mark.parametrize("words", MISTAKES)
def test_mistakes_have_their_place(words):
    with pytest.raises(StudyError) as caught:
        study(words)
    (sentence,) = caught.value.mistakes
    assert MISTAKES[words] in sentence


def test_wrong_values_of_a_queue_are_told_all_at_once():
    words = "executor: slurm\noptions: {jobs: -1, memory: 4, walltime: soon, queues: long}"
    with pytest.raises(StudyError) as caught:
        study(words)
    assert len(caught.value.mistakes) == 4


@pytest.mark.parametrize(
    "words",
    [
        "{executor: threads, places: 2}",
        "{executor: serial}",
        "{executor: local, memory: 4 GB, places: 1}",
        "{executor: 'concurrent.futures:ThreadPoolExecutor', options: {max_workers: 2}}",
    ],
)
def test_equal_results_whatever_the_executor(tmp_path, words):
    text = STUDY.replace("\n  EXECUTION", f" {words}")
    jsonschema.validate(yaml.safe_load(text), json_schema())
    runs = Study.from_text(text).run(results=tmp_path / "a")
    plain = Study.from_text(text.replace(words, "{workers: 1}")).run(results=tmp_path / "b" / "c")
    assert (runs["status"] == "ok").all()
    assert (runs["y"] == plain["y"]).all()


def test_a_memory_limit_ends_a_run_and_says_so(tmp_path):
    (tmp_path / "greedy.py").write_text(
        textwrap.dedent("""
            import time
            from surrogate.solver import Input, Output

            class Greedy:
                version, inputs, outputs = "1", {"x": Input()}, {"y": Output()}

                def __call__(self, x):
                    if x > 0:
                        kept = bytearray(400_000_000)
                        kept[::4096] = b"1" * len(kept[::4096])
                        time.sleep(60)
                    return {"y": x}
        """)
    )
    (tmp_path / "s.yaml").write_text(
        "study: s\nsolver: 'greedy:Greedy'\nparameters: {x: [-1, 1]}\n"
        "designs: {train: {method: full_factorial, levels: 2}}\n"
        "execution: {workers: 1, memory: 300 MB}\n"
    )
    runs = Study.from_yaml(tmp_path / "s.yaml").run(results=tmp_path / "r")
    assert runs["status"].values.tolist() == ["ok", "failed"]
    assert runs["message"].values[1] == "stopped above 0.3 GB, the memory limit of a run"
