"""Verbs that compute nothing answer at once: what they would have to load stays unloaded."""

import json
import subprocess
import sys

import pytest

HEAVY = ("numpy", "scipy", "sklearn", "xarray", "pandas", "pint", "skfem")
SCRIPT = """
import json, sys
from surrogate.__main__ import main
sys.argv[0] = "surrogate"
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
print(json.dumps([name for name in {heavy} if name in sys.modules]), file=sys.stderr)
"""


def loaded_by(*words: str, heavy: tuple[str, ...] = HEAVY) -> tuple[str, list[str]]:
    """What a verb prints, and which of the heavy packages it loaded."""
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(heavy=heavy), *words],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    return done.stdout, json.loads(done.stderr.splitlines()[-1])


def test_help_loads_nothing_heavy_and_names_every_verb():
    from surrogate.cli.verbs import app

    printed, loaded = loaded_by("--help", heavy=(*HEAVY, "pydantic", "rich"))
    assert loaded == []
    for verb in app.registered_commands:
        assert f"  {verb.name or verb.callback.__name__} " in printed
    assert "A study is code" in printed


@pytest.mark.parametrize(
    "word, said", [("--version", "."), ("schema", '"$schema"'), ("list", "latin_hypercube")]
)
def test_small_verbs_load_nothing_heavy(word, said):
    printed, loaded = loaded_by(word)
    assert said in printed and loaded == []


def test_every_built_in_plugin_is_described_without_importing_it():
    """The line of `list` is the first of the documentation that Python finds by importing."""
    from surrogate.study.catalogue import _in_source, _when_imported, catalogue
    from surrogate.study.plugins import NOUNS, available

    for group in NOUNS:
        for name, point in available(group).items():
            lines = {text.split("\n")[0] for text in (_when_imported(point),) if text}
            assert lines == {catalogue()[group.rsplit(".", 1)[-1]][name]}, name
            assert _in_source(point.module, point.attr), name


def test_a_reader_that_has_seen_enough_is_no_trouble():
    """`surrogate --help | head -1` says nothing of a broken pipe."""
    words = f"{sys.executable} -m surrogate schema"
    done = subprocess.run(
        ["bash", "-c", f"{words} | head -c 1"], capture_output=True, text=True, timeout=60
    )
    assert done.stderr == ""


def test_a_study_in_the_solvers_own_units_loads_no_pint(tmp_path):
    """Loading pint and its units takes longer than reading such a study."""
    code = (
        "import sys; from surrogate.study.template import write; from surrogate import Study\n"
        "Study.from_yaml(write('own')); print('pint' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, cwd=tmp_path
    )
    assert done.stdout.strip() == "False", done.stderr
