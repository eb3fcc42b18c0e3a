"""A picture of a bandage as it is worn: other postures beside the leg that lies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..equilibrium.model import skin_parameters
from ..surfaces.skin import Skin
from .picture import figure_of
from .pressure_map import pressure_map
from .result import Result

Array = NDArray[np.float64]
SHOWN = ("lying", "standing", "dorsiflexion", "240 minutes", "standing after 4 h")
TIMES_MAGNIFIED = 3.0


def draw_states(result: Result, path: str | Path) -> Path:
    """Section at B1 (change of shape magnified), pressure around it and along the inside.

    PNG; of the states that the result has, see `SHOWN`. Raises SolverError without matplotlib.
    """
    figure = figure_of(15, 5)
    section, around, along = figure.subplots(1, 3)
    z, theta = float(result.values["b1_height"]), np.linspace(0, 2 * np.pi, 181)
    heights = np.linspace(0, result.leg.length, 121)
    lying = _section(result, result.states["lying"], theta, z)
    for name in [one for one in SHOWN if one in result.states]:
        u = result.states[name]
        found = pressure_map(result.model, u)
        x = lying + TIMES_MAGNIFIED * (_section(result, u, theta, z) - lying)
        section.plot(*x.T[:2], label=name)
        around.plot(np.degrees(theta), found.at(theta, np.full(theta.shape, z))[0], label=name)
        along.plot(heights, found.at(np.full(heights.shape, np.pi), heights)[0], label=name)
    section.set_aspect("equal")
    section.set_title(f"Section {z:.0f} mm up; change from lying times {TIMES_MAGNIFIED:g}")
    section.set_xlabel("lateral, mm")
    section.set_ylabel("front, mm")
    around.set_title("Pressure around it, mmHg")
    around.set_xlabel("theta, degrees (0 lateral, 90 anterior, 180 medial)")
    along.set_title("Pressure along the inside of the leg, mmHg")
    along.set_xlabel("height, mm")
    along.axvline(z, color="grey", linewidth=0.8)
    around.legend()
    figure.savefig(path, dpi=100)
    return Path(path)


def _section(result: Result, u: Array, theta: Array, z: float) -> Array:
    """(n, 3) places of the skin that lay at angles and one height."""
    model = result.model
    x = model.mesh.mesh.p.T + u.reshape(-1, 3)[: model.mesh.mesh.nvertices]
    xi = skin_parameters(model.mesh, np.column_stack([theta, np.full(theta.shape, z)]))
    return np.asarray(Skin(model.mesh.skin).at(xi, x)[:, 0])
