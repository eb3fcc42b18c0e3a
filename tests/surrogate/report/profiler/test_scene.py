"""The geometry in the page is the solver's, and its colours are the surrogate's."""

from __future__ import annotations

import json
import zlib
from dataclasses import replace
from pathlib import Path

import node
import numpy as np
import pytest
from made_up import ANGLES, HEIGHTS, bandage_space, make
from shown import Beam

from surrogate import report
from surrogate.fitting.geometry import geometry
from surrogate.report.profiler.chosen import chosen
from surrogate.report.profiler.payload import payload
from surrogate.report.profiler.picture import picture
from surrogate.report.profiler.scene_data import MOST_CHARACTERS
from surrogate.scene import Line, Mark, Scene
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.leg_bandage.plugin import LegBandage

ENGINE = Path(__file__).parents[3] / "support" / "engine.mjs"
#: Largest distance to Python, as a share of the geometry's size.
NEAR = 1e-5


def pipe(leg_length, **others):
    """A pipe as long as the leg, coloured over height and angle."""
    angle, height = (grid.ravel() for grid in np.meshgrid(ANGLES, HEIGHTS))
    a = np.radians(angle)
    points = np.column_stack([30 * np.cos(a), 30 * np.sin(a), height / 240.0 * leg_length])
    rows, columns = len(HEIGHTS), len(ANGLES)
    row, column = (grid.ravel() for grid in np.mgrid[: rows - 1, :columns])
    here, beside = row * columns + column, row * columns + (column + 1) % columns
    return Scene(
        points,
        np.concatenate(
            [
                np.column_stack([here, beside, beside + columns]),
                np.column_stack([here, beside + columns, here + columns]),
            ]
        ),
        coordinates={"angle": angle, "height": height},
        periods={"angle": 360.0},
        fields=("pressure_map",),
        lines=(
            Line("spiral", np.column_stack([np.linspace(-180, 900, 60), np.linspace(0, 240, 60)])),
        ),
        marks=(Mark("sensor", (90.0, 120.0), "pressure_b1"),),
    )


@pytest.fixture(scope="module")
def piped():
    """A made-up study of a field that is shown on a pipe."""
    content = make(outputs=("pressure_b1", "pressure_map"), surrogates=("quadratic",))
    return replace(content, scene=geometry(pipe, content.space, {}))


def asked(content, points):
    """The engine's scene at points of physical values."""
    shown = chosen(content)
    questions = [
        {"kind": "scene", "values": [float(v) if not isinstance(v, str) else v for v in point],
         "field": 0, "places": [0] * len(shown)}
        for point in points
    ]  # fmt: skip
    return node.answered(ENGINE, {"data": payload(content, shown), "questions": questions})


def array(found):
    """Components as JSON has them, as points (n, d)."""
    return np.array([list(component.values()) for component in found]).T


@node.needed
def test_the_leg_in_the_page_is_the_solvers():
    """At random inputs, to 1e-5 of the leg's size."""
    solver, space = LegBandage(mesh="coarse"), bandage_space()
    fixed = {name: one.nominal for name, one in solver.inputs.items() if name not in space.names}
    content = make(space, surrogates=("linear",), sensitivity=False)
    content = replace(content, scene=geometry(solver.scene, space, fixed))
    points = space.decode(np.random.default_rng(3).uniform(-1, 1, (8, space.size)))
    points = list(zip(*(points[name] for name in space.names), strict=True))
    for point, found in zip(points, asked(content, points), strict=True):
        own = solver.scene(**fixed, **dict(zip(space.names, point, strict=True)))
        away = np.linalg.norm(array(found["surface"]) - own.parts[0], axis=1)
        assert away.max() < NEAR * content.scene.size
        assert found["values"] is None


@node.needed
def test_a_beam_with_a_normal_length_in_the_page_is_the_solvers():
    """A second solver, a law without ends, and a parameter that moves nothing."""
    space = Space(
        (
            Parameter("load", uniform(0.0, 100.0), unit="N"),
            Parameter("colour", uniform(0.0, 1.0)),
            Parameter("length", distribution("normal", mean=1.0, std=0.1), unit="m"),
        )
    )
    content = make(space, surrogates=("linear",), sensitivity=False)
    content = replace(content, scene=geometry(Beam().scene, space, {}))
    assert content.scene.active == (0, 2)
    points = [(0.0, 0.2, 1.0), (80.0, 0.9, 1.2), (33.0, 0.1, 0.85)]
    for point, found in zip(points, asked(content, points), strict=True):
        own = Beam().scene(**dict(zip(space.names, point, strict=True)))
        assert np.abs(array(found["surface"]) - own.points).max() < NEAR * content.scene.size
        assert np.abs(array(found["marks"][0]) - own.marks[0].place).max() < NEAR


@node.needed
def test_colours_and_marks_are_the_surrogates(piped):
    points = piped.space.decode(np.random.default_rng(4).uniform(-1, 1, (4, piped.space.size)))
    rows = list(zip(*(points[name] for name in piped.space.names), strict=True))
    coded = piped.space.encode({name: np.asarray(v) for name, v in points.items()})
    fits = {name: piped.fits["quadratic"][name] for name in piped.outputs}
    spread = np.ptp(fits["pressure_map"].values)
    told = fits["pressure_map"].predict(coded).reshape(len(coded), -1)
    for found, field, mark in zip(
        asked(piped, rows), told, fits["pressure_b1"].predict(coded), strict=True
    ):
        # Columns of the surface run faster than its rows, as in the field.
        assert np.abs(np.array(list(found["values"].values())) - field).max() < 2e-3 * spread
        assert found["said"] == [pytest.approx(mark)]


def test_what_is_left_out_of_colours_is_told(piped):
    (field,) = payload(piped, chosen(piped))["scene"]["fields"]
    assert field["left_out"] == 0.0
    assert field["low"] < field["high"]


def test_scene_data_is_small():
    """400 kB at most for the leg, its colours included."""
    solver, space = LegBandage(mesh="coarse"), bandage_space()
    fixed = {name: one.nominal for name, one in solver.inputs.items() if name not in space.names}
    content = make(space, surrogates=("linear",), sensitivity=False)
    content = replace(content, scene=geometry(solver.scene, space, fixed))
    scene = json.dumps(payload(content, chosen(content))["scene"]).encode()
    assert len(zlib.compress(scene)) * 4 / 3 + MOST_CHARACTERS < 400_000


def test_a_geometry_that_cannot_be_shown_is_said(study):
    content = replace(study(), scene="The geometry is not shown: it has no points.")
    html = report.build(content).html
    assert "The geometry is not shown: it has no points." in html
    assert "stills" not in html.split("</style>")[1]


def test_still_pictures_say_what_they_show(piped):
    html = report.build(piped).html
    assert html.count('alt="The geometry, coloured by pressure_map of quadratic, seen from: ') == 2
    assert "views: front and back" in html


def test_a_still_picture_hides_lines_behind_the_surface():
    """Of a ring around a pipe, the half towards the viewer is drawn, and the colours are kept."""
    scene = pipe(100.0)
    surface, triangles = np.asarray(scene.points), np.asarray(scene.triangles)
    tints = np.tile([200.0, 100.0, 50.0], (len(surface), 1))
    turn = np.linspace(0, 2 * np.pi, 2000)
    ring = np.column_stack([30 * np.cos(turn), 30 * np.sin(turn), np.full(2000, 50.0)])

    def dark(lines):
        pixels = picture(surface, triangles, tints, (0.0, 20.0), lines).astype(int)
        return ((pixels[..., :3].sum(axis=2) < 100) & (pixels[..., 3] == 255)).sum(), pixels

    (none, plain), (front, _) = dark(()), dark([ring])
    assert none == 0 and front > 100
    behind, before = ring[ring[:, 0] < -5], ring[ring[:, 0] > 5]
    assert dark([behind])[0] == 0
    assert 0.8 * front < dark([before])[0] <= front
    drawn = plain[plain[..., 3] > 0]
    assert np.abs(drawn[:, 0] - 2 * drawn[:, 1]).max() <= 2  # shades of one colour
