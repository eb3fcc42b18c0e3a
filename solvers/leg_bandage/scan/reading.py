"""From a file to one connected surface of triangles, in the unit of the file."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import trimesh
from scipy.sparse.csgraph import connected_components

from .errors import ScanError

FORMATS = ("stl", "ply", "obj")
LEAST_TRIANGLES = 200
LARGEST_FILE = 150
"""MB: three million triangles as binary STL, which take 2 GB of memory."""
MOST_AREA = 5.0
"""Of the triangles, over that of the box around them. A leg has 0.8, with an inner shell 1.6."""
LARGEST_SHARE = 0.6
"""Of the whole area, that the largest piece must have for the others to be left out."""
MERGE = 1e-6
"""Corners nearer than this part of the size of the scan are one corner."""
GRID = round(1 / MERGE) + 1
"""Steps of that size along each axis: three of them make one 64-bit number."""

_ASCII = bytes(letter if letter < 128 else ord("?") for letter in range(256))


@dataclass(frozen=True)
class Surface:
    """One connected surface.

    vertices   (n, 3) in the unit of the file
    triangles  (m, 3) numbers of vertices
    notes      sentences on what was done to it
    """

    vertices: np.ndarray
    triangles: np.ndarray
    notes: tuple[str, ...] = ()


def scans_in(folder: Path) -> list[Path]:
    """The files of a folder in a format that is read here, by name."""
    return sorted(
        path for path in folder.iterdir() if path.suffix.lower().removeprefix(".") in FORMATS
    )


def read_surface(path: str | Path) -> Surface:
    """The largest connected surface in an STL, PLY or OBJ file; raises ScanError."""
    path = Path(path)
    if path.is_dir():
        raise ScanError(f"{path}: is a folder; give one of its scans ({', '.join(FORMATS)})")
    kind = path.suffix.lower().removeprefix(".")
    if kind not in FORMATS:
        raise ScanError(
            f"{path}: '{path.suffix}' is not a format that is read here; save the "
            f"scan as {', '.join(FORMATS)}"
        )
    vertices, triangles = _load(path, kind)
    vertices, triangles = _merged(path, vertices, triangles)
    return _largest_piece(path, vertices, triangles)


def _load(path: Path, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles as they are in the file."""
    if not path.is_file():
        raise ScanError(f"{path}: there is no such file; check the name and the folder")
    size = path.stat().st_size
    if size == 0:
        raise ScanError(f"{path}: the file is empty; export the scan again")
    if size > LARGEST_FILE * 1e6:
        raise ScanError(
            f"{path}: the file has {size / 1e6:.0f} MB (at most {LARGEST_FILE}); export the scan "
            "with fewer triangles, 100 000 show a leg, or cut the leg out"
        )
    try:
        parts = _scene(path, kind).dump()
    except Exception as error:  # the reader raises whatever a broken file leads it to
        raise ScanError(
            f"{path}: is not a mesh in the format {kind} ({_line(error)}); export "
            "the scan again as binary STL or PLY"
        ) from None
    meshes = [part for part in parts if isinstance(part, trimesh.Trimesh) and len(part.faces)]
    points = sum(len(part.vertices) for part in parts if hasattr(part, "vertices"))
    if not meshes and points:
        raise ScanError(
            f"{path}: holds {points} points and no triangles; make a surface from "
            "them first (Poisson reconstruction in MeshLab, for example)"
        )
    if not meshes:
        raise ScanError(f"{path}: holds no triangles; export the scan again as binary STL or PLY")
    for mesh in meshes:
        beyond = (mesh.faces < 0) | (mesh.faces >= len(mesh.vertices))
        if beyond.any():
            raise ScanError(
                f"{path}: {beyond.any(axis=1).sum()} triangles name corners that are not there (it "
                f"has {len(mesh.vertices)} corners); export the scan again"
            )
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes[:-1]])
    return (
        np.concatenate([mesh.vertices for mesh in meshes]).astype(float),
        np.concatenate([mesh.faces + k for mesh, k in zip(meshes, first, strict=True)]),
    )


def _scene(path: Path, kind: str) -> trimesh.Scene:
    """What is in the file; letters beyond ASCII (names, in whatever encoding) are left aside.

    Only this file is read: none that it names, such as materials. Raises ValueError for what
    is neither text nor a whole binary file.
    """
    content = path.read_bytes()
    if not (kind == "stl" and _whole_binary(content)):
        head, end, rest = content.partition(b"end_header") if kind == "ply" else (content, b"", b"")
        if b"\0" in head:
            raise ValueError(
                "neither text nor as long as a binary file says that it is: cut short, or "
                "of another format"
            )
        content = head.translate(_ASCII) + end + rest
    return trimesh.load_scene(BytesIO(content), file_type=kind, process=False)


def _whole_binary(content: bytes) -> bool:
    """Whether an STL file has the 50 bytes for each triangle that its header counts."""
    return len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")


def _line(error: Exception) -> str:
    """First line of a message, short enough for a sentence."""
    words = str(error).strip().splitlines()
    if words and isinstance(error, ValueError):
        return words[0][:120]
    return f"{type(error).__name__}: {words[0][:80]}" if words else type(error).__name__


def _merged(
    path: Path, vertices: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Corners at the same place made one (STL repeats them), flat triangles left out."""
    vertices, triangles = _used(vertices, triangles)
    finite = np.isfinite(vertices).all(axis=1)
    if not finite.all():
        raise ScanError(
            f"{path}: {(~finite).sum()} corners have no finite coordinates; export the scan again"
        )
    size = np.ptp(vertices, axis=0).max()
    if size == 0:
        raise ScanError(f"{path}: all corners lie in one point; export the scan again")
    steps = np.round((vertices - vertices.min(axis=0)) / (MERGE * size)).astype(np.int64)
    _, keep, same = np.unique(steps @ [GRID**2, GRID, 1], return_index=True, return_inverse=True)
    triangles = same[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    if len(triangles) < LEAST_TRIANGLES:
        raise ScanError(
            f"{path}: {len(triangles)} triangles cannot show a leg (at least "
            f"{LEAST_TRIANGLES}, best 5 000 and more); export a finer mesh"
        )
    vertices = vertices[keep]
    _check_area(path, vertices, triangles)
    return vertices, triangles


def _check_area(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Raise ScanError for triangles that cross each other all over, which are no surface."""
    x, y, z = np.ptp(vertices, axis=0)
    box = 2 * (x * y + y * z + z * x)
    area = triangle_areas(vertices[triangles]).sum()
    if area > MOST_AREA * box:
        raise ScanError(
            f"{path}: is no surface: its triangles have {area / box:.0f} times the area of the box "
            f"around them (at most {MOST_AREA:g}); make a surface from the points again"
        )


def _largest_piece(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> Surface:
    """The connected piece of largest area, if it has most of the area."""
    edges = triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = sp.coo_matrix((np.ones(len(edges)), edges.T), (len(vertices), len(vertices)))
    piece = connected_components(graph, directed=False)[1][triangles[:, 0]]
    names, piece = np.unique(piece, return_inverse=True)
    areas = np.bincount(piece, weights=triangle_areas(vertices[triangles]))
    share = areas.max() / areas.sum()
    if share < LARGEST_SHARE:
        raise ScanError(
            f"{path}: falls into {len(names)} pieces, the largest with {share:.0%} of "
            "the area; cut out one leg, or close the gaps between its parts, and "
            "export that alone"
        )
    notes: tuple[str, ...] = ()
    if len(names) > 1:
        notes = (
            f"the scan has {len(names)} pieces; the largest, {share:.1%} of the area, is taken",
        )
    triangles = triangles[piece == areas.argmax()]
    return Surface(*_used(vertices, triangles), notes)


def _used(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Without the vertices that no triangle names."""
    used = np.zeros(len(vertices), bool)
    used[triangles.ravel()] = True
    return vertices[used], (np.cumsum(used) - 1)[triangles]


def triangle_areas(corners: np.ndarray) -> np.ndarray:
    """Areas (m,) of triangles (m, 3 corners, 3)."""
    return (
        np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        / 2
    )
