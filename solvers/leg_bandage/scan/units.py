"""Which unit a scan is in: the one in which its ankle has the girth of an ankle."""

from __future__ import annotations

from .errors import ScanError

UNITS = {"mm": 1.0, "cm": 10.0, "inch": 25.4, "m": 1000.0}
"""mm in each."""

ANKLE_GIRTH = (140.0, 350.0)
"""mm. ANSUR II has 180 to 290; swollen legs have more. The upper end is less than 2.54
times the lower one, so that no scan can be taken for centimetres and inches at once."""


def unit_of(ankle_girth: float, unit: str | None) -> str:
    """The unit, checked when it is given, of a scan whose ankle has this girth in that unit.

    Raises ScanError when no unit makes it an ankle.
    """
    low, high = ANKLE_GIRTH
    fitting = [name for name, size in UNITS.items() if low <= ankle_girth * size <= high]
    if unit is None and fitting:
        return fitting[0]
    if unit in fitting:
        return unit
    cure = (
        f"the size fits the unit {fitting[0]}: give --unit {fitting[0]} or leave it out"
        if fitting
        else "cut the scan to one lower leg, or scale it"
    )
    measured = (
        f"{ankle_girth * UNITS[unit]:.4g} mm in the unit {unit}"
        if unit
        else "; ".join(
            f"{ankle_girth * size:.4g} mm in the unit {name}" for name, size in UNITS.items()
        )
    )
    raise ScanError(
        f"the narrowest girth, {measured}, is not that of an ankle ({low:g} to {high:g} mm); {cure}"
    )
