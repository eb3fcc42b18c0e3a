"""README, CONTRIBUTING and docs are true: blocks run, links lead somewhere, verbs exist."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from surrogate import Study
from surrogate.cli.verbs import app as surrogate_app
from surrogate.conformance import check_solver
from surrogate_solvers.leg_bandage.cli import app as leg_bandage_app

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = sorted(
    [
        *(path for path in ROOT.glob("*.md") if path.name not in ("CHANGELOG.md", "DECISIONS.md")),
        *(path for path in (ROOT / "docs").rglob("*.md") if "generated" not in path.parts),
        *(path for path in (ROOT / "solvers").rglob("*.md")),
    ]
)
PROGRAMS = {"surrogate": surrogate_app, "leg-bandage": leg_bandage_app}
#: Folders whose files the pages name in backticks.
NAMED = r"`((?:studies|solvers|surrogate|benchmarks|tests|tools|docs|\.ci)/[\w./]*\w)`"


def blocks(page: Path, language: str) -> list[str]:
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run(*words, cwd):
    done = subprocess.run(
        [sys.executable, *words], cwd=cwd, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_ten_line_solver_goes_the_whole_way(tmp_path, monkeypatch, capsys):
    """my_beam.py and beam.yaml as printed: the command, then the Python of the page on results."""
    (solver,) = blocks(README, "python")
    (study,) = blocks(README, "yaml")
    (tmp_path / "my_beam.py").write_text(solver)
    (tmp_path / "beam.yaml").write_text(study)
    assert len([line for line in solver.splitlines() if line.strip()]) <= 11
    run("-m", "surrogate", "run", "beam.yaml", cwd=tmp_path)
    page = (ROOT / "docs" / "reference" / "results.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| `(\w+(?:\.\w+)?)/?[*.\w]*`", page, re.MULTILINE)
    written = {path.name for path in (tmp_path / "results/beam").iterdir()}
    assert "report.html" in written and written <= set(listed)
    monkeypatch.chdir(tmp_path)
    check_solver(Study.from_yaml("beam.yaml").spec.solver)
    for block in blocks(ROOT / "docs" / "reference" / "results.md", "python"):
        exec(compile(block, "results.md", "exec"), {})
    assert re.search(r"length +0\.\d+", capsys.readouterr().out)
    assert (tmp_path / "report.html").exists()


def test_the_first_two_shell_blocks_are_the_two_commands():
    """First: install and run the shipped study; second: install and run the tests."""
    first, second = blocks(README, "sh")[:2]
    assert "pip install" in first and "surrogate run studies/bandage_laplace.yaml" in first
    assert "pip install" in second and "pytest" in second


@pytest.mark.skipif(sys.platform == "win32", reason="there it has other paths")
def test_continuous_integration_runs_these_two_commands():
    """What .ci/block extracts, and the workflow runs, is the README's text."""
    for number, block in enumerate(blocks(README, "sh")[:2], start=1):
        done = subprocess.run(
            [str(ROOT / ".ci" / "block"), str(number)], capture_output=True, text=True, check=True
        )
        assert done.stdout == block
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    assert ".ci/block 1" in workflow and ".ci/run" in workflow


def test_every_study_that_ships_is_listed():
    """The table of docs/studies.md names each file in studies/, and no other."""
    shipped = {f"studies/{path.name}" for path in (ROOT / "studies").glob("*.yaml")}
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `(studies/\w+\.yaml)`", page, re.MULTILINE)) == shipped


def test_every_verb_is_at_a_glance():
    """The README's list of verbs is the command's."""
    listed = re.findall(r"^surrogate (\w+)", "\n".join(blocks(README, "")), re.MULTILINE)
    assert sorted(listed) == sorted(verbs(surrogate_app))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    """Relative links and files named in backticks exist; fragments are headings there."""
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"https?://", target):
            continue
        path, _, fragment = target.partition("#")
        found = page.parent / path if path else page
        assert found.exists(), f"{page.name} links to {target}"
        assert not fragment or fragment in fragments(found), f"{page.name} links to {target}"
    for named in re.findall(NAMED, text):
        assert (ROOT / named).exists(), f"{page.name} names {named}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_commands_exist(page):
    """Each line of a shell block that calls one of our programs uses a verb and options of it."""
    for line in "\n".join(blocks(page, "sh")).splitlines():
        program, *words = shlex.split(line, comments=True) or [""]
        if program in PROGRAMS:
            verb = verbs(PROGRAMS[program])[words[0]]
            known = {option for parameter in verb.params for option in parameter.opts}
            assert {word for word in words[1:] if word.startswith("--")} <= known, line


def verbs(app: typer.Typer) -> dict:
    return typer.main.get_command(app).commands


def fragments(page: Path) -> set[str]:
    """Fragments of a page's headings, as GitHub makes them."""
    titles = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
