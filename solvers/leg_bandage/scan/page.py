"""The pages that `--html` writes: one file each, that opens offline and loads nothing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from surrogate.errors import SolverError

from ..geometry.landmarks import Disc, sensor
from ..geometry.leg import Leg
from .drawing import curves, outlines
from .fitting import FittedScan
from .growing import GrownCohort
from .sections import THETA
from .summary import figures

ROOM = __package__
EVERY = 3
"""Of the rays, that go to the page."""


def scan_page(scan: FittedScan) -> str:
    """The leg in 3D, its sections, its residual map and its figures."""
    told = figures(scan)
    marks = told["landmarks"]["scanned"]
    levels = {"ankle": marks["ankle"], "B1": marks["b1_girth"], "calf": marks["calf"]}
    levels = {name: place["height"] for name, place in levels.items() if place is not None}
    return render(
        ROOM,
        "scan.html",
        told=told,
        scan=scan,
        levels=levels,
        sections=[Markup(outlines(name, height, scan)) for name, height in levels.items()],
        girths=Markup(_girth_curves(scan, levels)),
        data=Markup(json.dumps(_shape(scan, levels), separators=(",", ":"))),
    )


def cohort_page(grown: GrownCohort, folder: Path) -> str:
    """Reconstruction error against the number of modes, as Figure 1 of Chassagne et al. 2018."""
    modes = np.array([loss.modes for loss in grown.losses])
    lines = {
        "95 %, legs of the basis": [loss.percentile_95 for loss in grown.losses],
        "95 %, left out": [loss.left_out_95 for loss in grown.losses],
        "RMS, legs of the basis": [loss.rms for loss in grown.losses],
    }
    drawing = curves(
        modes,
        {name: np.array(line) for name, line in lines.items()},
        "number of modes",
        "error of the skin, mm",
        dots=True,
        from_zero=True,
    )
    facts = grown.cohort.facts
    legs = list(zip(facts["file"], facts["side"], grown.cohort.length, strict=True))
    return render(
        ROOM, "cohort.html", grown=grown, folder=folder.name, legs=legs, drawing=Markup(drawing)
    )


def render(package: str, template: str, **content: Any) -> str:
    """A page from a template of a package; `include_raw` takes a file beside it as it is."""
    loader = PackageLoader(package, "templates")
    environment = Environment(
        loader=loader,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["include_raw"] = lambda name: Markup(
        loader.get_source(environment, name)[0]
    )
    return environment.get_template(template).render(**content)


def _girth_curves(scan: FittedScan, levels: dict[str, float]) -> str:
    z = np.linspace(0, scan.length, 80)
    return curves(
        z,
        {"scan": scan.scanned.girth(z), "fitted leg": scan.leg.girth(z)},
        "height above the ankle cut, mm",
        "girth, mm",
        marks=levels,
    )


def _shape(scan: FittedScan, levels: dict[str, float]) -> dict[str, Any]:
    """Grids for the drawing on the page: points and residuals at every third ray."""
    fitted = scan.leg.surface(THETA[::EVERY], scan.leg.z[:, None])
    return {
        "length": round(scan.length, 1),
        "levels": levels,
        "z": np.round(scan.leg.z, 1).tolist(),
        "scan": np.round(scan.sections.points[:, ::EVERY, :2], 1).tolist(),
        "fitted": np.round(fitted[..., :2], 1).tolist(),
        "residual": np.round(scan.residual[:, ::EVERY], 2).tolist(),
        "holes": scan.sections.missing[:, ::EVERY].astype(int).tolist(),
        "sensor": _sensor_rim(scan.scanned),
    }


def _sensor_rim(leg: Leg) -> list[list[float]]:
    """Points of the skin on the rim of the sensor, by straight distance; [] without a B1."""
    try:
        disc = sensor(leg)
    except SolverError:
        return []
    return np.round(sensor_rim(leg, disc), 1).tolist()


def sensor_rim(leg: Leg, disc: Disc, points: int = 40) -> np.ndarray:
    """Skin under the rim of a sensor, (points, 3), mm.

    Each direction is followed along the skin until half a diameter away, as the crow flies.
    """
    turn = 2 * np.pi * np.arange(points) / points
    centre, reach = leg.surface(disc.theta, disc.z), np.full(points, disc.diameter / 2)
    for _ in range(8):
        theta = disc.theta + reach * np.cos(turn) / float(leg.radius(disc.theta, disc.z))
        rim = leg.surface(theta, np.clip(disc.z + reach * np.sin(turn), 0, leg.length))
        away = np.linalg.norm(rim - centre, axis=1)
        reach = reach * disc.diameter / 2 / away
    return rim
