"""Workers of dask: of a scheduler that runs somewhere, or a cluster of this machine's own."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from surrogate.errors import PluginError, SurrogateError
from surrogate.execution.backend import Backend, RunSettings, cores
from surrogate.execution.executors.dask_runs import DaskRuns

if TYPE_CHECKING:
    from distributed import LocalCluster

MISSING = "executor {} needs dask; install it: pip install 'surrogate-studies[cluster]'"


def dask(
    settings: RunSettings, *, address: str | None = None, workers: int | None = None
) -> Backend:
    """Workers of a dask scheduler at `address`, or processes of a scheduler of its own.

    address  of a scheduler that runs, tcp://10.0.0.5:8786; default: a cluster of its own
    workers  processes of its own cluster; default: the study's places, or one a core
    """
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise PluginError(MISSING.format("dask")) from None
    return DaskRuns(
        settings, At(address) if address else Own(workers or settings.places or cores())
    )


class At:
    """A scheduler that somebody else runs, with whatever workers it has."""

    patience = 60.0

    def __init__(self, address: str):
        self.address = address

    def open(self) -> str:
        """Its address."""
        return self.address

    def tend(self, workers: set[str], wanted: int) -> None:
        """Nothing to do: workers are somebody else's."""

    def lifetime(self, worker: str) -> float | None:
        """Seconds that a worker takes runs for; None for any."""

    def absence(self) -> str | None:
        """Why no worker is there."""
        return (
            f"the dask scheduler at {self.address} has had no worker for {self.patience:g} s; "
            f"start some: dask worker {self.address}"
        )

    def close(self) -> None:
        """Leave it as it is."""


class Own(At):
    """A cluster of worker processes on this machine."""

    def __init__(self, count: int):
        super().__init__("this machine")
        self.count = count
        self.cluster: LocalCluster | None = None

    def options(self) -> dict[str, Any]:
        """More words of `distributed.LocalCluster`."""
        return {}

    def open(self) -> str:
        """Start scheduler and workers; returns the address."""
        import dask
        from distributed import LocalCluster

        with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
            self.cluster = LocalCluster(
                n_workers=self.count,
                threads_per_worker=1,
                dashboard_address=":0",
                silence_logs=logging.CRITICAL,
                memory_limit=0,
                **self.options(),
            )
        return str(self.cluster.scheduler_address)

    def absence(self) -> str | None:
        """Why no worker is there."""
        return f"no dask worker of this machine was ready within {self.patience:g} s"

    def close(self) -> None:
        """End workers and scheduler."""
        if self.cluster is not None:
            try:
                self.cluster.close(timeout=10)
            except (OSError, TimeoutError) as error:
                raise SurrogateError(f"the dask cluster does not end: {error}") from error
