"""Landmarks that the user gives: `--landmark malleolus_medial=12.5,-30,84`, in the file's axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from surrogate.errors import nearest

from .errors import ScanError
from .pose import Body
from .sections import cut_sections

DIRECTIONS: Mapping[str, float] = {
    "malleolus_medial": 180.0,
    "malleolus_lateral": 0.0,
    "tibial_tuberosity": 90.0,
    "toes": 90.0,
}
"""Where each lies about the leg, degrees from the outside by the front."""
NEAR = 25.0
"""mm from a vertex of the skin."""


@dataclass(frozen=True)
class Landmarks:
    """name -> point (3,) in the axes and the unit of the file."""

    points: Mapping[str, np.ndarray]

    @classmethod
    def parse(cls, words: Iterable[str]) -> Landmarks:
        """From `name=x,y,z`; raises ScanError."""
        found = {}
        for word in words:
            name, _, place = word.partition("=")
            if name not in DIRECTIONS:
                raise ScanError(f"landmark {name!r} is unknown; {nearest(name, DIRECTIONS)}")
            try:
                point = np.array([float(number) for number in place.split(",")])
            except ValueError:
                point = np.zeros(0)
            if point.shape != (3,) or not np.isfinite(point).all():
                raise ScanError(
                    f"landmark {word!r} is not a point: give {name}=x,y,z in the axes and the "
                    "unit of the file"
                )
            found[name] = point
        return cls(found)

    def front(self, body: Body) -> float | None:
        """Direction of the front about a body that stands, rad; None without landmarks.

        Each landmark tells it about the centre of its section; both malleoli tell it by the line
        between them. Directions are averaged.
        """
        seen = self._seen(body)
        if {"malleolus_medial", "malleolus_lateral"} <= seen.keys():
            line = seen.pop("malleolus_medial")[0] - seen.pop("malleolus_lateral")[0]
            seen["malleolus_medial"] = (line, np.zeros(2))
        turned = [
            complex(*(place - centre)) * np.exp(1j * np.radians(90.0 - DIRECTIONS[name]))
            for name, (place, centre) in seen.items()
        ]
        if not turned:
            return None
        return float(np.angle(sum(one / abs(one) for one in turned)))

    def side(self, body: Body) -> str | None:
        """Side of a body that stands with its front along y, by the malleoli; None without."""
        seen = self._seen(body)
        out = [
            (place - centre)[0] * (-1 if name == "malleolus_medial" else 1)
            for name, (place, centre) in seen.items()
            if name.startswith("malleolus")
        ]
        if not out:
            return None
        return "right" if sum(out) > 0 else "left"

    def _seen(self, body: Body) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """name -> its place and the centre of its section, (2,) each; raises ScanError."""
        found = {}
        for name, point in self.points.items():
            place = body.scale * point @ body.frame.T + body.shift
            low, high = body.vertices[:, 2].min(), body.vertices[:, 2].max()
            away = np.linalg.norm(body.vertices - place, axis=1).min()
            if away > NEAR:
                raise ScanError(
                    f"landmark {name} lies {away:.0f} mm from the skin (at most {NEAR:g}); give it "
                    "in the axes and the unit of the file"
                )
            level = float(np.clip(place[2], low + 2, high - 2))
            centre = cut_sections(
                body.vertices, body.triangles, np.array([level - 1, level + 1])
            ).centre.mean(axis=0)
            found[name] = (place[:2], centre)
        return found
