"""`surrogate export`, from a study file to a file that another program takes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import exported
import node
import pytest
from in_process import command

from surrogate.cli import completion
from surrogate.export.formats import FORMATS

ROOT = Path(__file__).parents[3]

SOLVER = """
from surrogate.solver import Input, Output


class Beam:
    version = "1"
    inputs = {
        "load": Input(unit="N", nominal=10.0, range=(0.0, 100.0)),
        "length": Input(unit="m", nominal=1.0, range=(0.1, 3.0)),
        "section": Input(levels=("box", "tube")),
        "modulus": Input(unit="GPa", nominal=210.0),
    }
    outputs = {"tip": Output(unit="mm"), "return": Output(unit="mm")}

    def __call__(self, load, length, section, modulus):
        tip = load * length**3 / modulus * (40.0 if section == "box" else 55.0)
        return {"tip": tip, "return": 2 * tip}
"""
STUDY = """
study: beam
solver: {name: "exported_beam:Beam"}
parameters:
  load:    {range: [10, 90], unit: N}
  length:  {range: [50, 200], unit: cm}
  section: {levels: [box, tube]}
constants: {modulus: 70}
designs:
  train: {method: latin_hypercube, runs: 24, seed: 1}
surrogates:
  quadratic: {method: quadratic}
  forest: {method: "sklearn.ensemble:RandomForestRegressor", options: {n_estimators: 3}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study whose runs are done."""
    place = tmp_path_factory.mktemp("exported")
    (place / "exported_beam.py").write_text(SOLVER)
    (place / "beam.yaml").write_text(STUDY)
    command("run", "beam.yaml", "--quiet", "--workers", 1, cwd=place, check=0)
    return place


def export(folder, *words, check=0):
    return command("export", "beam.yaml", *words, cwd=folder, check=check)


def predicted(folder):
    """What `surrogate predict` says at one point."""
    words = ("load=50", "length=1.5 m", "section=tube", "--surrogate", "quadratic", "--json")
    done = command("predict", "beam.yaml", *words, cwd=folder, check=0)
    return json.loads(done.stdout)[0]["outputs"]["tip"]["value"]


def test_physical_inputs_in_the_solvers_units(folder):
    """length in m, as the solver has it; the level by its number; the constant is told."""
    done = export(folder, "--output", "tip", "--format", "python", "--to", "out/tip.py")
    assert "out/tip.py is written: tip by quadratic" in " ".join(done.stdout.split())
    text = (folder / "out" / "tip.py").read_text()
    assert "length in m, from 0.5 to 2" in text and "modulus = 70" in text
    file = {}
    exec(text, file)
    assert file["tip"]([50.0, 1.5, 1.0]) == pytest.approx(predicted(folder), rel=1e-12)


def test_the_portable_document(folder):
    """As it stands in surrogates/, of one output, with what a reader needs beside it."""
    words = ("--output", "tip", "--surrogate", "quadratic", "--format", "json", "--to", "tip.json")
    told = json.loads(export(folder, *words, "--json").stdout)
    document = json.loads((folder / "tip.json").read_text())
    kept = json.loads((folder / "results/beam/surrogates/quadratic.json").read_text())["tip"]
    assert {key: document[key] for key in kept} == kept
    assert document["unit"] == "mm" and document["study"] == "beam" and 0 < document["q2"] < 1
    assert told["inputs"] == ["load", "length", "section"] and told["format"] == "json"
    assert told["bytes"] == (folder / "tip.json").stat().st_size


@pytest.mark.parametrize(
    ("words", "status", "sentence"),
    [
        (("--format", "fortran"), 2, "format 'fortran' is unknown; Allowed: c, fmu, javascript"),
        (
            ("--format", "c"),
            2,
            "a file holds one output; name it by --output. Allowed: return, tip",
        ),
        (("--format", "c", "--output", "tap"), 2, "output 'tap' is unknown; did you mean 'tip'?"),
        (("--format", "c", "--output", "return"), 2, "add --name return_value"),
        (("--format", "python", "--output", "return"), 2, "add --name return_value"),
        (
            ("--format", "c", "--output", "tip", "--surrogate", "forest"),
            2,
            "surrogate 'forest' has no portable form, which polynomials, polynomial chaos and "
            "Gaussian processes have; add --surrogate quadratic",
        ),
    ],
)
def test_mistakes_end_in_sentences(folder, words, status, sentence):
    """And nothing is written."""
    done = export(folder, *words, "--to", "nothing.txt", check=status)
    assert sentence in " ".join(done.stderr.split())
    assert not (folder / "nothing.txt").exists()


def test_the_cure_works(folder):
    """Of the output called `return`."""
    words = ("--output", "return", "--name", "return_value", "--surrogate", "quadratic")
    export(folder, *words, "--format", "c", "--to", "r.c")
    assert "double return_value(const double x[3]);" in (folder / "r.c").read_text()


def test_a_large_file_is_announced(folder, monkeypatch):
    """Before it is written."""
    monkeypatch.setattr("surrogate.cli.exporting.LARGE", 100)
    words = ("--output", "tip", "--surrogate", "quadratic", "--format", "c", "--to", "t.c")
    assert "t.c will have 0 MB" in export(folder, *words).stderr


def test_a_folder_that_is_not_ours(folder):
    """A path that cannot be written ends in a sentence."""
    (folder / "taken").write_text("")
    words = ("--output", "tip", "--format", "json", "--surrogate", "quadratic")
    done = export(folder, *words, "--to", "taken/t.json", check=1)
    assert "cannot write taken/t.json" in done.stderr


@pytest.fixture(scope="module")
def beam(tmp_path_factory):
    """The README's solver with runs of its study, exported as the page on exports says."""
    place = tmp_path_factory.mktemp("page")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (place / "my_beam.py").write_text(blocks(readme, "python")[0])
    study = blocks(readme, "yaml")[0]
    (place / "beam.yaml").write_text(study[: study.index("  gp:")])
    command("run", "beam.yaml", "--quiet", "--workers", 1, cwd=place, check=0)
    for kind, file in (("c", "tip.c"), ("python", "tip.py"), ("javascript", "tip.mjs")):
        export(place, "--format", kind, "--to", file)
    return place


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def page(language):
    """The only block in that language of the page on exports."""
    (block,) = blocks((ROOT / "docs/how_to/export.md").read_text(encoding="utf-8"), language)
    return block


def run(folder, *words):
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0 and not done.stderr, done.stderr
    return done.stdout


@exported.needs_compiler
def test_the_pages_examples_agree(beam):
    """C and Python as printed there, compiled and run."""
    (beam / "main.c").write_text(page("c"))
    strict = (exported.COMPILER, *exported.STRICT)
    run(beam, *strict, "main.c", "tip.c", "-o", "main", "-lm")
    of_c = [float(word) for word in run(beam, "./main").split()]
    (beam / "example.py").write_text(page("python"))
    first, second = run(beam, sys.executable, "example.py").splitlines()
    assert [float(word) for word in first.split()] == pytest.approx(of_c, abs=1e-6)
    assert float(second.strip("[]").split()[0]) == pytest.approx(of_c[0], abs=1e-6)


@node.needed
def test_the_pages_module_runs(beam):
    """JavaScript as printed there."""
    (beam / "example.mjs").write_text(page("js"))
    of_js = [float(word) for word in run(beam, "node", "example.mjs").split()]
    (beam / "example.py").write_text(page("python"))
    first, _ = run(beam, sys.executable, "example.py").splitlines()
    assert of_js == pytest.approx([float(word) for word in first.split()], rel=1e-9)


def test_the_shell_knows_every_format():
    """Completion has their names without loading what writes them."""
    assert completion.formats("") == list(FORMATS)
    assert completion.formats("j") == ["json", "javascript"]
