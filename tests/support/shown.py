"""Small solvers with a geometry: a beam that bends, a pipe coloured around and along."""

from __future__ import annotations

import numpy as np

from surrogate.errors import SolverError
from surrogate.scene import Line, Mark, Scene
from surrogate.solver import Input, Output

ALONG = np.linspace(0.0, 1.0, 9)


class Beam:
    """Cantilever drawn as a strip that bends under its load: exact in two polynomials."""

    version = "1"
    inputs = {
        "load": Input(unit="N", nominal=10.0, range=(0.0, 100.0)),
        "length": Input(unit="m", nominal=1.0, range=(0.5, 2.0)),
        "colour": Input(nominal=0.5, range=(0.0, 1.0)),
    }
    outputs = {
        "tip": Output(unit="mm"),
        "bend": Output(unit="mm", dims=("x",), coordinates={"x": ALONG}),
    }

    def __call__(self, load, length, colour):
        bend = load * length**3 * ALONG**2 * (3 - ALONG) / 420.0
        return {"tip": bend[-1], "bend": bend}

    def scene(self, load, length, colour):
        x, y = (grid.ravel() for grid in np.meshgrid(ALONG, [-0.05, 0.0, 0.05], indexing="ij"))
        sag = load * length**3 * x**2 * (3 - x) / 420e3
        points = np.column_stack([length * x, y, -sag])
        corner = (3 * np.arange(len(ALONG) - 1)[:, None] + np.arange(2)).ravel()
        triangles = np.concatenate(
            [
                np.column_stack([corner, corner + 3, corner + 4]),
                np.column_stack([corner, corner + 4, corner + 1]),
            ]
        )
        return Scene(
            points,
            triangles,
            "m",
            coordinates={"x": x, "y": y},
            fields=("bend",),
            lines=(Line("axis", [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]),),
            marks=(Mark("tip", points[-2], output="tip"),),
        )


class Hollow(Beam):
    """The beam, without a geometry for long spans."""

    def scene(self, load, length, colour):
        if length > 0.52:
            raise SolverError("the beam is too long to be drawn")
        return super().scene(load, length, colour)
