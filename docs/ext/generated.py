"""Reference pages that are made from the program itself, before each build.

They go to reference/generated, and hand-written pages include them.
"""

from __future__ import annotations

import importlib
import inspect
import json
import re
from collections.abc import Iterator, Mapping
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
import yaml

from surrogate.study import plugins
from surrogate.study.catalogue import summary
from surrogate.study.schema import json_schema

if TYPE_CHECKING:
    from sphinx.application import Sphinx

#: What the framework gives to a plug-in; the rest of its signature are its options.
GIVEN = {"self", "space", "coded", "folder", "fit", "confidence", "settings", "groups", "q2"}
#: Options that mean the same everywhere, where a method's documentation does not tell.
COMMON = {
    "seed": "of random choices; default: made from the name of the design",
    "runs": "number of points",
    "center_points": "points in the middle of all ranges, at the end of the design",
    "model": "polynomial that the points are to estimate: linear, interactions or quadratic",
    "starts": "searches, of which the best counts",
    "parameter": "whose sign is reversed; default: all",
    "samples": "points at which the surrogate is evaluated, for each parameter or pair",
    "replicates": "independent repetitions; their scatter gives the sampling part of intervals",
    "scramblings": "independent randomisations; their scatter gives the sampling part of intervals",
    "draws": "plausible surrogates that give the surrogate's part of intervals; 0 for none",
    "q2_needed": "indices of a surrogate with a smaller Q2 carry a refusal",
    "trajectories": "paths through the grid of levels, of d + 1 points each",
    "levels": "places of the grid in each parameter",
    "slices": "conditioning intervals of each parameter",
}


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages when a build begins."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir) / "reference" / "generated"))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write(folder: Path) -> None:
    """Write every page; one that has not changed is left alone."""
    pages = {
        "command_line.md": command_line("surrogate", "surrogate.cli.verbs"),
        "leg_bandage.md": command_line("leg-bandage", "surrogate_solvers.leg_bandage.cli"),
        "study_file.md": study_file(json_schema()),
        "methods.md": methods(),
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


# The command line, from its own help ---------------------------------------------------------


def command_line(program: str, module: str) -> str:
    """Each verb with its arguments and options."""
    verbs = typer.main.get_command(importlib.import_module(module).app).commands
    return "\n".join(line for verb in verbs.values() for line in _verb(program, verb))


def _verb(program: str, verb: Any) -> Iterator[str]:
    arguments = [one for one in verb.params if one.param_type_name == "argument"]
    options = [one for one in verb.params if one.param_type_name == "option"]
    words = " ".join([program, verb.name, *(_metavar(one) for one in arguments), "[OPTIONS]"])
    yield from (f"## {verb.name}", "", "```text", words, "```", "", _plain(verb.help), "")
    yield from _rows(
        "word",
        [(f"`{_metavar(one)}`", _said(one)) for one in arguments]
        + [(f"`{_option(one)}`", _said(one)) for one in options],
    )


def _metavar(one: Any) -> str:
    return str(one.metavar or one.name.upper())


def _option(one: Any) -> str:
    names = ", ".join(one.opts)
    return names if one.is_flag else f"{names} {one.metavar or one.name.upper()}"


def _said(one: Any) -> str:
    default = one.default
    known = isinstance(default, (int, float, str)) and not isinstance(default, bool)
    shown = f" Default: `{default}`." if known and default != "" else ""
    return _plain(one.help or "") + shown


# The study file, from its JSON Schema --------------------------------------------------------


def study_file(schema: Mapping[str, Any]) -> str:
    """Each part with its keys: type, default, meaning, example."""
    parts = schema["$defs"]
    lines = [*_part("The first level", schema, "")]
    for key, found in schema["properties"].items():
        for name in _all_named(found):
            part = _mapping(parts[name])
            own = part["properties"].get("method", {}).get("const")  # one method has its own keys
            lines += _part(f"`{key}`" + f" with `method: {own}`" * bool(own), part, "")
            lines += _below(f"method: {own}" if own else key, part, parts)
    return "\n".join(lines)


def _below(key: str, part: Mapping[str, Any], parts: Mapping[str, Any]) -> Iterator[str]:
    """The parts inside a part, such as `augment` of a design; solver and design stand once."""
    for inner, found in part["properties"].items():
        name = _named(found)
        if name and name not in ("SolverPart", "DesignPart"):
            yield from _part(f"`{inner}` of `{key}`", _mapping(parts[name]), "#")


def _mapping(part: Mapping[str, Any]) -> Mapping[str, Any]:
    return part if "properties" in part else part["anyOf"][0]


def _part(title: str, part: Mapping[str, Any], deeper: str) -> Iterator[str]:
    yield from (f"##{deeper} {title}", "")
    if "description" in part and title.startswith("`"):
        yield from (_plain(part["description"]), "")
    needed = set(part.get("required", ()))
    for key, found in part["properties"].items():
        default = found.get("default")
        told = (
            "needed"
            if key in needed
            else f"default: `{_short(default)}`"
            if default not in (None, "", [], {}, ())
            else "optional"
        )
        yield from (
            f"**`{key}`**",
            f": {_type(found)}; {told}. {_plain(found['description'])}",
            "",
            "  ```yaml",
            *(
                f"  {line}"
                for example in found["examples"]
                for line in _yaml(key, example).splitlines()
            ),
            "  ```",
            "",
        )
    if part.get("additionalProperties") is True:
        yield from ("Further keys are options of the method that is named.", "")


def _yaml(key: str, example: Any) -> str:
    """An example as it stands in a study, as short as a person would write it."""
    deep = isinstance(example, dict) and any(isinstance(one, dict) for one in example.values())
    if deep:
        inner = "\n".join(f"  {_yaml(name, value)}" for name, value in example.items())
        return f"{key}:\n{inner}"
    return f"{key}: {_short(example)}"


def _short(value: Any) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=1000)
    return text.removesuffix("\n").removesuffix("\n...")


def _named(found: Mapping[str, Any]) -> str:
    """The part that a key holds, one or several of them; "" for a plain value."""
    return next(iter(_all_named(found)), "")


def _all_named(found: Mapping[str, Any]) -> list[str]:
    """The parts that a key may hold, each once."""
    return list(dict.fromkeys(re.findall(r"#/\$defs/(\w+)", json.dumps(found))))


def _type(found: Mapping[str, Any]) -> str:
    """The type of a value in words."""
    choices = found.get("anyOf", [found])
    words = [_word(one) for one in choices if one.get("type") != "null"]
    return " or ".join(dict.fromkeys(words))


def _word(one: Mapping[str, Any]) -> str:
    if "$ref" in one:
        whole = json_schema()["$defs"][one["$ref"].rsplit("/", 1)[1]]
        short = {"string": "text or a mapping", "array": "[number, number] or a mapping"}
        alone = [form.get("type", "string") for form in whole.get("anyOf", ())[1:]]
        return short.get(str(alone[0]), "a mapping") if alone else "a mapping"
    if "const" in one:
        return "text"
    kind = one.get("type")
    if kind == "array":
        items = one.get("items") or (one.get("prefixItems") or [{}])[0]
        pair = one.get("maxItems") if one.get("maxItems") == one.get("minItems") else None
        inner = {"number": "numbers", "string": "texts"}.get(items.get("type", ""), "entries")
        return f"{pair or 'a list of'} {inner}" if pair is None else f"[{inner}, {pair} of them]"
    if kind == "object":
        return "a mapping"
    names = {"string": "text", "number": "a number", "integer": "a whole number"}
    limits = [
        f"{sign} {one[key]:g}"
        for key, sign in {
            "exclusiveMinimum": "above",
            "minimum": "from",
            "exclusiveMaximum": "below",
            "maximum": "up to",
        }.items()
        if key in one
    ]
    return " ".join([names.get(str(kind), "true or false"), *limits])


# Methods, from entry points and signatures ---------------------------------------------------


def methods() -> str:
    """Each installed plug-in of the project's own: what it is, its options, its documentation."""
    lines: list[str] = []
    for group, noun in plugins.NOUNS.items():
        own = [
            (name, point)
            for name, point in plugins.available(group).items()
            if point.module.startswith(("surrogate.", "surrogate_solvers."))
        ]
        lines += [f"## {noun.capitalize()}s", ""]
        for name, point in own:
            lines += _method(name, point)
    return "\n".join(lines)


def _method(name: str, point: EntryPoint) -> Iterator[str]:
    found = point.load()
    yield from (f"### {name}", "")
    module = found.__module__
    alone = module.endswith(f".{found.__name__}")
    kind = "class" if isinstance(found, type) else "function"
    documented = inspect.getdoc(importlib.import_module(module) if alone else found) or ""
    first = documented.strip().split("\n\n")[0].replace("\n", " ") or summary(point)
    yield from (_plain(first), "")
    bases = [inspect.getdoc(one) for one in (found.__mro__[:-1] if kind == "class" else [found])]
    meanings = described("\n\n".join(filter(None, [documented, *bases])))
    options = [
        one
        for one in inspect.signature(found).parameters.values()
        if one.name not in GIVEN and one.kind is not inspect.Parameter.VAR_KEYWORD
    ]
    if options:
        rows = [
            (
                f"`{one.name}`",
                _type_of(one),
                _default_of(one),
                _plain(meanings.get(one.name, COMMON.get(one.name, ""))),
            )
            for one in options
        ]
        yield from _rows("option", rows, "type", "default", "what it is")
    yield from (f"In Python: {{py:obj}}`{module}.{found.__name__}`" if _documented(module) else
                f"In Python: `{module}:{found.__name__}`, a {kind}", "")  # fmt: skip


def described(documentation: str) -> dict[str, str]:
    """Option -> what it is, from rows `name  meaning` and paragraphs `name: meaning`."""
    found: dict[str, str] = {}
    rows = r"^(?P<names>\w+(?:, \w+)*) {2,}(?P<said>\S.*(?:\n[ ]+\S.*)*)"
    paragraphs = r"^(?P<names>[a-z]\w*): (?P<said>(?:\S.*\n?)(?:(?!\w+(?:: |  )).+\n?)*)"
    blocks = [
        *re.finditer(rows, documentation, re.MULTILINE),
        *re.finditer(paragraphs, documentation, re.MULTILINE),
    ]
    for block in blocks:
        said = " ".join(block["said"].split())
        for name in block["names"].split(", "):
            found.setdefault(name, said)
    return found


def _documented(module: str) -> bool:
    return module.startswith(("surrogate.designs", "surrogate.regressors", "surrogate.sensitivity"))


def _type_of(one: inspect.Parameter) -> str:
    if one.annotation is inspect.Parameter.empty:
        return ""
    text = one.annotation if isinstance(one.annotation, str) else inspect.formatannotation(
        one.annotation
    )  # fmt: skip
    return f"`{text}`"


def _default_of(one: inspect.Parameter) -> str:
    if repr(one.default) == "<factory>":
        return "`[]`"
    return "needed" if one.default is inspect.Parameter.empty else f"`{one.default!r}`"


# Markdown ------------------------------------------------------------------------------------


def _rows(first: str, rows: list[tuple[str, ...]], *more: str) -> Iterator[str]:
    """A table; columns besides the first are called `more`, or 'what it is'."""
    names = (first, *(more or ("what it is",)))
    yield from (f"| {' | '.join(names)} |", f"|{'---|' * len(names)}")
    for row in rows:
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |"
    yield ""


def _plain(text: str | None) -> str:
    """Text of a docstring or of help in Markdown: stars and brackets are no markup."""
    said = inspect.cleandoc(text or "")
    parts = re.split(r"(`[^`]*`)", said)
    return "".join(p if p.startswith("`") else re.sub(r"([*<>\[\]$])", r"\\\1", p) for p in parts)
