"""Nothing that is printed is wider than the terminal, and nothing of it is lost."""

import re
from functools import cache

import in_process
import pytest
import typer

from surrogate.cli import browsing
from surrogate.cli.table import Table, wrapped
from surrogate.cli.verbs import app

LONG = "a_name_that_somebody_liked_to_be_as_clear_as_it_can_be"
STUDY = f"""\
study: wide
about: {"Which of the many things that one may ask about a borehole is asked here? " * 3}
solver: borehole
parameters: {{rw: [0.05, 0.15], L: [1120, 1680], Kw: [9855, 12045]}}
constants: {{Tl: 90, Hu: 1050}}
designs:
  train: {{method: fractional_factorial, generators: [C=AB], center_points: 4}}
  test: {{method: latin_hypercube, runs: 6, seed: 2}}
surrogates:
  {LONG}: linear
  gp: gaussian_process
  {LONG}_2: linear
sensitivity: {{method: sobol, groups: {{{LONG}: [rw, L], Kw: [Kw]}}}}
screening: {{freeze_below: 0.02}}
validation: {{cases: cases.csv}}
calibration: {{cases: measured.csv, free: [Kw], error: 5, surrogate: {LONG}, draws: 100}}
"""
AT = ["rw=0.1", "L=1400", "Kw=10000"]
#: Verb with its words, and whether its result is text, which --quiet leaves.
VERBS = {
    "check": (["check", "wide.yaml"], False),
    "run": (["run", "wide.yaml"], False),
    "status": (["status", "wide.yaml"], True),
    "report": (["report", "wide.yaml"], False),
    "predict": (["predict", "wide.yaml", *AT], True),
    "solve": (["solve", "wide.yaml", "--target", "flow=70"], True),
    "validate": (["validate", "wide.yaml"], True),
    "store": (["store", "wide.yaml"], False),
    "export": (["export", "wide.yaml", "--format", "c", "--to", f"{LONG}.c"], False),
    "calibrate": (["calibrate", "wide.yaml"], True),
    "compare": (["compare", "results/wide", "results/wide"], False),
    "dossier": (["dossier", "wide.yaml"], False),
    "open": (["open", "wide.yaml"], False),
    "work": (["work", "wide.yaml"], False),
    "list": (["list"], True),
    "new": (["new", "mine"], False),
    "help": (["--help"], None),
    "help of a verb": (["run", "--help"], None),
}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with the study, and its results."""
    folder = tmp_path_factory.mktemp("wide")
    (folder / "wide.yaml").write_text(STUDY)
    (folder / "cases.csv").write_text("rw,L,Kw,flow\n0.1,1400,10000,70\n0.12,1300,11000,110\n")
    (folder / "measured.csv").write_text("rw,L,flow\n0.1,1400,70\n0.12,1300,110\n")
    in_process.command("run", "wide.yaml", "--quiet", cwd=folder, check=0)
    return folder


@pytest.fixture(scope="module")
def printed(place):
    """What words print at a width (None: there is no terminal), carried out once each."""

    @cache
    def carried_out(*words, columns=None):
        (place / "mine.yaml").unlink(missing_ok=True)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(browsing, "browse", lambda path: True)
            patch.delenv("COLUMNS", raising=False)
            if columns is not None:
                patch.setenv("COLUMNS", str(columns))
            return in_process.command(*words, cwd=place, check=0)

    return carried_out


def test_every_verb_is_looked_at_and_takes_quiet():
    """All but serve, which does not end, and schema, which prints JSON."""
    verbs = typer.main.get_command(app).commands
    assert {*verbs} - {"serve", "schema"} <= {*VERBS}
    for name, verb in verbs.items():
        assert "--quiet" in {word for one in verb.params for word in one.opts}, name


@pytest.mark.parametrize("verb", VERBS)
def test_no_line_is_wider_than_the_terminal(printed, verb):
    """80 columns where there is none."""
    for columns in (None, 50):
        done = printed(*VERBS[verb][0], columns=columns)
        assert done.stdout
        for line in (done.stdout + done.stderr).splitlines():
            assert len(line.rstrip()) <= (columns or 80), line


@pytest.mark.parametrize("verb", ["check", "run", "validate"])
def test_nothing_is_cut(printed, verb):
    """Names in a narrow terminal are those of a wide one, put together again."""
    wide, narrow = (printed(*VERBS[verb][0], columns=n).stdout for n in (500, None))
    assert LONG in wide
    assert set(re.findall(r"\w+", wide)) <= set(re.findall(r"\w+", narrow))


@pytest.mark.parametrize("verb", [verb for verb, (_, text) in VERBS.items() if text is not None])
def test_quiet(printed, verb):
    words, text = VERBS[verb]
    done = printed(*words, "--quiet")
    assert done.stderr == "" and bool(done.stdout) == text


def test_a_table_breaks_into_blocks_and_repeats_the_names():
    figures = ("0.1134 [0.0987, 0.1550]",) * 5
    table = Table("t", ("parameter", *"abcde"), [("rw", *figures), ("L", *figures)])
    for width in (200, 80, 40, 24, 11):
        lines = [line for line, _ in table.lines(width)]
        assert max(map(len, lines)) <= width
        assert "".join("".join(lines).split()).count("0.1134") == 10
    lines = [line for line, _ in table.lines(80)]
    assert sum(line.startswith("parameter") for line in lines) == 3
    assert all(figures[0] in line for line in lines if line.startswith("rw"))


def test_text_wraps_between_words():
    assert wrapped("  a bb ccc [d, e]", 10, "    ") == ["  a bb ccc", "    [d, e]"]
    assert wrapped("x" * 10, 4) == ["xxxx", "xxxx", "xx"]
    assert wrapped("", 4) == [""]


def test_open_says_how_to_make_the_report_and_when_it_is_old(printed, place):
    assert printed("open", "wide.yaml").stdout == "results/wide/report.html\n"
    text = STUDY.replace("freeze_below: 0.02", "freeze_below: 0.2")
    (place / "changed.yaml").write_text(text)
    assert "older" in printed("open", "changed.yaml").stderr
    unmade = in_process.command("open", "wide.yaml", "--results", "none", cwd=place, check=1)
    assert "`surrogate run wide.yaml` makes it" in unmade.stderr
