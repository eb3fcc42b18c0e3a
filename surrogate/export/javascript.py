"""An ES module for browsers and Node, made of the evaluators of the report."""

from __future__ import annotations

import json

from surrogate.export import names
from surrogate.export.description import Description
from surrogate.export.writing import template
from surrogate.portable.joined import JAVASCRIPT, body
from surrogate.portable.packing import Packer


def written(description: Description) -> bytes:
    """`NAME(x)` and `NAME_std(x)`, x an array in the order of the inputs or an object by names.

    Raises `StudyError` for a name that JavaScript does not take.
    """
    names.check(description.name, "JavaScript", names.JAVASCRIPT_WORDS)
    packer = Packer()
    document = {key: description.document[key] for key in ("inputs", "model", "error")}
    packed = packer.packed(document)
    return template(
        "javascript.jinja",
        name=description.name,
        lines=description.lines(),
        evaluators=body(JAVASCRIPT / "point.js"),
        document=_data(packed),
        shared=_data(packer.shared),
        inputs=_data([one.name for one in description.inputs]),
        coordinates=_data({one.name: one.values for one in description.coordinates}),
        field=bool(description.shape),
    ).encode()


def _data(value: object) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
