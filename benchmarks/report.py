"""How heavy a report is: size of the page, and time to its first paint in Chromium.

    python benchmarks/report.py results/bandage_laplace/report.html ...

The paint is that of a fresh page, the least of five. It needs the extra `test` (playwright) and
Chromium.
"""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from playwright.sync_api import sync_playwright

PAINT = "performance.getEntriesByType('paint').at(-1)?.startTime ?? 0"


def main() -> None:
    """Print a line a page."""
    words = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    words.add_argument("pages", nargs="+", type=Path)
    asked = words.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        for path in asked.pages:
            times = []
            for _ in range(5):
                page = browser.new_page()
                page.goto(path.resolve().as_uri())
                page.wait_for_timeout(500)
                times.append(page.evaluate(PAINT))
                page.close()
            size = path.stat().st_size / 1e6
            print(f"{path}: {size:.2f} MB, first paint after {min(times):.0f} ms")
        browser.close()


if __name__ == "__main__":
    main()
