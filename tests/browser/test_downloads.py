"""What is downloaded of a figure is the figure: its drawing by itself, and its numbers."""

import csv
import io
import struct
import xml.etree.ElementTree as ElementTree

import pytest

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def figure(report_of, open_page):
    """Parity of the first output on a dark page."""
    page = open_page(report_of("bandage_laplace"), color_scheme="dark").page
    return page.locator(".verdict:visible .plot").first


def downloaded(figure, kind):
    with figure.page.expect_download() as waiting:
        figure.get_by_role("button", name=kind).click()
    name = waiting.value.suggested_filename
    return name, waiting.value.path().read_bytes()


def test_svg_stands_alone(figure):
    """Readable without the page's style sheet, light, with title and description."""
    name, content = downloaded(figure, "SVG")
    assert name == "gp-predicted-against-simulated-pressure_b1.svg"
    root = ElementTree.fromstring(content)
    assert root.find(f"{SVG}title").text == "gp: predicted against simulated pressure_b1"
    assert "30 held-out runs" in root.find(f"{SVG}desc").text
    marks = list(root.iter(f"{SVG}circle"))
    assert len(marks) == 30
    for mark in root.iter():
        assert "var(" not in mark.get("style", "") and mark.get("class") is None
    assert all("fill: rgb(22, 80, 138)" in mark.get("style") for mark in marks)


def test_png_has_twice_the_points(figure):
    name, content = downloaded(figure, "PNG")
    assert name.endswith(".png") and content[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", content[16:24])
    view = figure.locator(".drawn svg").get_attribute("viewBox").split()
    assert (width, height) == tuple(2 * (int(side) + 16) for side in view[2:])
    assert len(content) > 5_000  # more than an empty sheet


def test_csv_has_the_numbers_of_the_drawing(figure):
    """The places of the marks, read back from the numbers, fall on one straight line each."""
    name, content = downloaded(figure, "CSV")
    rows = list(csv.DictReader(io.StringIO(content.decode("utf-8-sig"))))
    assert name.endswith(".csv") and len(rows) == 30
    marks = {
        mark["run"]: (float(mark["x"]), float(mark["y"]))
        for mark in figure.locator("circle").evaluate_all(
            "(marks) => marks.map((m) => ({ run: m.dataset.run, x: m.getAttribute('cx'),"
            " y: m.getAttribute('cy') }))"
        )
    }
    for place, key in ((0, "simulated (mmHg)"), (1, "predicted (mmHg)")):
        ordered = sorted((float(row[key]), marks[row["run"]][place]) for row in rows)
        (low, start), (high, end) = ordered[0], ordered[-1]
        for value, at in ordered:
            assert at == pytest.approx(
                start + (value - low) / (high - low) * (end - start), abs=0.2
            )


def test_every_figure_has_numbers(finished, open_page):
    """Rows of one length under heads, none of them empty."""
    page = open_page(finished).page
    sizes = page.evaluate("""[...document.querySelectorAll(".plot")].map((figure) => {
      const rows = [...figure.querySelector(".numbers").rows];
      return [rows.length, Math.min(...rows.map((r) => r.cells.length)),
        Math.max(...rows.map((r) => r.cells.length))];
    })""")
    assert len(sizes) > 10
    assert all(rows >= 2 and least == most >= 2 for rows, least, most in sizes)
