"""A Python file that needs NumPy alone."""

from __future__ import annotations

from surrogate.export import names
from surrogate.export.arrays import arrays
from surrogate.export.description import Description
from surrogate.export.expressions import assignments
from surrogate.export.writing import template


def written(description: Description) -> bytes:
    """`NAME(x)` and `NAME_std(x)`, of arrays (m, D) or of inputs by name.

    Raises `StudyError` for a name that Python does not take.
    """
    names.check(description.name, "Python", names.PYTHON_WORDS)
    lines = assignments(description, "_erf", "_level", "_log")
    return template(
        "python.jinja",
        name=description.name,
        lines=description.lines(),
        factors="\n".join(f"    {line}" for line in lines),
        names=repr(tuple(one.name for one in description.inputs)),
        levels=repr({one.name: one.levels for one in description.inputs if one.levels}),
        shape=repr(description.shape),
        field=bool(description.shape),
        coordinates=repr({one.name: list(one.values) for one in description.coordinates}),
        **arrays(description.formula),
    ).encode()
