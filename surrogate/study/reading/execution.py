"""From the words under `execution:` to how the runs are carried out."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from surrogate.errors import Mistake, StudyError
from surrogate.execution.backend import Start
from surrogate.execution.executors.futures import factory
from surrogate.execution.shared.work import Shared
from surrogate.study import plugins
from surrogate.study.kinds import check_kind
from surrogate.study.options import option_mistakes
from surrogate.study.parts.execution import ExecutionPart
from surrogate.study.reading.mistakes import Reading

#: The first parameter of an executor's function, which is no option.
GIVEN_TO_EXECUTORS = ("settings",)


def check_execution(reading: Reading) -> None:
    """The executor exists and takes its options; nothing of it is called yet."""
    part = reading.part.execution
    if reading.is_broken("execution"):
        return
    if part.places is not None and part.workers is not None:
        reading.wrong("workers and places mean the same; drop one", "execution", "workers")
    with reading.mistakes_at("execution", "executor"):
        found = _found(part, reading.folder)
        reading.add(_option_mistakes(found, part), "execution", "options")
    if part.memory is not None and not _limits_memory(part.executor):
        reading.wrong(
            f"executor {part.executor} cannot watch the memory of a run; drop memory, or use "
            "local, dask, a queue or shared_folder",
            "execution",
            "memory",
        )


def _option_mistakes(executor: Any, part: ExecutionPart) -> list[Mistake]:
    """Names and types of options by the signature; of values what the executor itself says."""
    own = list(getattr(executor, "mistakes", _no_mistakes)(part.options, part.timeout))
    told = {mistake.path for mistake in own}
    found = option_mistakes(executor, part.options, GIVEN_TO_EXECUTORS)
    return [*own, *(mistake for mistake in found if mistake.path not in told)]


def _no_mistakes(options: Mapping[str, Any], timeout: float | None) -> tuple[Mistake, ...]:
    """An executor whose signature says all."""
    return ()


def starter(part: ExecutionPart, folder: Path | None) -> Start | Shared | None:
    """What makes the backend of the runs; None for local processes."""
    if part.executor == "local":
        return None
    found = _found(part, folder)
    if found is Shared:
        return Shared(**part.options)
    if ":" in part.executor:
        return partial(factory, partial(found, **part.options), part.executor)
    return partial(found, **part.options)


def _found(part: ExecutionPart, folder: Path | None) -> Any:
    found = plugins.load(plugins.EXECUTORS, part.executor, folder)
    check_kind(plugins.EXECUTORS, part.executor, found)
    if not callable(found):
        raise StudyError(f"'{part.executor}' is no function that gives an executor")
    return found


def _limits_memory(executor: str) -> bool:
    return executor not in ("threads", "serial") and ":" not in executor
