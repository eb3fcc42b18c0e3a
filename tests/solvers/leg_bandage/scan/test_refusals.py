"""Files that are no scan of a leg: a sentence with the cure each."""

import os

import numpy as np
import pytest
import trimesh
import virtual_scans as virtual

from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.scan import ScanError, fit_scan
from surrogate_solvers.leg_bandage.scan.reading import read_surface

MEAN = Leg.from_alphas(240.0, shipped_basis().mean)
SKIN = virtual.leg_mesh(MEAN)


def tube(radius, length=240.0, around=80):
    """A surface of revolution."""
    turn = 2 * np.pi * np.arange(around) / around
    z = np.linspace(0, length, len(radius))
    points = np.stack(
        [
            np.outer(radius, np.cos(turn)),
            np.outer(radius, np.sin(turn)),
            np.repeat(z[:, None], around, axis=1),
        ],
        axis=-1,
    )
    a = np.arange(len(radius) * around).reshape(-1, around)
    b = np.roll(a, -1, axis=1)
    lower = np.column_stack([a[:-1].ravel(), b[:-1].ravel(), b[1:].ravel()])
    upper = np.column_stack([a[:-1].ravel(), b[1:].ravel(), a[1:].ravel()])
    return points.reshape(-1, 3), np.concatenate([lower, upper])


def half():
    vertices, triangles = SKIN
    return vertices, triangles[vertices[triangles][:, :, 0].mean(axis=1) > 0]


def box():
    made = trimesh.creation.box((100, 100, 300)).subdivide().subdivide().subdivide()
    return made.vertices, made.faces


def sphere():
    made = trimesh.creation.icosphere(4, radius=80)
    return made.vertices, made.faces


def two_legs():
    vertices, triangles = SKIN
    return (
        np.concatenate([vertices, vertices + [200, 0, 0]]),
        np.concatenate([triangles, triangles + len(vertices)]),
    )


def torn():
    vertices, triangles = SKIN
    return vertices, virtual.without(vertices, triangles, [((0, 60, 120), 90)])


@pytest.mark.parametrize(
    "mesh, sentence",
    [
        (sphere, "no leg is found.*scan from the ankle to the knee"),
        (box, "no leg is found.*378.6 to 378.6"),
        (lambda: tube(35 + 25 * np.linspace(0, 1, 80)), "sections of the scan are circles"),
        (half, "shows 7.% of the circumference.*scan the leg all around"),
        (two_legs, "falls into 2 pieces, the largest with 50%.*cut out one leg"),
        (torn, "holes make up 2.% of the skin.*at most 15%"),
        (lambda: virtual.leg_mesh(MEAN, 0, 160), "only 151 mm of leg.*scan up to the knee"),
        (lambda: virtual.leg_mesh(MEAN, 200, 480, foot=True), "is not that of an ankle"),
        (lambda: virtual.leg_mesh(MEAN, 110, 240), "no leg is found"),
        (lambda: tube(np.full(2, 50.0), around=8), "16 triangles cannot show a leg"),
        (lambda: (np.where(SKIN[0] > 200, np.nan, SKIN[0]), SKIN[1]), "no finite coordinates"),
    ],
    ids=[
        "sphere",
        "box",
        "cone",
        "half",
        "two legs",
        "torn",
        "short",
        "thigh",
        "top half",
        "coarse",
        "not finite",
    ],
)
def test_no_leg(tmp_path, mesh, sentence):
    with pytest.raises(ScanError, match=f"leg.stl: .*{sentence}"):
        fit_scan(virtual.save(tmp_path / "leg.stl", *mesh()))


@pytest.mark.parametrize(
    "name, content, sentence",
    [
        ("leg.stl", b"", "the file is empty"),
        ("leg.stl", b"\0" * 40, "is not a mesh in the format stl|holds no triangles"),
        ("leg.stl", b"dear diary\n" * 40, "is not a mesh in the format stl|holds no triangles"),
        ("leg.ply", b"dear diary\n" * 40, "is not a mesh in the format ply"),
        ("leg.obj", b"dear diary\n" * 40, "holds no triangles|is not a mesh in the format obj"),
        ("leg.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "3 points and no triangles|holds no triangles"),
        ("leg.stl", b"\x80" + b"\xe9\0" * 4000, r"is not a mesh in the format stl \((?!Module)"),
        ("leg.txt", b"0 0 0", "'.txt' is not a format that is read here; save the scan as stl"),
    ],
)
def test_no_mesh(tmp_path, name, content, sentence):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ScanError, match=sentence):
        fit_scan(tmp_path / name)


def test_points_only(tmp_path):
    trimesh.PointCloud(SKIN[0]).export(tmp_path / "leg.ply")
    with pytest.raises(ScanError, match="10800 points and no triangles; make a surface"):
        fit_scan(tmp_path / "leg.ply")


@pytest.mark.parametrize(
    "options, sentence",
    [
        ({"unit": "m"}, "2.192e.05 mm in the unit m.*give --unit mm"),
        ({"unit": "furlong"}, "unit 'furlong' is unknown.*Allowed: cm, inch, m, mm"),
        ({"side": "lft"}, "did you mean 'left'"),
        ({"up": "-z"}, "given as up is 1[78]. degrees from"),
        ({"up": "z", "front": "-y"}, "given as front is 1.. degrees from"),
        ({"up": "z", "front": "-z"}, "are the same axis"),
        ({"front": "y"}, "without up"),
        ({"up": "w"}, "up 'w' is not a direction"),
        ({"length": 300.0}, "ends 2[34]. mm above the ankle.*give a shorter length"),
        ({"length": 24.0}, "24 mm is not one of a lower leg"),
        ({"length": 200.0, "ends": True}, "give one"),
    ],
)
def test_options_that_do_not_fit(tmp_path, options, sentence):
    path = virtual.save(tmp_path / "leg.stl", *SKIN)
    with pytest.raises(ScanError, match=sentence):
        fit_scan(path, **{"side": "right", **options})


def test_missing_file():
    with pytest.raises(ScanError, match="nowhere.stl: there is no such file"):
        fit_scan("nowhere.stl")


def test_no_leg_is_said_before_the_side_is_asked(tmp_path):
    """A bottle: a neck, a belly, flattened, alike on both sides."""
    points, triangles = tube(30 + 22 * np.sin(np.linspace(0, np.pi / 1.5, 80)) ** 2, 300.0)
    path = virtual.save(tmp_path / "leg.stl", points * [1.5, 0.6, 1], triangles)
    with pytest.raises(ScanError, match="hardly a lower leg"):
        fit_scan(path)


def person():
    """A person with closed legs and arms at the side, 1.72 m: half widths at heights in mm."""
    height = [0, 80, 300, 420, 850, 1000, 1150, 1350, 1450, 1480, 1540, 1640, 1720]
    wide = [110, 90, 120, 110, 190, 160, 150, 200, 180, 60, 60, 78, 40]
    z = np.linspace(0, 1720, 200)
    points, triangles = tube(np.interp(z, height, wide), 1720.0)
    return points * [1, 0.6, 1], triangles


@pytest.mark.parametrize("scale, options", [(1.0, {}), (0.001, {}), (0.1, {"unit": "cm"})])
def test_a_whole_body_is_more_than_a_leg(tmp_path, scale, options):
    """Its height as a body's, and how to cut a leg out."""
    vertices, triangles = person()
    path = virtual.save(tmp_path / "leg.ply", scale * vertices, triangles)
    with pytest.raises(
        ScanError, match="more than a leg: it is 17.. mm .*cut one leg out.*MeshLab"
    ):
        fit_scan(path, **options)


PLY = """ply
format ascii 1.0
element vertex {0}
property float x
property float y
property float z
element face {1}
property list uchar int vertex_indices
end_header
"""


def test_triangles_of_corners_that_are_not_there(tmp_path):
    corners = [f"{x} {y} {z}" for x in range(7) for y in range(6) for z in range(7)]
    faces = [f"3 {k} {k + 1} {k + 2}" for k in range(290)] + ["3 0 1 294", "3 0 1 100000000"]
    text = PLY.format(len(corners), len(faces)) + "\n".join([*corners, *faces]) + "\n"
    (tmp_path / "leg.ply").write_text(text)
    with pytest.raises(ScanError, match="2 triangles name corners that are not there.*294 corners"):
        fit_scan(tmp_path / "leg.ply")


def test_files_that_a_scan_names_are_not_opened(tmp_path, monkeypatch):
    """A material file that is a pipe without a writer would be waited for without end."""
    os.mkfifo(tmp_path / "skin.mtl")
    path = virtual.save(tmp_path / "leg.obj", *virtual.leg_mesh(MEAN, levels=20, around=20))
    path.write_text("mtllib skin.mtl\nusemtl skin\n" + path.read_text())
    assert len(read_surface(path).triangles) == 2 * 19 * 20
    with pytest.raises(ScanError, match="skin.obj: there is no such file"):
        os.mkfifo(tmp_path / "skin.obj")
        fit_scan(tmp_path / "skin.obj")


def test_triangles_at_random_are_no_surface(tmp_path):
    """5 000 triangles between 1 000 places: refused for their area, before they are cut."""
    rng = np.random.default_rng(3)
    path = virtual.save(
        tmp_path / "leg.ply", rng.uniform(0, 300, (1000, 3)), rng.integers(0, 1000, (5000, 3))
    )
    with pytest.raises(ScanError, match=r"is no surface: its triangles have \d+ times the area"):
        fit_scan(path)


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    """Half a gigabyte, of which the disk has nothing."""
    with (tmp_path / "leg.stl").open("wb") as stream:
        stream.truncate(500_000_000)
    with pytest.raises(ScanError, match="500 MB .at most 150.; export the scan with fewer"):
        fit_scan(tmp_path / "leg.stl")
