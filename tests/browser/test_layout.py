"""Nothing is cut off and nothing makes the page scroll sideways, on a screen or on paper."""

from dataclasses import replace

import pytest
from made_up import make

from surrogate import report

WIDTHS = (1440, 1024, 390)
UNFOLD = "document.querySelectorAll('details').forEach((fold) => { fold.open = true; })"
#: What reaches beyond the page without standing in a frame that scrolls.
BEYOND = """() => [...document.querySelectorAll("body *")]
  .filter((one) => one.checkVisibility() && !one.closest("svg, .skip"))
  .filter((one) => {
    for (let frame = one.parentElement; frame !== document.body; frame = frame.parentElement)
      if (/auto|scroll/.test(getComputedStyle(frame).overflowX)) return false;
    return true;
  })
  .filter((one) => {
    const box = one.getBoundingClientRect();
    return box.width > 0 && (box.right > document.documentElement.clientWidth + 0.5
      || box.left < -0.5);
  }).map((one) => one.outerHTML.slice(0, 120))"""


@pytest.mark.parametrize("width", WIDTHS)
def test_the_page_does_not_scroll_sideways(finished, open_page, width):
    page = open_page(finished, width=width).page
    page.evaluate(UNFOLD)
    assert page.evaluate(BEYOND) == []
    assert page.evaluate("document.documentElement.scrollWidth") == width


def test_a_long_word_is_broken(open_page, tmp_path):
    """Such as the path of a file of stored runs, on a small screen."""
    content = make(surrogates=("linear",), train=12, test=0, sensitivity=False)
    path = report.build(replace(content, about="/a/long/path" * 20)).save(tmp_path / "report.html")
    page = open_page(path, width=390).page
    assert page.evaluate("document.documentElement.scrollWidth") == 390


def test_a_wide_table_scrolls_in_its_frame_under_its_heads(report_of, open_page):
    """The table of all runs: its first column and its heads stay when its frame is scrolled."""
    page = open_page(report_of("bandage_laplace"), width=390, height=844).page
    page.evaluate(UNFOLD)
    frame = page.locator("#runs .scroll")
    places = """(frame) => {
      const table = frame.firstElementChild;
      const at = (one) => { const box = one.getBoundingClientRect(); return [box.x, box.y]; };
      const edge = frame.getBoundingClientRect();
      return { sideways: frame.scrollWidth > frame.clientWidth,
        down: frame.scrollHeight > frame.clientHeight, stop: frame.tabIndex === 0,
        corner: at(table.rows[0].cells[0]), head: at(table.rows[0].cells[4])[1],
        first: at(table.rows[40].cells[0])[0], frame: [edge.x, edge.y] };
    }"""
    frame.scroll_into_view_if_needed()
    before = frame.evaluate(places)
    assert before["sideways"] and before["down"] and before["stop"]
    frame.evaluate("(frame) => frame.scrollTo(600, 900)")
    after = frame.evaluate(places)
    assert after["corner"] == pytest.approx(before["corner"], abs=1)
    assert after["first"] == pytest.approx(before["frame"][0], abs=2)
    assert after["head"] == pytest.approx(before["frame"][1], abs=2)


#: Width of the print area in px: A4 upright, and on its side where the type is smaller.
PAPER = {False: (210 - 30) / 25.4 * 96, True: (297 - 24) / 25.4 * 96}
TOO_WIDE = """([narrow, wide]) => [...document.querySelectorAll("main :is(table, figure, svg)")]
  .filter((one) => one.checkVisibility() && !one.closest(".tools"))
  .filter((one) => one.getBoundingClientRect().width
    > (one.closest(".wide:is(.table)") ? wide : narrow) + 1)
  .map((one) => one.outerHTML.slice(0, 200))"""


def test_paper_has_everything(finished, open_page):
    """In print all verdicts and folds are open, every table fits the page, tools are gone."""
    page = open_page(finished, width=int(PAPER[False])).page
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    assert page.evaluate(TOO_WIDE, [PAPER[False], PAPER[True]]) == []
    closed = "() => [...document.querySelectorAll('details:not(.behind):not([open])')].length"
    assert page.evaluate(closed) == 0
    shown = "(names) => [...document.querySelectorAll(names)].filter((e) => e.checkVisibility())"
    assert page.evaluate(f"({shown})('.tools, nav, #theme').length") == 0
    verdicts = page.evaluate("document.querySelectorAll('.verdict').length")
    assert page.evaluate(f"({shown})('.verdict').length") == verdicts >= 1
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert page.evaluate("document.querySelectorAll('table.part, table.whole').length") == 0
