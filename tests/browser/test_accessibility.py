"""Nobody is kept out: axe-core finds nothing, and a keyboard reaches everything."""

import pytest

axe = pytest.importorskip("axe_playwright_python.sync_playwright")


#: All folds; of the tables of numbers, which are all made alike, the first.
UNFOLD = """document.querySelectorAll("details:not(.behind), .verdict .behind")
  .forEach((fold) => { fold.open = true; })"""
#: Of rows of a table and of marks of a drawing that are alike but for words and places, two stay:
#: what is wrong with one is wrong with all, and axe takes a millisecond for each.
THIN_OUT = """() => {
  const kind = (one) => one.outerHTML.replace(/>[^<]*</g, "><")
    .replace(/ (?!class|style|role|aria-|tabindex)[\\w-]+="[^"]*"/g, "");
  for (const group of document.querySelectorAll("tbody, svg, svg g")) {
    const seen = {};
    for (const one of [...group.children].filter((e) => e.matches("tr, circle, rect, path, line")))
      if ((seen[kind(one)] = (seen[kind(one)] ?? 0) + 1) > 2) one.remove();
  }
}"""


def violations(page):
    """What axe-core finds when all is unfolded, a line each."""
    page.evaluate(UNFOLD)
    page.evaluate(THIN_OUT)
    found = axe.Axe().run(page, options={"resultTypes": ["violations"]})
    return [
        f"{one['id']}: {node['html'][:120]} {node['failureSummary'][:300]}"
        for one in found.response["violations"]
        for node in one["nodes"][:2]
    ]


@pytest.mark.parametrize(
    "name",
    ("bandage_laplace", "table", "categorical")
    + (pytest.param("bandage_surrogates", marks=pytest.mark.slow),),
)
def test_axe_finds_nothing(report_of, open_page, name):
    page = open_page(report_of(name)).page
    assert violations(page) == []


@pytest.mark.parametrize("name", ("table", "categorical"))
def test_axe_finds_nothing_in_the_dark(report_of, open_page, name):
    page = open_page(report_of(name), width=390, height=844, color_scheme="dark").page
    assert violations(page) == []


FOCUS = """() => {
  const at = document.activeElement;
  const style = getComputedStyle(at);
  const box = at.getBoundingClientRect();
  return { tag: at.tagName, name: at.getAttribute("aria-label") || at.textContent.trim(),
    outline: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1,
    seen: box.width > 0 && box.height > 0 && box.bottom > 0 && box.top < innerHeight };
}"""
CONTROLS = """() => [...document.querySelectorAll("a[href], button, input, summary")]
  .filter((one) => one.checkVisibility() && !one.disabled && one.tabIndex >= 0)
  .filter((one) => !(one.type === "radio" && !one.checked)).length"""


def test_every_control_is_reached_and_seen(report_of, open_page):
    """Tab goes through all links, buttons and folds; each shows that it has the focus.

    Of radio buttons and of tabs one is a stop, and the arrow keys go on from there.
    """
    page = open_page(report_of("table"), reduced_motion="reduce").page
    controls, reached = page.evaluate(CONTROLS), 0
    for _ in range(3 * controls):
        page.keyboard.press("Tab")
        focus = page.evaluate(FOCUS)
        if focus["tag"] == "BODY":
            break
        assert focus["outline"] and focus["seen"], focus
        reached += focus["tag"] in ("A", "BUTTON", "INPUT", "SUMMARY")
    assert reached == controls > 30
