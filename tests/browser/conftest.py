"""Chromium and finished reports for it to open.

The browser is `CHROMIUM` of the environment or the `chromium` of the system; without one, or
without playwright, the tests of this folder are skipped. They share one worker, for playwright
runs an event loop in the process, which other tests must not meet: the browser is closed when
the last test of this folder is done.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from made_up import make, table_of_beams, wide_space

from surrogate import report
from surrogate.cli import results
from surrogate.study.study import Study

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

STUDIES = Path(__file__).parents[2] / "studies"
FLAGS = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip
BEAMS = """\
study: beams
about: How far does a beam bend?
data:
  file: beams.csv
  outputs: {deflection: {unit: mm}}
surrogates: {linear: linear, quadratic: quadratic}
sensitivity: {method: sobol}
screening: {freeze_below: 0.02}
"""


#: `bandage_surrogates` on fewer of its runs: all its outputs, stored runs, three surrogates.
SHORTER = {
    "study: bandage_surrogates": "study: bandage_shorter",
    "runs: 128": "runs: 24",
    "  interactions: {method: interactions}\n": "",
    "  quadratic:    {method: quadratic}\n": "",
    "stored: ../solvers": f"stored: {(STUDIES.parent / 'solvers').as_posix()}",
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """One worker for all tests with a browser."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.xdist_group("browser"))


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """A running Chromium."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if program is None:
        pytest.skip("no chromium here; name one in the environment variable CHROMIUM")
    with sync_api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
        yield running
        running.close()


@dataclass
class Opened:
    """A page in the browser, what it has said on the console, and what it has asked for."""

    page: Page
    said: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)

    def note(self, address: str) -> None:
        """Keep an address that was asked for; a `blob:` is the page's own memory (its worker)."""
        if not address.startswith("blob:"):
            self.asked.append(address)


@pytest.fixture
def open_page(browser: Browser) -> Iterator[Callable[..., Opened]]:
    """Opens a file: `open_page(path, width=390, height=844, color_scheme="dark")`."""
    contexts = []

    def go(path: Path, width: int = 1440, height: int = 900, **options: Any) -> Opened:
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        opened = Opened(context.new_page())
        opened.page.on("console", lambda said: opened.said.append(f"{said.type}: {said.text}"))
        opened.page.on("pageerror", lambda error: opened.said.append(f"error: {error}"))
        opened.page.on("request", lambda request: opened.note(request.url))
        opened.page.goto(path.as_uri())
        return opened

    yield go
    for context in contexts:
        context.close()


def _run(study: Path, folder: Path) -> Path:
    """The report of a study, its runs done in this process or read from those that ship."""
    read = Study.from_yaml(study)
    results.analyse(read, folder, read.run(results=folder, workers=1))
    return folder / "report.html"


def _table(folder: Path) -> Path:
    (folder / "beams.csv").write_text(table_of_beams())
    (folder / "beams.yaml").write_text(BEAMS)
    return _run(folder / "beams.yaml", folder / "results")


def _shorter(folder: Path) -> Path:
    text = (STUDIES / "bandage_surrogates.yaml").read_text(encoding="utf-8")
    for words, others in SHORTER.items():
        assert words in text
        text = text.replace(words, others)
    (folder / "bandage_shorter.yaml").write_text(text, encoding="utf-8")
    return _run(folder / "bandage_shorter.yaml", folder / "results")


def _categorical(folder: Path) -> Path:
    content = make(wide_space(6), outputs=("pressure_b1", "slope"), screened=True)
    return report.build(content).save(folder / "report.html")


@pytest.fixture(scope="session")
def report_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Path of a finished report, made when it is first asked for.

    `bandage_laplace`: two outputs, screened; `bandage_surrogates`: five outputs, one of them a
    field, stored runs, and `bandage_shorter`, the same on fewer runs; `table`: measured beams, no
    solver; `categorical`: made-up runs with a categorical and a normal parameter, two outputs.
    """
    makers = {"table": _table, "categorical": _categorical, "bandage_shorter": _shorter}

    @cache
    def path(name: str) -> Path:
        folder = tmp_path_factory.mktemp(name)
        if name in makers:
            return makers[name](folder)
        return _run(STUDIES / f"{name}.yaml", folder)

    return path


REPORTS = (
    "bandage_laplace",
    "bandage_shorter",
    "table",
    "categorical",
    pytest.param("bandage_surrogates", marks=pytest.mark.slow),
)


@pytest.fixture(params=REPORTS)
def finished(request: pytest.FixtureRequest, report_of: Callable[[str], Path]) -> Path:
    """Each of the finished reports in turn."""
    return report_of(request.param)
