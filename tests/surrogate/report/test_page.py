"""The page as a whole: one file, nothing loaded, nothing believed, everything shown."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from reader import read

from surrogate import report
from surrogate.report import Content
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

ADDRESSES = ("src", "href", "xlink:href", "action", "data", "poster", "srcset", "formaction")


def test_page_loads_nothing(study):
    """Every address in the page points inside it or carries its own data."""
    html = report.build(study(outputs=("pressure_b1", "pressure_map"))).html
    tree = read(html)
    used = [
        element.attributes[key]
        for element in tree.all()
        for key in ADDRESSES
        if key in element.attributes
    ]
    assert used and all(address.startswith(("#", "data:image/png;base64,")) for address in used)
    assert not list(tree.all("link")) and not list(tree.all("iframe"))
    policy = next(tree.all("meta", http_equiv="Content-Security-Policy"))
    assert policy.attributes["content"].startswith("default-src 'none'; img-src data:;")
    code = " ".join(element.text for name in ("style", "script") for element in tree.all(name))
    assert not re.search(r"https?:|url\(|@import|\bimport\b|fetch\(|XMLHttpRequest|WebSocket", code)


def test_links_lead_somewhere(study):
    """Every fragment in the contents is the id of one element, and ids are unique."""
    tree = read(report.build(study(outputs=("pressure_b1", "slope"))).html)
    ids = [element.attributes["id"] for element in tree.all() if "id" in element.attributes]
    assert len(ids) == len(set(ids))
    links = [element.attributes["href"] for element in tree.all("a")]
    assert {link.removeprefix("#") for link in links} <= set(ids)
    assert "#output-slope" in links


def test_hostile_words_stay_words(study):
    """Names and messages with markup are printed, not obeyed; JSON cannot end its script."""
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&"
    html = report.build(study(name=evil, failed={2: evil}, refused=evil)).html
    tree = read(html)
    assert len(list(tree.all("script"))) == 5 and not list(tree.all("img"))
    assert next(tree.all("h1")).text == evil
    assert any(cell.text == evil for cell in tree.all("td"))
    assert not [key for element in tree.all() for key in element.attributes if key[:2] == "on"]


def test_run_data_is_json_of_all_runs(study):
    """What is shown on pointing at a mark is there for each run, in physical values."""
    content = study(train=50, test=10)
    tree = read(report.build(content).html)
    data = json.loads(next(tree.all("script", id="runs-data")).children[0])
    assert list(data) == [str(number) for number in range(60)]
    value = float(content.runs["tension"].values[7])
    assert f"tension {value:.4g}" in data["7"].replace("\N{NARROW NO-BREAK SPACE}", " ")
    marked = {mark.attributes["data-run"] for mark in tree.all() if "data-run" in mark.attributes}
    assert marked == set(data)


CASES = {
    "no test design": {"test": 0},
    "all runs failed": {"train": 5, "test": 0, "failed": dict.fromkeys(range(5), "no answer")},
    "one surrogate": {"surrogates": ("linear",)},
    "field output": {"outputs": ("pressure_map", "pressure_line"), "surrogates": ("linear",)},
    "no sensitivity": {"sensitivity": False},
}


@pytest.mark.parametrize("options", CASES.values(), ids=CASES)
def test_sections_are_there_in_order(study, options):
    """The answer first, then what it rests on output by output, the runs behind, provenance."""
    tree = read(report.build(study(**options)).html)
    found = [section.attributes["id"] for section in tree.all("section")]
    assert found[0] == "answer"
    assert found[-5:] == ["screening", "parameters", "designs", "runs", "provenance"]
    outputs = options.get("outputs", ("pressure_b1",))
    assert [name for name in found if name.startswith("output")] == [
        f"output-{name}" for name in outputs
    ]


def test_runs_not_made_yet_are_not_failures(study):
    """A half-finished study says how many runs are missing, and counts none of them as failed."""
    content = study(train=40, test=10, surrogates=("linear",))
    runs = content.runs.copy(deep=True)
    runs["status"] = ("run", ["ok"] * 45 + ["missing"] * 5)
    runs["pressure_b1"].values[45:] = np.nan
    answer = next(read(report.build(replace(content, runs=runs)).html).all("section")).text
    assert "5 runs of the designs are not done yet" in answer and "failed" not in answer


def test_one_parameter_and_dependent_parameters(study):
    """One parameter has no pairs to draw; dependent parameters are said to be so."""
    one = Space((Parameter("x", uniform(0.0, 2.0)),))
    tree = read(report.build(study(one, train=12, test=5, surrogates=("quadratic",))).html)
    assert len(list(tree.all("section"))) == 8
    two = Space(
        (Parameter("x", uniform(0.0, 2.0)), Parameter("z", uniform(0.0, 1.0))),
        ((1.0, 0.6), (0.6, 1.0)),
    )
    tree = read(report.build(study(two, train=20, test=5, surrogates=("linear",))).html)
    assert "z and x (0.60)" in next(tree.all("section", id="parameters")).text


def test_nothing_but_runs(study):
    """Without fits, comparison or indices the page still shows designs and runs.

    A surrogate that could not be fitted is told as such, one that nobody asked for is not.
    """
    content = study(train=10, test=0, surrogates=("linear",))
    bare = Content(content.name, content.space, content.runs)
    text = read(report.build(bare).html).text
    assert "All 10 runs" in text and "asks for no surrogate" in text
    assert "could be fitted" not in text and "output-" not in text
    text = read(report.build(replace(bare, fits={"linear": {}})).html).text
    assert "No surrogate could be fitted" in text and "asks for no surrogate" not in text


def test_every_figure_has_a_text_and_every_column_a_head(study):
    """Drawings have a title and say what they show; tables have heads and captions."""
    tree = read(report.build(study(outputs=("pressure_b1", "pressure_map"))).html)
    words = {
        element.attributes["id"]: element for element in tree.all() if "id" in element.attributes
    }
    drawings = list(tree.all("svg", role="img"))
    assert len(drawings) > 10
    for svg in drawings:
        title, says = (
            words[svg.attributes[f"aria-{key}"]] for key in ("labelledby", "describedby")
        )
        assert (title.name, says.name) == ("title", "desc") and title.parent is svg
        assert title.text and re.search(r"\d", says.text)
    assert {svg.attributes["aria-hidden"] for svg in tree.all("svg") if svg not in drawings} <= {
        "true"
    }
    for table in tree.all("table"):
        heads = list(table.all("th", scope="col"))
        body = next(table.all("tbody"))
        assert words[table.attributes["aria-labelledby"]].text and heads
        assert all(len(row.children) >= len(heads) for row in body.all("tr"))


def test_save_is_whole_and_utf8(study, tmp_path):
    """The file holds the page and no part file is left beside it."""
    page = report.build(study(train=12, test=0, surrogates=("linear",), sensitivity=False))
    path = page.save(tmp_path / "new" / "report.html")
    assert path.read_text(encoding="utf-8") == page.html
    assert [file.name for file in path.parent.iterdir()] == ["report.html"]


@pytest.mark.parametrize("count", (3, 9))
def test_names_of_parameters_stay_inside_their_drawings(study, count):
    """Widths of DejaVu Sans at 11 units, as a browser measures them: 71.4 for mu_bandage.

    Three parameters are drawn in pairs, nine in strips with their ranges (103.5 at 9 units).
    """
    space = Space(
        tuple(
            Parameter(name, uniform(0.059, 0.137), unit="N/mm")
            for name in ("mu_bandage", *(f"p{k}" for k in range(count - 1)))
        )
    )
    tree = read(report.build(study(space=space, surrogates=("linear",), train=20)).html)
    known = {"mu_bandage": 71.4, "0.059 to 0.137 (N/mm)": 103.5}
    ends = [
        float(label.attributes["x"]) - known[label.text]
        for label in tree.all("text")
        if label.text in known
        and label.attributes.get("text-anchor") == "end"
        and "x" in label.attributes
    ]
    assert len(ends) >= 3 and min(ends) > -1.0
