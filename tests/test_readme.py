"""The README is true: its solver, its study and its Python run as they stand there."""

import re
import subprocess
import sys
from pathlib import Path

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def run(*words, cwd):
    done = subprocess.run(
        [sys.executable, *words], cwd=cwd, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_ten_line_solver_goes_the_whole_way(tmp_path):
    """my_beam.py and beam.yaml as printed: the command, then the Python of the README."""
    solver, python = blocks("python")
    (study,) = blocks("yaml")
    (tmp_path / "my_beam.py").write_text(solver)
    (tmp_path / "beam.yaml").write_text(study)
    assert len([line for line in solver.splitlines() if line.strip()]) <= 11
    run("-m", "surrogate", "run", "beam.yaml", cwd=tmp_path)
    assert (tmp_path / "results/beam/report.html").exists()
    run(
        "-c",
        "from surrogate.conformance import check_solver\nfrom my_beam import Beam\n"
        "check_solver(Beam())",
        cwd=tmp_path,
    )
    run("-c", python, cwd=tmp_path)
    assert (tmp_path / "report.html").exists()


def test_the_first_two_shell_blocks_are_the_two_commands():
    """First: install and run the shipped study; second: install and run the tests."""
    first, second = blocks("sh")[:2]
    assert "pip install" in first and "surrogate run studies/bandage_laplace.yaml" in first
    assert "pip install" in second and "pytest" in second


def test_every_study_that_ships_is_listed():
    """The table of studies names each file in studies/, and no other."""
    shipped = {
        f"studies/{path.name}" for path in (Path(__file__).parent.parent / "studies").glob("*.yaml")
    }
    assert set(re.findall(r"^\| `(studies/\w+\.yaml)`", README, re.MULTILINE)) == shipped
