"""Large studies make pages that open fast."""

from __future__ import annotations

import shutil
import subprocess

import pytest
from made_up import wide_space
from reader import read

from surrogate import report
from surrogate.report.profiler.widget import program


def test_large_study_stays_below_two_megabytes(study):
    """300 runs of 20 parameters, unbounded and categorical ones among them: one small file."""
    content = study(wide_space(20), train=280, test=20, surrogates=("linear",))
    html = report.build(content).html
    assert len(html.encode()) < 2_000_000
    tree = read(html)
    folds = [fold for fold in tree.all("details") if "All 300 runs" in fold.text]
    assert len(folds) == 1 and "open" not in folds[0].attributes
    assert len(list(next(folds[0].all("tbody")).all("tr"))) == 300


def test_small_study_stays_below_200_kilobytes(study):
    """Twenty runs and one surrogate need no megabytes of script.

    The program of the profiler, which is the same for every study, counts by itself.
    """
    html = report.build(study(train=14, test=6, surrogates=("linear",))).html
    assert program() in html
    assert len(html.encode()) - len(program()) < 200_000
    assert len(program()) < 50_000


@pytest.mark.skipif(shutil.which("chromium") is None, reason="no chromium to open the page with")
def test_scripts_run_in_a_browser(study, tmp_path):
    """The script gives sortable heads their buttons, which it does only if all of it ran."""
    path = report.build(study(train=14, test=0, surrogates=("linear",))).save(tmp_path / "r.html")
    done = subprocess.run(
        [
            "chromium",
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            f"--user-data-dir={tmp_path / 'profile'}",
            "--virtual-time-budget=2000",
            "--dump-dom",
            path.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    tree = read(done.stdout)
    sortable = next(tree.all("table", class_="sortable"))
    assert len(list(sortable.all("button"))) == len(list(sortable.all("th", scope="col"))) > 5
