"""A report is one file: it asks for nothing, and the browser has nothing to complain of."""


def test_nothing_leaves_the_page_and_the_console_is_silent(finished, open_page):
    opened = open_page(finished)
    opened.page.wait_for_load_state("networkidle")
    assert opened.asked == [finished.as_uri()]
    assert opened.said == []
