"""The geometry in Chromium: it follows sliders, turns, is read, and is there without scripts."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_up import make
from shown import Beam
from waiting import until

from surrogate import report
from surrogate.fitting.geometry import geometry
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

CANVAS = "#explore-profiler .s-canvas"
PIXELS = f"""() => {{
  const canvas = document.querySelector("{CANVAS}");
  const {{ data }} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let [drawn, sum] = [0, 0];
  for (let i = 0; i < data.length; i += 4) {{
    if (data[i + 3]) drawn++;
    sum = (sum * 31 + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000003;
  }}
  return [drawn, sum, canvas.width];
}}"""


@pytest.fixture(scope="module")
def beam(tmp_path_factory):
    """A report of a beam that bends: its tip has a surrogate, its shape is a geometry."""
    space = Space(
        (Parameter("load", uniform(10.0, 100.0), unit="N"), Parameter("length", uniform(0.5, 2.0)))
    )
    content = make(space, surrogates=("quadratic",), sensitivity=False)
    content = replace(content, scene=geometry(Beam().scene, space, {"colour": 0.5}))
    return report.build(content).save(tmp_path_factory.mktemp("beam") / "report.html")


def drawn(page):
    """The picture once it has settled: pixels drawn, a sum of their colours, its width."""
    until(
        page,
        f"""() => {{
          const canvas = document.querySelector("{CANVAS}");
          return canvas.dataset.fine === "true";
        }}""",
    )
    return page.evaluate(PIXELS)


def moved(page, act):
    """The settled picture after something was done."""
    page.evaluate(f"document.querySelector('{CANVAS}').dataset.fine = 'false'")
    act()
    return drawn(page)


@pytest.mark.parametrize("scheme", ("light", "dark"))
def test_the_picture_follows_sliders_and_turns(beam, open_page, scheme):
    opened = open_page(beam, color_scheme=scheme)
    page = opened.page
    first = drawn(page)
    assert first[0] > 1000
    slider = page.locator('.control[data-parameter="length"] input[type=range]')
    longer = moved(page, lambda: slider.press("PageUp"))
    assert longer != first
    canvas = page.locator(CANVAS)
    canvas.focus()
    turned = moved(page, lambda: page.keyboard.press("ArrowLeft"))
    assert turned != longer
    nearer = moved(page, lambda: page.keyboard.press("+"))
    assert nearer[0] > turned[0]
    back = moved(page, lambda: page.keyboard.press("0"))
    assert back == longer
    box = canvas.bounding_box()

    def drag():
        page.mouse.move(box["x"] + 50, box["y"] + 50)
        page.mouse.down()
        page.mouse.move(box["x"] + 90, box["y"] + 50)
        page.mouse.up()

    assert moved(page, drag) != back
    assert opened.said == []


def test_a_pointer_reads_field_and_place(report_of, open_page):
    opened = open_page(report_of("bandage_surrogates"))
    page = opened.page
    drawn(page)
    canvas = page.locator(CANVAS)
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 0.6 * box["height"])
    until(page, "document.querySelector('.s-reading').textContent.includes('mmHg')")
    reading = page.locator(".s-reading").text_content()
    assert "theta" in reading and "height" in reading
    assert "coloured by pressure_field" in canvas.get_attribute("aria-label")
    assert opened.said == []


def test_two_fingers_zoom(beam, open_page):
    opened = open_page(beam)
    page = opened.page
    first = drawn(page)
    canvas = page.locator(CANVAS)
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    screen = page.context.new_cdp_session(page)
    screen.send("Emulation.setTouchEmulationEnabled", {"enabled": True})

    def touch(kind, *halves):
        fingers = [{"x": x + s, "y": y, "id": k} for k, s in enumerate(halves)]
        screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    def spread():
        touch("touchStart", -20, 20)
        touch("touchMove", -30, 30)
        touch("touchEnd")

    nearer = moved(page, spread)
    assert nearer[0] > first[0]
    canvas.focus()
    assert moved(page, lambda: page.keyboard.press("0")) == first  # it has not turned
    assert opened.said == []


def test_nothing_sticks_out_on_a_phone(beam, open_page):
    page = open_page(beam, width=390, height=844).page
    drawn(page)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_two_views_are_shown_without_scripts_and_on_paper(beam, open_page):
    still = open_page(beam, java_script_enabled=False).page
    assert still.locator(".stills img").count() == 2
    assert still.locator(".stills").is_visible()
    page = open_page(beam).page
    drawn(page)
    assert not page.locator(".stills").is_visible()
    page.emulate_media(media="print")
    assert page.locator(".stills").is_visible()
