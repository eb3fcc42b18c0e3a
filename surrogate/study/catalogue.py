"""What is installed, with one line each: read in the sources, which nobody has to import."""

from __future__ import annotations

import ast
import re
import sys
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import EntryPoint
from importlib.util import find_spec, resolve_name
from inspect import getdoc
from pathlib import Path

from surrogate.study.plugins import NOUNS, available


def catalogue() -> dict[str, dict[str, str]]:
    """Kind of plug-in -> name -> the first line of its documentation."""
    return {
        group.rsplit(".", 1)[-1]: {name: summary(point) for name, point in available(group).items()}
        for group in NOUNS
    }


def summary(point: EntryPoint) -> str:
    """What a plug-in is, in its documentation's first line, or why it does not load.

    A function alone in a module of its name is described where the module begins.
    """
    try:
        described = _in_source(point.module, point.attr) or _when_imported(point)
    except Exception as error:  # a stranger's module raises whatever it likes
        return f"does not load: {type(error).__name__}: {error}"
    return described.strip().split("\n")[0]


def _in_source(module: str, name: str) -> str | None:
    """Documentation of a class or function of a module; None when its source does not tell."""
    spec = _found(module)
    if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
        return None
    source = Path(spec.origin).read_text(encoding="utf-8")
    return _at_a_glance(source, module, name) or _parsed(source, spec, name)


def _at_a_glance(source: str, module: str, name: str) -> str | None:
    """The first line of the documentation, where it stands as one usually writes it."""
    defined = re.search(rf"^(?:class|def) {re.escape(name)}\b", source, re.MULTILINE)
    if defined is None:
        return None
    alone = module.endswith(f".{name}")
    start = 0 if alone else defined.end()
    found = (_FIRST if alone else _BELOW).match(source, start)
    return found[1] if found else None


#: A module that begins with its documentation, and the rest of a `class` or `def` before its own.
_FIRST = re.compile(r'"""([^\n"\\]+)(?:\n|""")')
_BELOW = re.compile(r'(?:\([^()"#]*\))?(?: -> [^:"#]+)?:\n {4}"""([^\n"\\]+)(?:\n|""")')


def _parsed(source: str, spec: ModuleSpec, name: str) -> str | None:
    """The documentation as Python reads it, also of a name that is imported there."""
    module, tree = spec.name, ast.parse(source)
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name:
            return ast.get_docstring(tree if module.endswith(f".{name}") else node)
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and name in (
            one.asname or one.name for one in node.names
        ):
            origin = resolve_name("." * node.level + (node.module or ""), spec.parent)
            return _in_source(origin, name)
    return None


def _found(module: str) -> ModuleSpec | None:
    """Where a module lies; the packages around it are not imported either."""
    top, *inner = module.split(".")
    spec = find_spec(top)
    for part in inner:
        if spec is None:
            return None
        spec = PathFinder.find_spec(f"{spec.name}.{part}", spec.submodule_search_locations)
    return spec


def _when_imported(point: EntryPoint) -> str:
    found = point.load()
    alone = found.__module__.endswith(f".{getattr(found, '__name__', '')}")
    return getdoc(sys.modules[found.__module__] if alone else found) or ""
