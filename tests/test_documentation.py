"""The documentation is true: links, named tests, studies in it, notebooks; the site builds."""

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path

import jsonschema
import notebooks
import pytest

from surrogate.study.schema import json_schema
from surrogate.study.source import read_text

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if "generated" not in path.parts)
QUICK = DOCS / "tutorial" / "bandage_from_stored_runs.md"
NOTEBOOKS = sorted({*(DOCS / "tutorial").glob("*.md")} - {DOCS / "tutorial" / "index.md", QUICK})
#: Roles and fences of MyST whose target is a page.
TO_PAGES = (r"\{doc\}`(?:[^`<]*<)?([\w/]+)>?`", r"^:link: ([\w/]+)$")


def name_of(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


def yaml_blocks(page: Path) -> list[str]:
    """Studies and parts of studies: blocks of YAML, and files that notebooks write."""
    text = page.read_text(encoding="utf-8")
    written = re.findall(r"^%%writefile \S+\.yaml\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return re.findall(r"^```yaml\n(.*?)^```$", text, re.MULTILINE | re.DOTALL) + written


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_pages_that_pages_name_exist(page):
    """Also those of roles and of tables of contents."""
    text = page.read_text(encoding="utf-8")
    named = [name for pattern in TO_PAGES for name in re.findall(pattern, text, re.MULTILINE)]
    for block in re.findall(r"^```\{toctree\}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        named += [line for line in block.splitlines() if line and not line.startswith(":")]
    for name in named:
        made = name.startswith("gallery_of_studies/")  # from docs/gallery, by the build
        assert made or (page.parent / f"{name}.md").exists(), f"{page.name} names {name}"


def test_every_page_is_in_a_table_of_contents():
    """Whoever starts at the first page can reach all of them."""
    reached, left = set(), [DOCS / "index.md"]
    while left:
        page = left.pop()
        if page in reached or not page.exists():
            continue
        reached.add(page)
        text = page.read_text(encoding="utf-8")
        for block in re.findall(r"^```\{toctree\}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            left += [(page.parent / f"{line}.md") for line in block.splitlines() if line]
    assert reached == set(PAGES)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_yaml_is_that_of_a_study(page):
    """Each block of YAML is a study, or keys of one, as the schema has them."""
    schema = json_schema()
    schema.pop("anyOf")
    keys = set(schema["properties"])
    for block in yaml_blocks(page):
        data = read_text(block, page.name).data
        if not set(data) <= keys:  # entries of some part; the page says of which
            continue
        part = {**schema, "required": [name for name in schema["required"] if name in data]}
        jsonschema.validate(data, part)


def test_most_yaml_is_checked():
    """Blocks that are neither studies nor keys of one are few, so that none escapes."""
    keys = set(json_schema()["properties"])
    rest = [
        f"{page.name}: {block[:40]}"
        for page in PAGES
        for block in yaml_blocks(page)
        if not set(read_text(block, page.name).data) <= keys
    ]
    assert len(rest) <= 1, rest


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_named_tests_exist(page):
    """`tests/x.py::test_y` is a test there."""
    for path, name in re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", page.read_text(encoding="utf-8")):
        assert f"def {name}(" in (ROOT / path).read_text(encoding="utf-8"), f"{path}::{name}"


def test_every_option_of_a_method_is_described(monkeypatch):
    """In the docstring of the method, from which the page of methods is made."""
    monkeypatch.syspath_prepend(DOCS / "ext")
    generated = importlib.import_module("generated")
    method, bare = "", []
    for line in generated.methods().splitlines():
        method = line if line.startswith("### ") else method
        if line.startswith("| `") and line.endswith("|  |"):
            bare.append(f"{method}: {line}")
    assert not bare


def test_every_verb_is_described(monkeypatch):
    """Made from the help of the command."""
    monkeypatch.syspath_prepend(DOCS / "ext")
    page = importlib.import_module("generated").command_line("surrogate", "surrogate.cli.verbs")
    assert "## predict" in page and "`--points" in page and "|  |" not in page


def test_the_gallery_shows_studies_that_ship():
    """Each script reads files that exist, and says the command that runs its study."""
    for script in (DOCS / "gallery").glob("study_*.py"):
        text = script.read_text(encoding="utf-8")
        (study,) = re.findall(r"surrogate run (studies/\w+\.yaml)", text)
        read = re.findall(r'"\.\./\.\./(studies/\w+\.yaml)"', text)
        assert study in read and all((ROOT / path).exists() for path in read), script.name


def test_no_page_speaks_of_plans():
    for page in PAGES:
        text = page.read_text(encoding="utf-8").lower()
        assert not re.search(r"\b(coming soon|not yet implemented|todo|will be added)\b", text), (
            page
        )


def test_a_notebook_runs(tmp_path):
    """The quickest lesson; the others are slow tests."""
    assert "95 % interval" in notebooks.run(QUICK, tmp_path)


@pytest.mark.slow
def test_the_whole_way_of_the_tutorial(tmp_path):
    """What the first lesson says that its commands print."""
    printed = notebooks.run(DOCS / "tutorial" / "fifteen_minutes.md", tmp_path)
    assert "spring.yaml:8:" in printed and "did you mean 'turns'?" in printed
    assert "may be frozen: shear_modulus" in printed
    assert "spring: 52 done, 32 left" in printed
    assert "inside" in printed and "OUTSIDE" in printed
    assert (tmp_path / "results" / "spring" / "report.html").exists()


@pytest.mark.slow
@pytest.mark.parametrize("page", NOTEBOOKS, ids=name_of)
def test_notebooks_run(page, tmp_path):
    """Each lesson from top to bottom, in an empty folder."""
    notebooks.run(page, tmp_path)


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path):
    """As in continuous integration, from nothing."""
    for needed in ("sphinx", "myst_nb", "sphinx_gallery", "furo", "latex2mathml"):
        pytest.importorskip(needed)
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", DOCS, tmp_path / "site"],
        capture_output=True,
        text=True,
        env=dict(os.environ),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "site" / "index.html").exists()
