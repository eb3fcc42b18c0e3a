"""A solved bandage as a mesh for ParaView and others, through meshio.

The leg's hexahedra carry displacement and, on the skin, pressure; the bandage is written
as one quadrilateral an element with stretch, pressure and slip.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from surrogate.errors import SolverError

from ..equilibrium.model import Wrapped
from .pressure_map import MMHG, Sheet, pressure_map
from .result import Result


def leg_mesh(result: Result) -> meshio.Mesh:
    """The deformed leg: hexahedra with displacement (mm) and interface pressure (mmHg)."""
    model, grid = result.model, result.model.mesh
    nodes = grid.mesh.nvertices
    move = result.u.reshape(-1, 3)[:nodes]
    theta, z = np.meshgrid(grid.theta, grid.z, indexing="ij")
    pressed = np.zeros(nodes)
    pressed[grid.skin.ravel()] = pressure_map(model, result.u).at(theta.ravel(), z.ravel())[0]
    return meshio.Mesh(
        grid.mesh.p.T + move,
        [("hexahedron", _hexahedra(grid.nodes))],
        point_data={"displacement_mm": move, "pressure_mmHg": pressed},
    )


def bandage_mesh(result: Result) -> meshio.Mesh:
    """The deformed bandages: one quadrilateral an element.

    Cell data: warp stretch, pressure on the skin (mmHg), slip (mm), number of layers, and of the
    bandage, from 1.
    """
    found = pressure_map(result.model, result.u)
    sheets = zip(result.model.bandages, found.sheets, strict=True)
    parts = [_sheet_mesh(result, *one) for one in sheets]
    starts = np.cumsum([0, *(len(points) for points, _, _ in parts[:-1])])
    data = {name: [np.concatenate([part[2][name] for part in parts])] for name in parts[0][2]}
    data["bandage"] = [
        np.concatenate([np.full(len(part[1]), i + 1) for i, part in enumerate(parts)])
    ]
    return meshio.Mesh(
        np.concatenate([part[0] for part in parts]),
        [
            (
                "quad",
                np.concatenate([q + first for (_, q, _), first in zip(parts, starts, strict=True)]),
            )
        ],
        cell_data=data,
    )


def _sheet_mesh(
    result: Result, bandage: Wrapped, sheet: Sheet
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Points (n, 3), quadrilaterals (ns * nw, 4) and cell data of one bandage."""
    model, ns, nw = result.model, bandage.strip.ns, bandage.strip.nw
    corners = np.stack(np.meshgrid(np.arange(ns + 1.0), np.arange(nw + 1.0), indexing="ij"), -1)
    x = model.X + result.u.reshape(-1, 3)
    points = bandage.strip.at(corners.reshape(-1, 2), x)[:, 0]
    number = np.arange((ns + 1) * (nw + 1)).reshape(ns + 1, nw + 1)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1)
    middle = corners[:-1, :-1].reshape(-1, 2) + 0.5
    data = {
        "stretch": bandage.shell.at(result.u, middle).warp_stretch,
        "pressure_mmHg": sheet.strip.at(middle, sheet.pressure)[:, 0, 0] / MMHG,
        "slip_mm": sheet.slip.ravel(),
        "layers": bandage.lay.layers[:, 1:-1].ravel(),
    }
    return points, quads.reshape(-1, 4), data


def write(result: Result, stem: str | Path, suffix: str = ".vtu") -> tuple[Path, Path]:
    """Write <stem>_leg and <stem>_bandage in the format of `suffix`; returns both paths.

    Raises SolverError for a suffix that meshio does not write.
    """
    paths = Path(f"{stem}_leg{suffix}"), Path(f"{stem}_bandage{suffix}")
    for path, mesh in zip(paths, (leg_mesh(result), bandage_mesh(result)), strict=True):
        try:
            mesh.write(path)
        except (meshio.WriteError, KeyError) as error:
            raise SolverError(
                f"{path.name}: meshio cannot write it ({error}); use .vtu, .vtk or .xdmf"
            ) from error
    return paths


def _hexahedra(nodes: np.ndarray) -> np.ndarray:
    """Vertices (n, 8) of the grid's elements in the order of VTK."""
    around = np.concatenate([nodes, nodes[:1]])
    low, high = around[:, :, :-1], around[:, :, 1:]

    def face(layer):
        return [layer[:-1, :-1], layer[:-1, 1:], layer[1:, 1:], layer[1:, :-1]]

    return np.stack([*face(low), *face(high)], axis=-1).reshape(-1, 8)
