"""One file of C99 that needs <math.h> alone."""

from __future__ import annotations

from surrogate.export import names
from surrogate.export.arrays import arrays
from surrogate.export.description import Description
from surrogate.export.expressions import assignments
from surrogate.export.writing import template


def written(description: Description) -> bytes:
    """`double NAME(const double x[D])` and `NAME_std`; of a field `void NAME(x, double y[N])`.

    Raises `StudyError` for a name that C does not take.
    """
    names.check(description.name, "C", names.C_WORDS)
    name = description.name
    lines = assignments(description, "erf", f"{name}_level", f"{name}_log")
    return template(
        "c.jinja",
        name=name,
        lines=[line.replace("*/", "* /").replace("/*", "/ *") for line in description.lines()],
        factors="\n".join(f"    {line};" for line in lines),
        d=len(description.inputs),
        field=bool(description.shape),
        coordinates=description.coordinates,
        **arrays(description.formula),
    ).encode()
