"""The reduced study: frozen parameters become constants."""

from __future__ import annotations

import copy
from typing import Any

import yaml

from surrogate.sensitivity.screening import Screening
from surrogate.study import Study


def reduced_text(study: Study, screening: Screening) -> str:
    """YAML of the study without its frozen parameters; "" when none is frozen, or all are."""
    frozen = {name: value for name, value in screening.frozen_values.items()
              if name in study.space.names}
    if not frozen or len(frozen) == study.space.size:
        return ""
    data = copy.deepcopy(dict(yaml.safe_load(study.text) if study.source.text
                              else study.source.data))
    data["study"] = f"{study.name}_reduced"
    data["parameters"] = {name: part for name, part in data["parameters"].items()
                          if name not in frozen}
    data["constants"] = {**data.get("constants", {}), **frozen}
    _forget(data, frozen)
    note = (f"# {study.name} with {', '.join(frozen)} frozen: the total index of each is surely\n"
            f"# below {screening.freeze_below:g}. Keep this file beside the study it came from when\n"
            "# the solver reads files or modules from there.\n\n")
    return note + yaml.safe_dump(data, sort_keys=False, allow_unicode=True)


def _forget(data: dict[str, Any], frozen) -> None:
    """Drop correlations of frozen parameters."""
    rows = [row for row in data.get("correlation", ()) if not set(row[:2]) & set(frozen)]
    if rows:
        data["correlation"] = rows
    else:
        data.pop("correlation", None)
