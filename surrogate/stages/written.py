"""What the stages wrote: a missing, truncated or changed file is known and made again.

`kept/written.json` holds for each stage the digest of what its files were made from, and of
each file its size, its time and its digest. Time and size as recorded: the file is taken to
be sound. Otherwise its digest decides.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from surrogate.runs.files import write_bytes, write_text
from surrogate.stages.kept import FOLDER
from surrogate.stages.stage import Files

MANIFEST = f"{FOLDER}/written.json"


def read(folder: Path) -> dict[str, Any]:
    """Stage -> {"made_from": digest, "files": {path: [size, time, digest]}}; empty if damaged."""
    with suppress(OSError, ValueError):
        found = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        return found if isinstance(found, dict) else {}
    return {}


def record(folder: Path, manifest: Mapping[str, Any]) -> None:
    """Write the manifest."""
    write_text(folder / MANIFEST, json.dumps(manifest, indent=1), sync=False)


def sound(folder: Path, entry: Mapping[str, Any] | None, made_from: str) -> bool:
    """True when a stage's files were made from just this and are as they were written."""
    with suppress(KeyError, TypeError, AttributeError, ValueError):
        return (
            entry is not None
            and entry["made_from"] == made_from
            and all(_as_written(folder / path, *known) for path, known in entry["files"].items())
        )
    return False


def intact(folder: Path, name: str) -> bool:
    """True when a stage wrote the file of this name, and it is as it was written."""
    with suppress(KeyError, TypeError, AttributeError, ValueError):
        known = [entry["files"][name] for entry in read(folder).values() if name in entry["files"]]
        return bool(known) and _as_written(folder / name, *known[0])
    return False


def _as_written(path: Path, size: int, time: int, sha256: str) -> bool:
    try:
        found = path.stat()
        if found.st_size != size:
            return False
        return found.st_mtime_ns == time or _sha256(path.read_bytes()) == sha256
    except OSError:
        return False


def write(
    folder: Path, files: Files, contents: Mapping[str, bytes | memoryview], made_from: str
) -> dict[str, Any]:
    """Write a stage's files, delete those of before; returns the stage's entry."""
    for old in folder.glob(files.pattern):
        if old.relative_to(folder).as_posix() not in contents:
            old.unlink(missing_ok=True)
    entry = {}
    for name, content in contents.items():
        write_bytes(folder / name, content)
        found = (folder / name).stat()
        entry[name] = [found.st_size, found.st_mtime_ns, _sha256(content)]
    return {"made_from": made_from, "files": entry}


def _sha256(content: bytes | memoryview) -> str:
    return hashlib.sha256(content).hexdigest()
