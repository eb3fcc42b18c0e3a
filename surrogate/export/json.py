"""The portable document as JSON; `surrogate.regressors.portable` has its format."""

from __future__ import annotations

from pydantic_core import to_json

from surrogate.export.description import Description


def written(description: Description) -> bytes:
    """The document with the study, the output's unit and Q2; numbers not known are null."""
    told = {
        "study": description.study,
        "unit": description.unit,
        "q2": description.q2,
        "coordinates": {one.name: list(one.values) for one in description.coordinates},
        "constants": dict(description.constants),
    }
    return to_json({**description.document, **told}, inf_nan_mode="null") + b"\n"
