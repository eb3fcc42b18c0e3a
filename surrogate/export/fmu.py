"""A functional mock-up unit of FMI 2.0 for co-simulation: the C file, wrapped and compiled here."""

from __future__ import annotations

import io
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Mapping
from pathlib import Path

from surrogate.errors import PluginError, StudyError
from surrogate.export import c
from surrogate.export.description import Description
from surrogate.export.model_description import model_description
from surrogate.export.writing import source, template

#: Of `uuid5`: units of equal content have one name.
NAMESPACE = uuid.UUID("5a1d6a0e-4c0f-5b0e-9b43-6d0c1c2a7f10")
FLAGS = ("-O2", "-std=c99", "-fPIC", "-shared", "-fvisibility=hidden")
#: Time of all files in the archive, so that equal units are equal files.
THEN = (1980, 1, 1, 0, 0, 0)


def written(description: Description) -> bytes:
    """The archive: modelDescription.xml, sources/ and a binary for this machine.

    Raises `StudyError` for names that do not go together and `PluginError` where nothing compiles.
    """
    name = description.name
    model = c.written(description)
    taken = {entry.name for entry in description.inputs} & {name, f"{name}_std"}
    if taken:
        raise StudyError(f"'{taken.pop()}' is an input and the output of the unit; add --name")
    content = model_description(description, "") + model.decode()
    guid = f"{{{uuid.uuid5(NAMESPACE, content)}}}"
    sources = {
        f"sources/{name}.c": model,
        "sources/fmu.c": _unit(description, guid).encode(),
        "sources/fmi2.h": source("fmi2.h").encode(),
    }
    described = '<?xml version="1.0" encoding="UTF-8"?>\n' + model_description(description, guid)
    files = {"modelDescription.xml": described.encode(), **sources, **_binary(name, sources)}
    return _archive(files)


def _unit(description: Description, guid: str) -> str:
    """The functions of FMI around the model."""
    return template(
        "fmu.jinja",
        name=description.name,
        guid=guid,
        d=len(description.inputs),
        n=len(description.formula.middle),
        field=bool(description.shape),
        starts=[entry.start for entry in description.inputs],
        wholes=[int(entry.whole) for entry in description.inputs],
    )


def _binary(name: str, sources: Mapping[str, bytes]) -> dict[str, bytes]:
    """The shared library, at its place in the archive."""
    folder, ending = _platform()
    with tempfile.TemporaryDirectory() as place:
        for path, content in sources.items():
            (Path(place) / Path(path).name).write_bytes(content)
        files = [Path(path).name for path in sources if path.endswith(".c")]
        command = [*_compiler(), *FLAGS, "-o", f"{name}{ending}", *files, "-lm"]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True)
        if done.returncode:
            raise PluginError(
                f"`{shlex.join(command)}` failed: {done.stderr.strip() or done.returncode}; "
                "set CC to another C compiler, or use --format c"
            )
        return {f"binaries/{folder}/{name}{ending}": (Path(place) / f"{name}{ending}").read_bytes()}


def _platform() -> tuple[str, str]:
    """Folder and ending of binaries on this machine, as FMI 2.0 names them."""
    if sys.platform == "linux" and platform.machine() == "x86_64":
        return "linux64", ".so"
    if sys.platform == "darwin":
        return "darwin64", ".dylib"
    raise PluginError(
        f"FMI 2.0 names no binaries of {sys.platform} on {platform.machine()} that are made here; "
        "export the unit on Linux or macOS, or use --format c"
    )


def _compiler() -> list[str]:
    """The words that call the C compiler: those of CC, or the first that is found."""
    words = shlex.split(os.environ.get("CC", ""))
    for one in [words] if words else [["cc"], ["gcc"], ["clang"]]:
        if shutil.which(one[0]):
            return one
    raise PluginError(
        f"no C compiler ({words[0] if words else 'cc, gcc, clang'}) is found, and an FMU holds a "
        "compiled model; install one, set CC to it, or use --format c"
    )


def _archive(files: Mapping[str, bytes]) -> bytes:
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            archive.writestr(zipfile.ZipInfo(path, THEN), content, zipfile.ZIP_DEFLATED)
    return whole.getvalue()
