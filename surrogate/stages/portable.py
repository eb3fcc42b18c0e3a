"""Surrogates as JSON documents that evaluate without this package."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from pydantic_core import to_json

from surrogate.errors import FitError
from surrogate.stages.fits import Fits


def portable(fits: Fits) -> dict[str, dict[str, Any]]:
    """Surrogate -> output -> document, of those that have a portable form."""
    found: dict[str, dict[str, Any]] = {}
    for name, by_output in fits.items():
        for output, fit in by_output.items():
            with suppress(FitError):  # a regressor without a portable form
                found.setdefault(name, {})[output] = fit.portable()
    return found


def documents(found: dict[str, dict[str, Any]]) -> dict[str, bytes]:
    """A file a surrogate; numbers that are not known are null."""
    return {
        f"surrogates/{name}.json": to_json(by_output, inf_nan_mode="null")
        for name, by_output in found.items()
    }
