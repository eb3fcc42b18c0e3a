"""What is installed: every package, and every file that lies beside modules."""

import tomllib
from fnmatch import fnmatch
from pathlib import Path

import yaml

ROOT = Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SETUPTOOLS = PYPROJECT["tool"]["setuptools"]
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


def test_no_dependency_has_an_upper_bound():
    """A new release of a package must not keep this one from being installed."""
    project = PYPROJECT["project"]
    groups = [project["dependencies"], *project["optional-dependencies"].values()]
    for requirement in (one.split(";")[0] for group in groups for one in group):
        assert not any(sign in requirement for sign in ("<", "==", "~=", "!=")), requirement
    assert "<" not in project["requires-python"]


def test_the_citation_is_of_this_version():
    """As of CFF 1.2.0: what it needs, and the version of the package."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["version"] == PYPROJECT["project"]["version"]
    assert citation["license"] == PYPROJECT["project"]["license"]


def test_every_python_is_tried_by_continuous_integration():
    """From the oldest that is allowed to 3.14."""
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text("utf-8"))
    tried = workflow["jobs"]["readme"]["strategy"]["matrix"]["python"]
    assert tried == ["3.11", "3.12", "3.13", "3.14"]
    assert f">={tried[0]}" == PYPROJECT["project"]["requires-python"]
    assert set(workflow["jobs"]["packages"]["strategy"]["matrix"]["python"]) <= set(tried)
