"""Where a leg that stands is cut: the ankle below, the upper end of the bandaged part above.

The ankle is the narrowest girth. Above, the shipped legs were cut at a part of the shank,
which a scan does not show; the nearest thing that it shows is the widest girth of the
calf, and the shipped legs reach `TOP` of the way from the ankle to it (median of the 35;
0.98 to 1.10 for nine in ten). All in mm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, CubicSpline, make_lsq_spline

from ..geometry.cohort import SECTIONS
from .errors import ScanError
from .girths import COMPLETE, Zone, complete_levels
from .pose import Body
from .sections import coverage, cut_sections

TOP = 1.03
SHORTEST = 0.75
"""Length over ankle girth under which a leg has no calf to speak of; the shipped legs have
0.83 and more."""

SPAN = 20.0
"""mm, of the spline through the girths: wider than noise, narrower than the ankle."""


@dataclass(frozen=True)
class Cuts:
    """Heights of both cuts, and how they were found: sentences."""

    ankle: float
    top: float
    notes: tuple[str, ...]

    @property
    def levels(self) -> np.ndarray:
        """(100,) heights of the sections."""
        return np.linspace(self.ankle, self.top, SECTIONS)

    @property
    def length(self) -> float:
        """mm between the cuts."""
        return self.top - self.ankle


def find_cuts(body: Body, zone: Zone, length: float | None = None, ends: bool = False) -> Cuts:
    """Cuts of a leg along z near a guess of its ankle and calf.

    length: known length, mm, above the ankle. ends: cut where the scan ends. Raises ScanError
    when the scan does not reach.
    """
    low, high = complete_range(body, zone)
    if ends:
        return _long_enough(Cuts(low, high, ("cut where the scan ends",)), zone)
    girth = _girths(body, max(low, zone.ankle - 40), min(high, zone.calf + 60))
    ankle = _ankle(girth, zone)
    below = f"cut at the narrowest girth, {ankle - low:.0f} mm above the lower end of the scan"
    if ankle - low < 1:
        below = "cut at the lower end of the scan, which is its narrowest girth"
    if length is not None:
        if ankle + length > high:
            raise ScanError(
                f"the scan ends {high - ankle:.0f} mm above the ankle, before the "
                f"length of {length:g} mm; give a shorter length or scan higher up"
            )
        return Cuts(ankle, ankle + length, (below, f"length as given, {length:g} mm"))
    calf, fallen = _calf(girth, zone)
    wanted = ankle + TOP * (calf - ankle)
    if fallen and wanted <= high:
        above = (
            f"upper cut at {TOP:g} of the way from ankle to widest calf, "
            f"{high - wanted:.0f} mm under the upper end of the scan"
        )
        return _long_enough(Cuts(ankle, wanted, (below, above)), zone)
    above = (
        f"upper cut at the upper end of the scan, {high - ankle:.0f} mm above the ankle; a "
        "longer scan would be cut higher up"
    )
    return _long_enough(Cuts(ankle, high, (below, above)), zone)


def complete_range(body: Body, zone: Zone) -> tuple[float, float]:
    """Lowest and highest level with a complete section, to 0.1 mm."""
    low, high = complete_levels(body.vertices, body.triangles)[[0, -1]]
    step = np.ptp(body.vertices[:, 2]) / 200
    return (_last_complete(body, low, low - step), _last_complete(body, high, high + step))


def _last_complete(body: Body, inside: float, outside: float) -> float:
    """The last complete level on the way from inside to outside."""
    z = np.linspace(min(inside, outside), max(inside, outside), 40)
    whole = z[coverage(body.vertices, body.triangles, z) >= COMPLETE]
    if len(whole) == 0:
        return inside
    return float(whole.min() if outside < inside else whole.max())


def _girths(body: Body, low: float, high: float) -> BSpline:
    """Girth as a smooth spline of the height."""
    z = np.linspace(low, high, 160)
    raw = cut_sections(body.vertices, body.triangles, z).girth
    spans = max(4, round((high - low) / SPAN))
    knots = np.concatenate([[low] * 3, np.linspace(low, high, spans + 1), [high] * 3])
    return make_lsq_spline(z, raw, knots, k=3)


def _ankle(girth: BSpline, zone: Zone) -> float:
    """Height of the narrowest girth under the calf."""
    levels = _levels(girth, girth.t[0], zone.calf)
    return float(levels[girth(levels).argmin()])


def _calf(girth: BSpline, zone: Zone) -> tuple[float, bool]:
    """Height of the widest girth, and whether the girth falls above it.

    The maximum is flat: taken is the middle of the stretch within half a per cent of it.
    """
    end = girth.t[-1]
    levels = _levels(girth, max(zone.ankle, zone.calf - 40), min(zone.calf + 40, end))
    peak = levels[girth(levels).argmax()]
    z = np.linspace(zone.ankle, end, 2001)
    near = CubicSpline(z, girth(z) - 0.995 * girth(peak)).roots(extrapolate=False)
    below, above = near[near < peak], near[near > peak]
    if len(below) and len(above):
        return float(below.max() + above.min()) / 2, True
    return float(peak), bool(peak < end)


def _levels(girth: BSpline, low: float, high: float) -> np.ndarray:
    """Levels between low and high where the girth may be extreme."""
    z = np.linspace(low, high, 501)
    turns = CubicSpline(z, girth(z)).derivative().roots(extrapolate=False)
    return np.concatenate([[low], turns[np.isfinite(turns)], [high]])


def _long_enough(cuts: Cuts, zone: Zone) -> Cuts:
    if cuts.length < SHORTEST * zone.ankle_girth:
        raise ScanError(
            f"only {cuts.length:.0f} mm of leg lie between the ankle (girth "
            f"{zone.ankle_girth:.0f} mm) and the upper end of the scan, at least "
            f"{SHORTEST * zone.ankle_girth:.0f} mm are needed; scan up to the knee"
        )
    return cuts
