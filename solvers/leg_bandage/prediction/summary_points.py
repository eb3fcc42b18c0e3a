"""The pressure along a leg in words and figures: points, classes, gradient, curve."""

from __future__ import annotations

from typing import Any

import numpy as np

from .compression_class import STANDARDS, class_words
from .pressure import Prediction

PointRow = tuple[str, str, str, str, str, str]


def point_figures(told: Prediction) -> dict[str, Any]:
    """Points, class at the ankle, gradient and curve; mmHg, mm."""
    curve = told.curve()
    return {
        "points": {
            point.name: {
                "height": point.place.height,
                "girth": point.place.girth,
                "value": point.value,
                "low": point.low,
                "high": point.high,
                "target": point.target,
                "class": classes(point.value),
                "solved": told.solved_at(point),
                "read_at": point.place.read,
                "on_scan": point.place.known,
            }
            for point in told.points
        },
        "gradient": gradient(told),
        "profile": {
            name: np.round(getattr(curve, name), 3).tolist()
            for name in ("height", "mean", "lowest", "highest")
        },
    }


def classes(pressure: float) -> dict[str, str]:
    """Standard -> class of a pressure."""
    return {standard: class_words(pressure, standard) for standard in STANDARDS}


def gradient(told: Prediction) -> dict[str, Any]:
    """Pressure at D over that at B, beside the target; whether C and D are below B1."""
    value = {point.name: point.value for point in told.points}
    higher = max(value["C"], value["D"])
    ankle, knee = told.gradient
    return {
        "knee_over_ankle": value["D"] / value["B"] if value["B"] > 0 else None,
        "knee_over_b1": value["D"] / value["B1"] if value.get("B1", 0) > 0 else None,
        "target": {"ankle": ankle, "knee": knee, "knee_over_ankle": knee / ankle},
        "falls_from_b1": "B1" in value and higher < value["B1"],
    }


def point_rows(told: Prediction) -> list[PointRow]:
    """Point, height, mmHg, 95 % interval, target, class by each standard."""
    return [
        (
            point.name,
            f"{point.place.height:.0f}" + ("" if point.place.known else ", assumed"),
            f"{point.value:.1f}",
            f"{point.low:.1f} .. {point.high:.1f}",
            f"{point.target:.1f}",
            "; ".join(f"{name} {found}" for name, found in classes(point.value).items()),
        )
        for point in told.points
    ]


def gradient_words(told: Prediction) -> str:
    """The gradient in a line."""
    found = gradient(told)
    ratio, target = found["knee_over_ankle"], found["target"]
    words = "none" if ratio is None else f"{ratio:.2f}"
    return (
        f"gradient: pressure at D over that at B {words}; target {target['knee_over_ankle']:.2f} "
        f"({target['ankle']:g} mmHg at the ankle, {target['knee']:g} at the knee); from B1 to "
        f"calf and knee the pressure {'falls' if found['falls_from_b1'] else 'does not fall'}"
    )
