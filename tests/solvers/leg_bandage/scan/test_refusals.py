"""Files that are no scan of a leg: a sentence with the cure each."""

import numpy as np
import pytest
import trimesh
import virtual_scans as virtual

from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.scan import ScanError, fit_scan

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
    with pytest.raises(ScanError, match="19200 points and no triangles; make a surface"):
        fit_scan(tmp_path / "leg.ply")


@pytest.mark.parametrize(
    "options, sentence",
    [
        ({"unit": "m"}, "2.193e.05 mm in the unit m.*give --unit mm"),
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
