"""YAML text with positions: which line and column each key and value stands at.

Numbers and booleans follow YAML 1.2 (`1e-3` is a number; `on` and `no` are words).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from surrogate.errors import KeyPath, StudyError

Position = tuple[int, int]

#: Characters, values and depth beyond which a study is refused: aliases of aliases would grow
#: without end.
LONGEST = 2_000_000
LARGEST = 100_000
DEEPEST = 50


class _Loader(yaml.SafeLoader):
    """SafeLoader whose plain scalars are those of YAML 1.2's core schema."""


_Loader.yaml_implicit_resolvers = {
    first: [
        (tag, rule)
        for tag, rule in rules
        if tag.rsplit(":", 1)[-1] not in ("float", "int", "bool", "timestamp")
    ]
    for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
for _tag, _rule, _first in (
    ("bool", r"^(?:true|True|TRUE|false|False|FALSE)$", "tTfF"),
    ("int", r"^[-+]?[0-9]+$", "-+0123456789"),
    (
        "float",
        r"^[-+]?(?:(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
        r"|\.(?:inf|Inf|INF))$|^\.(?:nan|NaN|NAN)$",
        "-+.0123456789",
    ),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(_rule), list(_first))
# Octal and base-60 integers of YAML 1.1 would change 010 and 1:30 behind the reader's back.
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))


@dataclass(frozen=True)
class Source:
    """A study's text, its data, and where each part stands.

    keys, values map a path such as ("parameters", "tension", "range") to (line, column).
    """

    name: str = ""
    text: str = ""
    data: Any = None
    keys: dict[KeyPath, Position] = field(default_factory=dict)
    values: dict[KeyPath, Position] = field(default_factory=dict)

    def locate(self, path: KeyPath, *, key: bool = False) -> Position:
        """Position of the value (or key) at `path`, or of the nearest part around it."""
        path = tuple(path)
        if key and path in self.keys:
            return self.keys[path]
        while path and path not in self.values:
            # Short forms leave out a level: `tension: [a, b]` for `tension: {range: [a, b]}`.
            short = (*path[:-2], path[-1])
            path = short if len(path) > 1 and short in self.values else path[:-1]
        return self.values.get(path, (1, 1))

    def sentence(self, path: KeyPath, text: str, *, key: bool = False) -> str:
        """`file:line:column: text`, or `path: text` for a study without a file."""
        if not self.name:
            return f"{'.'.join(map(str, path)) or 'study'}: {text}"
        line, column = self.locate(path, key=key)
        return f"{self.name}:{line}:{column}: {text}"


def read_file(path: Path) -> Source:
    """Source of a study file; `StudyError` when it cannot be read."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise StudyError(f"{path}: cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise StudyError(f"{path}: is not UTF-8 text") from None
    return read_text(text, str(path))


def read_text(text: str, name: str) -> Source:
    """Source of YAML `text`; `StudyError` with line and column when it is not YAML."""
    if len(text) > LONGEST:
        raise StudyError(
            f"{name}: the study has {len(text)} characters; at most {LONGEST} are read. "
            "Put points into a CSV file (method: csv)"
        )
    try:
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
            source = Source(name, text, None)
            mistakes = _mark(node, (), source, loader) if node is not None else []
            if mistakes:
                raise StudyError(*mistakes)
            data = loader.construct_document(node) if node is not None else None
        finally:
            loader.dispose()
    except yaml.YAMLError as error:
        raise StudyError(_yaml_sentence(error, name)) from None
    except ValueError as error:  # !!int and !!float before a word
        raise StudyError(f"{name}: this is not YAML: {error}") from None
    except RecursionError:
        raise StudyError(
            f"{name}: this is not YAML: an alias stands inside of what it names, or "
            "lists are nested too deep"
        ) from None
    return Source(name, text, data, source.keys, source.values)


def _yaml_sentence(error: yaml.YAMLError, name: str) -> str:
    mark = getattr(error, "problem_mark", None)
    problem = getattr(error, "problem", None) or str(error).splitlines()[0]
    place = f"{name}:{mark.line + 1}:{mark.column + 1}" if mark else name
    hint = "; indent with spaces" if "\\t" in problem else ""
    return f"{place}: this is not YAML: {problem}{hint}"


def _mark(node: yaml.Node, path: KeyPath, source: Source, loader: _Loader) -> list[str]:
    """Fill in positions below `node`; returns a sentence for each key that stands twice."""
    source.values[path] = _position(node)
    if len(path) > DEEPEST:
        raise RecursionError
    if len(source.values) > LARGEST:
        line, column = _position(node)
        raise StudyError(
            f"{source.name}:{line}:{column}: the study has more than {LARGEST} values, counted "
            "anew wherever an alias stands for them"
        )
    mistakes: list[str] = []
    if isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            mistakes += _mark(item, (*path, index), source, loader)
    elif isinstance(node, yaml.MappingNode):
        for key, item in node.value:
            if _holds_levels(path) and key.tag == "tag:yaml.org,2002:bool":
                key.tag = "tag:yaml.org,2002:str"
            here = (*path, _as_text(key, loader))
            line, column = _position(key)
            if here in source.keys:
                mistakes.append(
                    f"{source.name}:{line}:{column}: '{here[-1]}' stands twice "
                    f"(first in line {source.keys[here][0]}); keep one"
                )
            source.keys[here] = (line, column)
            mistakes += _mark(item, here, source, loader)
    return mistakes


def _holds_levels(path: KeyPath) -> bool:
    """Whether the keys at `path` are levels of fidelity, of which one may be called true."""
    return path == ("levels",) or (path[:1] == ("designs",) and path[2:] == ("runs",))


def _as_text(key: yaml.Node, loader: _Loader) -> str:
    """A key as the data have it, written as a text: null is None and 01 is 1."""
    if key.tag == "tag:yaml.org,2002:merge":
        return "<<"
    return str(loader.construct_object(key, deep=True))


def _position(node: yaml.Node) -> Position:
    return node.start_mark.line + 1, node.start_mark.column + 1
