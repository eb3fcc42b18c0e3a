"""`surrogate work`: runs shared through the results folder, from the command."""

import json
import subprocess
import sys

from in_process import command

STUDY = """\
study: small
solver: ishigami
parameters: {X1: [-3, 3], X2: [-3, 3], X3: [-3, 3]}
designs: {train: {method: sobol, runs: 40, seed: 1}}
surrogates: {quadratic: {method: quadratic}}
execution: {executor: shared_folder, options: {lease: 30}, places: 1}
"""


def surrogate(*words, folder):
    program = [sys.executable, "-m", "surrogate", *map(str, words)]
    return subprocess.Popen(
        program, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def test_two_workers_do_a_study_and_run_makes_its_report(tmp_path):
    (tmp_path / "small.yaml").write_text(STUDY)
    both = [surrogate("work", "small.yaml", "--json", folder=tmp_path) for _ in range(2)]
    for one in both:
        out, err = one.communicate(timeout=60)
        assert one.returncode == 0, err
        assert json.loads(out)["runs"]["ok"] == 40
    segments = tmp_path / "results" / "small" / "journal" / "segments"
    records = [line for path in segments.glob("*.jsonl") for line in path.read_text().splitlines()]
    assert len(records) == 40
    command("run", "small.yaml", cwd=tmp_path, check=0)
    assert (tmp_path / "results" / "small" / "report.html").is_file()
