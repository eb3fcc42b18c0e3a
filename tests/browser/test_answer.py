"""The first screen: one output is looked at, and the page is there at once."""


def shown(page):
    """Outputs whose verdict is seen."""
    return page.evaluate(
        "[...document.querySelectorAll('.verdict')].filter((e) => e.checkVisibility())"
        ".map((e) => e.querySelector('strong').textContent)"
    )


def test_a_choice_of_output_switches_its_figures(report_of, open_page):
    """By a click anywhere in its row, and by the arrow keys."""
    page = open_page(report_of("bandage_shorter")).page
    assert page.locator(".outputs tbody tr").count() == 5
    assert shown(page) == ["pressure_b1:"]
    page.locator(".outputs tr", has_text="slip_max").locator("td").first.click()
    assert shown(page) == ["slip_max:"]
    assert page.locator(".verdict:visible .plot").count() == 3
    assert "slip_max" in page.locator(".verdict:visible svg title").first.text_content()
    page.keyboard.press("ArrowDown")
    assert shown(page) == ["sensor_variation:"]


def test_the_answer_is_on_the_first_screen(finished, open_page):
    """Sentence and figures of the first output stand above the fold of a usual screen."""
    page = open_page(finished, width=1440, height=900).page
    bottoms = page.evaluate(
        "[...document.querySelectorAll('.verdict:not([hidden]) .drawn')]"
        ".map((e) => e.getBoundingClientRect().bottom)"
    )
    assert len(bottoms) == 3 and max(bottoms) < 900
    assert page.locator(".outputs").count() <= 1


def test_light_and_dark(report_of, open_page):
    """As the system has it until the switch is used; paper is light."""
    page = open_page(report_of("table"), color_scheme="dark").page
    paper = "getComputedStyle(document.body).backgroundColor"
    dark = page.evaluate(paper)
    page.get_by_role("button", name="Light", exact=True).click()
    assert page.evaluate(paper) == "rgb(255, 255, 255)" != dark
    page.get_by_role("button", name="Dark", exact=True).click()
    assert page.evaluate(paper) == dark
    page.emulate_media(media="print")
    assert page.evaluate(paper) == "rgb(255, 255, 255)"
