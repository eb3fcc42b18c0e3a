"""Waiting for a page from outside of it, for its policy lets no text be run inside."""

from __future__ import annotations

from typing import Any


def until(page: Any, expression: str, seconds: float = 20.0) -> Any:
    """The value of a JavaScript expression as soon as it is true."""
    for _ in range(int(20 * seconds)):
        value = page.evaluate(expression)
        if value:
            return value
        page.wait_for_timeout(50)
    raise AssertionError(f"{expression} was not true within {seconds:g} s")
