"""The figures of a study as JSON data."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, overload

import numpy as np
import xarray as xr

from surrogate.runs import dataset as rundata
from surrogate.runs.levels import costs


def summary(
    name: str, runs: xr.Dataset, figures: Mapping[str, Any], not_done: Sequence[str], stamp: str
) -> dict[str, Any]:
    """The figures of all stages, with the number of runs by status and by stored file."""
    return {
        "study": name,
        "stamp": stamp,
        "runs": rundata.counts(runs),
        "stored": rundata.described(runs, "stored"),
        **({"levels": costs(runs)} if rundata.level_names(runs) else {}),
        **figures,
        "not_done": not_done,
    }


@overload
def figures_of(dataset: xr.Dataset) -> dict[str, Any]: ...
@overload
def figures_of(dataset: None) -> None: ...
def figures_of(dataset: xr.Dataset | None) -> dict[str, Any] | None:
    """A dataset's numbers as JSON data."""
    if dataset is None:
        return None
    return {
        "attributes": {str(k): json_data(v) for k, v in dataset.attrs.items()},
        **{
            str(name): {
                "dimensions": list(map(str, values.dims)),
                "values": json_data(values.values),
            }
            for name, values in {**dataset.coords, **dataset.data_vars}.items()
        },
    }


def figures_by_output(tables: Mapping[str, Mapping[str, xr.Dataset]]) -> dict[str, Any]:
    """Surrogate -> output -> figures."""
    return {
        name: {output: figures_of(one) for output, one in by.items()} for name, by in tables.items()
    }


def text(summary: Mapping[str, Any]) -> str:
    """The content of summary.json."""
    return json.dumps(summary, indent=1, allow_nan=False)


def json_data(value: Any) -> Any:
    """JSON data of numbers, arrays, lists and mappings; what is not finite becomes null."""
    if isinstance(value, np.ndarray | np.generic):
        return json_data(value.tolist())
    if isinstance(value, list | tuple):
        return [json_data(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): json_data(item) for key, item in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
