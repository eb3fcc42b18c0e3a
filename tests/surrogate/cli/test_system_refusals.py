"""Disks, folders and outputs that refuse: a sentence each, never a traceback."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from surrogate.cli.verbs import main

TEXT = """\
study: s
solver: {name: ishigami}
parameters: {X1: [0, 1], X2: [0, 1], X3: [0, 1]}
designs: {train: {method: sobol, runs: 8, seed: 1}}
surrogates: {linear: {method: linear}}
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "s.yaml").write_text(TEXT)
    return tmp_path / "s.yaml"


@pytest.fixture
def command(monkeypatch, capsys, tmp_path):
    """Carry out the command; gives its exit status, what it printed and what it complained of."""
    monkeypatch.chdir(tmp_path)

    def carry_out(*words):
        monkeypatch.setattr(sys, "argv", ["surrogate", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capsys.readouterr()
        assert "internal error" not in printed.err and "Traceback" not in printed.err
        return ended.value.code or 0, printed.out, printed.err

    return carry_out


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has /dev/full")
@pytest.mark.parametrize("words", [["check", "s.yaml"], ["--help"], ["new", "other"]])
def test_a_full_output_is_a_sentence(study, words):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "surrogate", *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            cwd=study.parent,
        )
    assert done.stderr == "the output cannot be written: No space left on device\n"
    assert done.returncode == 1


@pytest.mark.parametrize("verb", ["check", "run", "status", "report", "store"])
def test_a_results_path_that_is_too_long_is_a_sentence(study, command, verb):
    status, _, said = command(verb, study, "--results", "x" * 300)
    assert status == 1 and "File name too long" in said and said.count("\n") == 1


@pytest.mark.parametrize("verb", ["check", "run", "status", "report"])
def test_a_loop_of_links_is_a_sentence(study, command, verb, tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    status, _, said = command(verb, study, "--results", tmp_path / "loop")
    assert status == 1 and "Too many levels of symbolic links" in said and said.count("\n") == 1


def test_a_neighbour_that_is_a_loop_of_links_is_passed_by(study, command, tmp_path):
    (tmp_path / "results" / "other").mkdir(parents=True)
    (tmp_path / "results" / "other" / "journal").symlink_to("journal")
    assert command("run", study)[0] == 0


def test_a_folder_that_is_no_utf_8_is_used(study, command, tmp_path):
    """Everything is written, and what is printed escapes the byte."""
    folder = tmp_path / os.fsdecode(b"bad\xff")
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this file system takes UTF-8 only")
    (folder / "s.yaml").write_text(TEXT)
    status, printed, _ = command("run", folder / "s.yaml", "--results", folder / "out")
    assert status == 0 and "bad\\udcff" in printed
    for verb in ("check", "status", "report", "store"):
        assert command(verb, folder / "s.yaml", "--results", folder / "out")[0] == 0
    assert (folder / "out" / "s" / "report.html").exists()


def test_a_report_on_a_read_only_disk_is_a_sentence(study, command, monkeypatch):
    """Nothing of the older results is lost."""
    assert command("run", study)[0] == 0

    def refuse(path, *_, **__):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    report = study.parent / "results" / "s" / "report.html"
    before = report.read_bytes()
    for name in ("unlink", "mkdir", "rename"):
        monkeypatch.setattr(os, name, refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    monkeypatch.setattr("tempfile.mkstemp", lambda dir, prefix: refuse(dir))
    status, _, said = command("report", study)
    assert status == 1 and "Read-only file system" in said
    assert report.read_bytes() == before
