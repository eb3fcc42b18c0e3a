"""What the shell offers at TAB: study files, a study's surrogates, its parameters.

Nothing of a study is loaded but its text, so the answer comes at once.
"""

from __future__ import annotations

import os
import re
import string
from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any

import typer

#: The line that makes a YAML file a study stands in its first bytes.
_STUDY, _HEAD = re.compile(rb"^study\s*:", re.MULTILINE), 8192
#: Folders in which no study is looked for, and files that are looked into at most.
_UNREADABLE = (OSError, LookupError, AttributeError, TypeError, UnicodeError, StopIteration)
_NOT_HIDDEN = tuple(string.ascii_letters + string.digits + "_")
_SKIPPED, _MOST = {"results", "node_modules", "__pycache__"}, 2000


def study_files(incomplete: str) -> list[str]:
    """Study files whose path starts with what is typed, also in the folders next below."""
    typed, begun = os.path.split(incomplete)
    below = islice(_yaml_below(Path(os.path.expanduser(typed or ".")), begun), _MOST)
    return sorted(os.path.join(typed, found) for found, path in below if _is_study(path))


def _yaml_below(folder: Path, begun: str) -> Iterator[tuple[str, Path]]:
    """YAML files of a folder whose names start with `begun`, and of its folders that do."""
    for entry in _entries(folder):
        if not entry.name.startswith(begun or _NOT_HIDDEN):
            continue
        if entry.name.endswith((".yaml", ".yml")):
            yield entry.name, Path(entry.path)
        elif entry.name not in _SKIPPED:
            for inner in _entries(Path(entry.path)):
                if inner.name.endswith((".yaml", ".yml")):
                    yield os.path.join(entry.name, inner.name), Path(inner.path)


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    with suppress(OSError), os.scandir(folder) as entries:
        return list(entries)
    return []


def _is_study(path: Path) -> bool:
    with suppress(OSError), path.open("rb") as file:
        return bool(_STUDY.search(file.read(_HEAD)))
    return False


def surrogates(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of the study's surrogates."""
    return [name for name in _section(ctx, "surrogates") if name.startswith(incomplete)]


def formats(incomplete: str) -> list[str]:
    """Names of the formats of `surrogate export`."""
    known = ("json", "python", "c", "javascript", "onnx", "fmu")
    return [name for name in known if name.startswith(incomplete)]


def goals(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of the goals that the study solves for."""
    return [name for name in _section(ctx, "solve") if name.startswith(incomplete)]


def parameter_names(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of the study's parameters."""
    return [name for name in _section(ctx, "parameters") if name.startswith(incomplete)]


def parameters(ctx: typer.Context, incomplete: str) -> list[str]:
    """`NAME=` of each parameter that has no value yet, and the word with a value in its middle.

    Two words that begin alike keep the shell from ending the word behind the `=`.
    """
    given = {word.partition("=")[0] for word in ctx.params.get("at") or ()}
    left = {n: p for n, p in _section(ctx, "parameters").items() if n not in given}
    words = [f"{name}={end}" for name, part in left.items() for end in ("", *_examples(part))]
    return [word for word in words if word.startswith(incomplete)]


def _examples(part: Any) -> list[str]:
    """Levels, or a value amid the range or the values; none where the study does not tell."""
    words = part if isinstance(part, Mapping) else {"range": part}
    if isinstance(words.get("levels"), list):
        return [str(level) for level in words["levels"]]
    with suppress(TypeError, ValueError, IndexError):
        if "values" in words:
            return [f"{float(words['values'][len(words['values']) // 2]):g}"]
        low, high = words["range"] if "range" in words else (words["mean"], words["mean"])
        return [f"{(float(low) + float(high)) / 2:.4g}"]
    return []


def _section(ctx: typer.Context, name: str) -> Mapping[str, Any]:
    """A section of the study on the command line, as written; empty when it cannot be read.

    An option that still waits for its value keeps the words from being understood: then the
    study is the word that names a YAML file.
    """
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    named = [
        ctx.params.get("study"),
        *(word for word in ctx.args if word.endswith((".yaml", ".yml"))),
    ]
    with suppress(*_UNREADABLE, yaml.YAMLError):
        study = next(one for one in named if one)
        text = Path(study).expanduser().read_text(encoding="utf-8")
        found = yaml.load(text, loader)[name]
        return {str(key): part for key, part in found.items()}
    return {}
