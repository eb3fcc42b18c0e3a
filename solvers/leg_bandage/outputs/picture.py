"""A picture of a solved bandage, drawn without a screen (matplotlib, optional)."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np

from surrogate.errors import SolverError

from ..equilibrium.model import midpoints
from ..geometry.landmarks import MEDIAL, Disc
from .pressure_map import pressure_map
from .result import Result


def draw(result: Result, path: str | Path) -> Path:
    """Pressure and layers unrolled over the skin, stretch and slip over the strip, as PNG.

    Raises SolverError when matplotlib is not installed.
    """
    model, leg = result.model, result.leg
    found = pressure_map(model, result.u)
    theta = np.linspace(0, 2 * np.pi, 181)
    z = np.linspace(0, leg.length, 121)
    grid = np.meshgrid(theta, z)
    pressure, layers = (
        v.reshape(grid[0].shape) for v in found.at(grid[0].ravel(), grid[1].ravel())
    )
    strip = model.strip
    stretch = model.shell.at(result.u, midpoints(strip)).warp_stretch.reshape(strip.ns, strip.nw)

    figure = figure_of(13, 8.5)
    panels = figure.subplots(2, 2)
    skin = np.degrees(theta), z
    _panel(figure, panels[0, 0], *skin, pressure, "Interface pressure, mmHg", "viridis")
    _panel(figure, panels[0, 1], *skin, layers, "Layers", "cividis")
    disc = Disc(MEDIAL, float(result.values["b1_height"]))
    panels[0, 0].plot(*_outline(leg, disc), color="white", linewidth=1.5)
    for panel in panels[0]:
        panel.set_xlabel("theta, degrees (0 lateral, 90 anterior, 180 medial)")
        panel.set_ylabel("height, mm")
    along = (np.arange(strip.ns) + 0.5) * model.lay.lengths.mean()
    over = (np.arange(strip.nw) + 0.5) * model.wrap.width / strip.nw - model.wrap.width / 2
    _panel(figure, panels[1, 0], along, over, stretch.T, "Warp stretch", "magma")
    _panel(
        figure, panels[1, 1], along, over, found.sheets[0].slip.T, "Slip on the skin, mm", "magma"
    )
    for panel in panels[1]:
        panel.set_xlabel("along the bandage at rest, mm")
        panel.set_ylabel("across, mm")
    figure.suptitle(f"B1: {result.values['pressure_b1']:.1f} mmHg")
    figure.savefig(path, dpi=100)
    return Path(path)


def figure_of(width: float, height: float) -> Any:
    """An empty figure, inches; raises SolverError when matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        raise SolverError(
            "pictures need matplotlib, which is not installed: pip install "
            "matplotlib; the numbers and `export` do not need it"
        )
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _panel(figure, panel, x, y, values, title, colours):
    image = panel.pcolormesh(x, y, values, cmap=colours, shading="nearest")
    figure.colorbar(image, ax=panel)
    panel.set_title(title)


def _outline(leg, disc):
    """theta in degrees and z of the rim of a sensor."""
    angle = np.linspace(0, 2 * np.pi, 61)
    turn = np.linalg.norm(leg.surface(disc.theta, disc.z, d_theta=1))
    radius = disc.diameter / 2
    return (np.degrees(disc.theta + radius * np.cos(angle) / turn), disc.z + radius * np.sin(angle))
