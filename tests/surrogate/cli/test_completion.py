"""What a shell is offered at TAB, asked as bash, zsh and fish ask."""

import os
import subprocess
import sys

import pytest

STUDY = """\
study: s
solver: borehole
parameters:
  rw: [0.05, 0.15]
  L: {range: [1000, 2000], unit: m}
  Hu: {values: [990, 1000, 1110]}
  fabric: {levels: [soft, stiff]}
surrogates: {gp: gaussian_process, linear: linear}
solve: {thick: {target: {flow: 70}}, thin: {target: {flow: 60}}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("completion")
    (place / "studies").mkdir()
    (place / "results").mkdir()
    for path in ("first.yaml", "studies/second.yaml", "results/old.yaml", ".hidden.yaml"):
        (place / path).write_text(STUDY)
    (place / "other.yaml").write_text("a: 1\n")
    (place / "broken.yaml").write_text("study: [\n")
    return place


def asked(folder, **environment):
    done = subprocess.run(
        [sys.executable, "-m", "surrogate"],
        env={**os.environ, **environment},
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert done.stderr == ""
    return done.stdout


def bash(folder, *words):
    """What bash offers for the last of the words."""
    told = {"COMP_WORDS": "\n".join(["surrogate", *words]), "COMP_CWORD": str(len(words))}
    return asked(folder, **told, _SURROGATE_COMPLETE="complete_bash").split()


def test_study_files(folder):
    """YAML files that are studies, also in the folders next below; results hold none."""
    files = {"first.yaml", "broken.yaml", "studies/second.yaml"}
    assert set(bash(folder, "run", "")) == files
    assert bash(folder, "check", "stu") == ["studies/second.yaml"]
    assert bash(folder, "check", "studies/s") == ["studies/second.yaml"]
    assert bash(folder, "check", f"{folder}/f") == [f"{folder}/first.yaml"]
    assert bash(folder, "check", "none/f") == []


def test_verbs_and_options(folder):
    assert bash(folder, "sta") == ["status"]
    assert {"--json", "--quiet", "--results"} <= set(bash(folder, "status", "--"))


def test_surrogates_of_the_study(folder):
    assert bash(folder, "predict", "first.yaml", "--surrogate", "") == ["gp", "linear"]
    assert bash(folder, "serve", "first.yaml", "--surrogate", "l") == ["linear"]
    assert bash(folder, "serve", "broken.yaml", "--surrogate", "l") == []


def test_parameters_of_predict_that_have_no_value_yet(folder):
    """Each with a value amid its range: two words, so that no blank follows the `=`."""
    offered = bash(folder, "predict", "first.yaml", "")
    assert offered == ["rw=", "rw=0.1", "L=", "L=1500", "Hu=", "Hu=1000"] + [
        "fabric=",
        "fabric=soft",
        "fabric=stiff",
    ]
    assert bash(folder, "predict", "first.yaml", "rw=0.1", "r") == []
    assert bash(folder, "predict", "first.yaml", "rw", "=", "0.1", "r") == []


def test_goals_and_parameters_of_solve(folder):
    assert bash(folder, "solve", "first.yaml", "th") == ["thick", "thin"]
    assert bash(folder, "solve", "first.yaml", "--fix", "r") == ["rw=", "rw=0.1"]
    assert bash(folder, "solve", "first.yaml", "--free", "") == ["rw", "L", "Hu", "fabric"]


def test_zsh_and_fish(folder):
    zsh = asked(
        folder,
        _TYPER_COMPLETE_ARGS="surrogate predict first.yaml --surrogate ",
        _SURROGATE_COMPLETE="complete_zsh",
    )
    assert '"gp"' in zsh and '"linear"' in zsh
    fish = asked(
        folder,
        _TYPER_COMPLETE_ARGS="surrogate predict first.yaml r",
        _TYPER_COMPLETE_FISH_ACTION="get-args",
        _SURROGATE_COMPLETE="complete_fish",
    )
    assert fish.split() == ["rw=", "rw=0.1"]


@pytest.mark.skipif(not os.path.exists("/bin/bash"), reason="bash itself")
def test_the_script_that_is_installed_works_in_bash(folder):
    """The shell sources what --show-completion prints, and completes with it."""
    script = subprocess.run(
        [sys.executable, "-m", "surrogate"],
        env={**os.environ, "_SURROGATE_COMPLETE": "source_bash"},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    (folder / "surrogate").write_text(f'#!/bin/sh\nexec {sys.executable} -m surrogate "$@"\n')
    (folder / "surrogate").chmod(0o755)
    ask = (
        f"{script}\nCOMP_WORDS=(surrogate run stu); COMP_CWORD=2\n"
        'PATH="$PWD:$PATH" _surrogate_completion surrogate\nprintf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "--norc", "-c", ask], cwd=folder, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["studies/second.yaml"]


def test_nothing_heavy_is_loaded(folder):
    """It has to answer while somebody waits with a finger at TAB."""
    code = (
        "import sys, runpy\nsys.argv = ['surrogate']\ntry:\n"
        "    runpy.run_module('surrogate', run_name='__main__')\n"
        "except SystemExit:\n    pass\n"
        "print([m for m in ('numpy', 'xarray', 'pint', 'surrogate.study') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={
            **os.environ,
            "COMP_WORDS": "surrogate\npredict\nfirst.yaml\nr",
            "COMP_CWORD": "3",
            "_SURROGATE_COMPLETE": "complete_bash",
        },
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stdout.splitlines()[-1] == "[]"
