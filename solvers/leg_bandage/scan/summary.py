"""What a fitted scan tells, as figures for `--json` and for the page."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from surrogate.errors import SolverError

from ..geometry.landmarks import RULES, b1_height, extreme_girths
from ..geometry.leg import Leg
from .fitting import FittedScan


def figures(scan: FittedScan) -> dict[str, Any]:
    """Everything but the shape itself; lengths in mm."""
    return {
        "file": str(scan.path),
        "side": scan.side,
        "other_side": None if scan.other is None else _coordinates(scan.other),
        "front": None if scan.front is None else asdict(scan.front),
        "widening": scan.widening,
        "unit": scan.unit,
        "length": scan.length,
        "alphas": list(scan.alphas),
        "ranges": {k: list(v) for k, v in scan.ranges.items()},
        "in_range": scan.in_range,
        "error": asdict(scan.error),
        "landmarks": {"scanned": landmarks_of(scan.scanned), "fitted": landmarks_of(scan.leg)},
        "holes": float(scan.sections.missing.mean()),
        "notes": list(scan.notes),
    }


def _coordinates(scan: FittedScan) -> dict[str, Any]:
    return {"side": scan.side, "length": scan.length, "alphas": list(scan.alphas)}


def landmarks_of(leg: Leg) -> dict[str, Any]:
    """Ankle, calf and B1 by each rule: heights above the ankle cut and girths, mm.

    None for a B1 that the leg does not have. The rule `profile` is meant for legs made
    from shape coordinates: on scanned ones noise moves it.
    """
    ankle, ankle_z, calf, calf_z = extreme_girths(leg)
    found: dict[str, Any] = {
        "ankle": {"height": ankle_z, "girth": ankle},
        "calf": {"height": calf_z, "girth": calf},
    }
    for rule in RULES:
        found[f"b1_{rule}"] = _b1(leg, rule)
    return found


def _b1(leg: Leg, rule: str) -> dict[str, float] | None:
    try:
        height = b1_height(leg, rule)
    except SolverError:
        return None
    return {"height": height, "girth": float(leg.girth(height))}
