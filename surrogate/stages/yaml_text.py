"""Plain data as YAML text, laid out as people write studies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml


class _Dumper(yaml.SafeDumper):
    """Writes small lists and mappings on one line, as people do in studies."""

    def represent_sequence(
        self, tag: str, sequence: Any, flow_style: bool | None = None
    ) -> yaml.SequenceNode:
        flat = all(not isinstance(item, list | tuple | dict) for item in sequence)
        return super().represent_sequence(tag, sequence, flow_style=flat)

    def represent_mapping(
        self, tag: str, mapping: Any, flow_style: bool | None = None
    ) -> yaml.MappingNode:
        flat = all(not isinstance(item, dict) for item in dict(mapping).values())
        return super().represent_mapping(tag, mapping, flow_style=flat)


_Dumper.add_representer(tuple, _Dumper.represent_list)
_Dumper.add_representer(
    float, lambda dumper, value: dumper.represent_scalar("tag:yaml.org,2002:float", _digits(value))
)


def _digits(value: float) -> str:
    """Twelve digits, with the point that makes YAML 1.1 readers see a number too."""
    mantissa, e, exponent = f"{value:.12g}".partition("e")
    return (mantissa if "." in mantissa else f"{mantissa}.0") + e + exponent


def write_yaml(data: Mapping[str, Any]) -> str:
    """YAML text of plain data, keys in their order."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)
