"""The commented study that `surrogate new` writes."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path

from surrogate.errors import StudyError
from surrogate.study.schema import schema_text

#: The schema beside a study, from which editors complete, and the line that names it to them.
SCHEMA = "study.schema.json"
MODELINE = f"# yaml-language-server: $schema={SCHEMA}\n"


def write(name: str, folder: Path | None = None, data: Path | None = None) -> Path:
    """Write `<name>.yaml` into `folder` (default: the current one); returns its path.

    The schema of a study file goes beside it, so that editors complete without a network.
    data: a table that the study is about. Raises `StudyError` when the name cannot name a
    study, the table is not understood, or the file exists.
    """
    stem = name.removesuffix(".yaml")
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", stem):
        raise StudyError(
            f"name '{stem}' may hold letters, digits and _ only, and starts with a letter"
        )
    path = (folder or Path()) / f"{stem}.yaml"
    if data is None:
        general = files("surrogate.study").joinpath("template.yaml").read_text(encoding="utf-8")
        text = general.replace("NAME", stem)
    else:
        from surrogate.study.table_template import text_of  # NumPy: a plain study needs none

        text = text_of(stem, data, folder or Path())
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(MODELINE + text)
        path.with_name(SCHEMA).write_text(schema_text(), encoding="utf-8")
    except FileExistsError:
        raise StudyError(f"{path} exists already; choose another name") from None
    except OSError as error:
        raise StudyError(f"{path} cannot be written: {error.strerror}") from None
    return path
