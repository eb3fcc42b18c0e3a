"""The part `execution:`: where and how the runs are carried out."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from surrogate.study.parts.part import Part
from surrogate.study.parts.values import Duration, Size


class ExecutionPart(Part):
    """How the runs are carried out."""

    executor: str = Field(
        "local",
        description="Where: local, threads, serial, dask, slurm, pbs, lsf, sge, shared_folder, "
        "or module:function that gives an executor of concurrent.futures.",
        examples=["slurm"],
    )
    options: dict[str, Any] = Field(
        {}, description="Options of that executor.", examples=[{"jobs": 20, "walltime": "12 h"}]
    )
    places: int | None = Field(
        None,
        ge=1,
        description="Runs at once. Default: one a core, or all that a cluster has.",
        examples=[8],
    )
    workers: int | None = Field(None, ge=1, description="Another word for places.", examples=[2])
    memory: Size = Field(
        None,
        description="Most memory of a run, with the programs that it starts (Linux). A run that "
        "holds more is ended and is a failed run.",
        examples=["4 GB"],
    )
    timeout: Duration = Field(
        None,
        description="Longest time of a run. A run that takes longer is ended and is a failed run.",
        examples=["30 s", "30 min", "2 h"],
    )
    retries: int = Field(
        0,
        ge=0,
        description="Further attempts of a run that crashed, hung or raised an exception.",
        examples=[1],
    )

    @property
    def at_once(self) -> int | None:
        """Runs at once; None for as many as there is room for."""
        return 1 if self.executor == "serial" else self.places or self.workers
