"""What the analysis needs, loaded while workers start and run and this process only waits."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from surrogate.execution.progress import Progress

Told = Callable[[Progress], None]


@contextmanager
def loading(progress: Told | None) -> Iterator[Told]:
    """Who is to be told of the runs: hands it on to `progress`, and loads from the first word on.

    At the end all is loaded.
    """
    thread = threading.Thread(target=_load, name="loading")

    def told(now: Progress) -> None:
        if thread.ident is None:
            thread.start()
        if progress is not None:
            progress(now)

    try:
        yield told
    finally:
        if thread.ident is not None:
            thread.join()


def _load() -> None:
    """Modules, the digest of the code, and what xarray loads with its first dataset.

    That is pint and, where it is installed, dask. What fails here fails again, and is told,
    where it is needed.
    """
    with suppress(Exception):
        import xarray as xr

        xr.Dataset(coords={"run": [0]})
        import surrogate.cli.findings
        import surrogate.report.page  # noqa: F401
        from surrogate.stages.digest import environment

        environment()
