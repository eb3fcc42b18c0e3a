"""Results kept as files, so that what did not change need not be done again.

A file is a line of JSON, then the pickled result. The line holds the digest of what the
result was made from and that of the pickle; one that differs in either is not loaded.
"""

from __future__ import annotations

import hashlib
import json
import pickle
import re
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path
from typing import Any

from surrogate.runs.files import write_bytes

FOLDER, SUFFIX = "kept", ".pickle"


def path_of(folder: Path, stage: str, label: str = "") -> Path:
    """Where a stage's result is kept, or that of one of its jobs."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", f"{stage}-{label}" if label else stage)
    mark = hashlib.sha256(label.encode()).hexdigest()[:8]  # labels may differ in signs only
    return folder / FOLDER / f"{name}{f'-{mark}' if label else ''}{SUFFIX}"


def save(path: Path, made_from: str, result: Any) -> None:
    """Keep a result; one that cannot be pickled is not kept and is done again next time."""
    try:
        content = pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
    except Exception:  # a stranger's estimator fails to be pickled in ways of its own
        path.unlink(missing_ok=True)
        return
    head = {"made_from": made_from, "sha256": hashlib.sha256(content).hexdigest()}
    write_bytes(path, json.dumps(head).encode() + b"\n" + content, sync=False)


def load(path: Path, made_from: str) -> Any:
    """The result that was made from just this; None when there is none, or it is damaged."""
    with suppress(OSError, ValueError, AttributeError):
        head, _, content = path.read_bytes().partition(b"\n")
        said = json.loads(head)
        if said["made_from"] == made_from:
            return _unpickled(content, said["sha256"])
    return None


def _unpickled(content: bytes, sha256: str) -> Any:
    if hashlib.sha256(content).hexdigest() == sha256:
        with suppress(Exception):  # a class that is no longer there, or takes other arguments
            return pickle.loads(content)
    return None


def forget(folder: Path, stage: str, keep: Collection[Path]) -> None:
    """Delete what is kept of a stage's jobs, but for the files to `keep`."""
    for path in (folder / FOLDER).glob(f"{stage}-*{SUFFIX}"):
        if path not in keep:
            path.unlink(missing_ok=True)


def forget_all(folder: Path) -> None:
    """Delete all that is kept: every stage is done again."""
    for path in (folder / FOLDER).glob("*"):
        path.unlink(missing_ok=True)
