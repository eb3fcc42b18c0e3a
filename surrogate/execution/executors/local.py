"""Processes on this machine."""

from __future__ import annotations

from surrogate.execution.backend import Backend, RunSettings, cores
from surrogate.execution.pool import Pool


def local(settings: RunSettings) -> Backend:
    """Processes on this machine, one a place; the default."""
    places = settings.places or cores()
    return Pool(
        settings.spec,
        settings.wanted,
        places,
        settings.threads or max(1, cores() // places),
        settings.timeout,
        settings.retries,
        settings.memory,
    )
