"""What is installed: every package, and every file that lies beside modules."""

import tomllib
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parent.parent
SETUPTOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
    "setuptools"
]
FOLDERS = {
    ROOT / "/".join((SETUPTOOLS["package-dir"][top], *rest)): name
    for name in SETUPTOOLS["packages"]
    for top, *rest in [name.split(".")]
}


def files(suffix=""):
    for top in SETUPTOOLS["package-dir"].values():
        for path in (ROOT / top).rglob(f"*{suffix}"):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path


def test_every_folder_of_modules_is_a_package_that_is_installed():
    assert {path.parent for path in files(".py")} == set(FOLDERS)


def test_every_file_beside_modules_is_package_data():
    """Pages, templates, tables and bases: each matches a pattern below its package."""
    (patterns,) = SETUPTOOLS["package-data"].values()
    for path in files():
        package = next(one for one in path.parents if one in FOLDERS)
        name = path.relative_to(package).as_posix()
        assert path.suffix == ".py" or any(
            fnmatch(name, pattern) and name.count("/") == pattern.count("/") for pattern in patterns
        ), f"{path} would not be installed"
