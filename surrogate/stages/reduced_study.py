"""The reduced study: frozen parameters become constants."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from typing import Any

from surrogate.sensitivity.screening import Screening
from surrogate.stages.yaml_text import write_yaml


def reduced_study(
    name: str, about: str, words: Mapping[str, Any], screening: Screening | None
) -> str:
    """YAML of the study without its frozen parameters; "" when none is frozen, or all are.

    words: the study's own, as its file has them.
    """
    frozen = screening.frozen_values if screening is not None else {}
    if screening is None or not frozen or len(frozen) == len(screening.verdicts):
        return ""
    data = {**words, "study": f"{name}_reduced", "about": about}
    data["parameters"] = {
        name: part for name, part in data.get("parameters", {}).items() if name not in frozen
    }
    if "solver" in data:
        data["constants"] = {**data.get("constants", {}), **frozen}
    else:
        data["data"] = _without(data["data"], frozen)
        if kept := _without_names(data.pop("constraints", ()), frozen):
            data["constraints"] = kept
    for word in ("stored", "validation"):  # files beside the study, about other runs
        data.pop(word, None)
    _forget(data, frozen)
    note = (
        f"# {name} with {', '.join(frozen)} frozen: the {screening.index} of each is\n"
        f"# surely below {screening.freeze_below:g}. Keep this file beside the study it came\n"
        "# from when the solver reads files or modules from there.\n\n"
    )
    return note + write_yaml(data)


def _without(table: Any, frozen: Mapping[str, Any]) -> dict[str, Any]:
    """`data:` of a table that does without these columns."""
    part = {"file": table} if isinstance(table, str) else dict(table)
    left_out = part.get("leave_out", [])
    named = [left_out] if isinstance(left_out, str) else list(left_out)
    return {**part, "leave_out": [*named, *frozen]}


def _without_names(constraints: Any, frozen: Mapping[str, Any]) -> list[str]:
    """The constraints of a table that name none of the columns left out."""
    texts = [constraints] if isinstance(constraints, str) else list(constraints)
    return [one for one in texts if not set(re.findall(r"\w+", one)) & set(frozen)]


def _forget(data: dict[str, Any], frozen: Container[str]) -> None:
    """Drop frozen parameters from correlations and groups."""
    rows = [
        [first, second, value]
        for first, second, value in data.get("correlation", ())
        if first not in frozen and second not in frozen
    ]
    if rows:
        data["correlation"] = rows
    else:
        data.pop("correlation", None)
    sensitivity = data.get("sensitivity")
    if isinstance(sensitivity, Mapping) and "groups" in sensitivity:
        left = {
            group: [name for name in members if name not in frozen]
            for group, members in sensitivity["groups"].items()
        }
        data["sensitivity"] = {
            **sensitivity,
            "groups": {group: members for group, members in left.items() if members},
        }
