"""MyST notebooks of the documentation as plain programs, so that tests need no Jupyter."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).parents[2]
CELL = re.compile(r"^```\{code-cell\} ipython3\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: Defined before the cells: what IPython makes of a line with `!`.
SHELL = """
import subprocess


def _shell(words):
    done = subprocess.run(words, shell=True, capture_output=True, text=True)
    print(done.stdout, done.stderr, done.returncode)
"""


def run(page: Path, folder: Path) -> str:
    """Carry out the cells of a page in an empty folder; what they print."""
    program = "\n".join([SHELL, *(python(cell) for cell in cells(page))])
    (folder / "_page.py").write_text(program, encoding="utf-8")
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    done = subprocess.run(
        [sys.executable, "_page.py"],
        cwd=folder,
        env={**os.environ, "PROJECT": str(PROJECT), "PATH": path, "COLUMNS": "88"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def cells(page: Path) -> list[str]:
    """The code of each cell, without its options."""
    found = CELL.findall(page.read_text(encoding="utf-8"))
    return [re.sub(r"\A(:[\w-]+:.*\n)+", "", cell) for cell in found]


def python(cell: str) -> str:
    """A cell as Python: files are written, commands are called."""
    if cell.startswith("%%writefile "):
        first, _, text = cell.partition("\n")
        name = first.removeprefix("%%writefile ")
        return f"open({name!r}, 'w', encoding='utf-8').write({text!r})"
    return re.sub(r"^!(.*)$", lambda line: f"_shell({line[1]!r})", cell, flags=re.MULTILINE)
