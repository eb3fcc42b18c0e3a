"""Digests: what a result was made from, in 32 hexadecimal digits."""

from __future__ import annotations

import hashlib
import inspect
import json
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.runs.assembly import versions
from surrogate.runs.compaction import JOURNAL

#: Attributes of a runs dataset that tell of its making and change no result.
APART = ("study", "created", JOURNAL)


def digest(*things: Any) -> str:
    """Digest of texts, numbers, lists, mappings and arrays; equal things, equal digest."""
    found = hashlib.sha256()
    for thing in things:
        if isinstance(thing, np.ndarray):
            plain = thing if thing.dtype.kind in "fiubM" else thing.astype("U")
            found.update(f"{plain.dtype.str}{plain.shape}".encode())
            found.update(np.ascontiguousarray(plain).tobytes())
        else:
            found.update(json.dumps(thing, sort_keys=True, default=_plain).encode())
        found.update(b"\0")
    return found.hexdigest()[:32]


def _plain(thing: Any) -> Any:
    if isinstance(thing, np.ndarray | np.generic):
        return thing.tolist()
    return dict(thing) if isinstance(thing, Mapping) else repr(thing)


def of_runs(runs: xr.Dataset) -> str:
    """Digest of a runs dataset: all that is measured, and what it means."""
    attributes = {key: value for key, value in runs.attrs.items() if key not in APART}
    columns = [
        part
        for name in sorted(map(str, runs.variables))
        for part in (name, list(runs[name].dims), runs[name].attrs, runs[name].values)
    ]
    return digest(attributes, *columns)


def of_object(found: Any) -> str:
    """Digest of an estimator or a function: which one, its code and its parameters."""
    kind = found if inspect.isroutine(found) or isinstance(found, type) else type(found)
    parameters = found.get_params() if hasattr(found, "get_params") else {}
    nested = {name: of_object(one) for name, one in parameters.items() if _is_estimator(one)}
    plain = {name: one for name, one in parameters.items() if name not in nested}
    return digest(kind.__module__, getattr(kind, "__qualname__", ""), _code(kind), plain, nested)


def _is_estimator(found: Any) -> bool:
    return hasattr(found, "get_params") and not isinstance(found, type)


def _code(kind: Any) -> list[str]:
    """The version of the package that an object comes from, and its file."""
    package = sys.modules.get(kind.__module__.partition(".")[0])
    found = [str(getattr(package, "__version__", ""))]
    with suppress(TypeError, OSError):
        found.append(hashlib.sha256(Path(inspect.getfile(kind)).read_bytes()).hexdigest())
    return found


@cache
def environment() -> str:
    """Digest of all that makes the numbers besides the study: packages, and our own code."""
    root = Path(__file__).parents[1]
    code = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        code.update(path.read_bytes())
    return digest(versions(), code.hexdigest())
