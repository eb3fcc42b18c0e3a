"""Exported C compiles without a warning and gives Python's numbers."""

from __future__ import annotations

import ctypes
import subprocess

import exported
import numpy as np
import pytest

from surrogate.export import c

pytestmark = exported.needs_compiler


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """All cases in one library, by the strictest compiler."""
    folder = tmp_path_factory.mktemp("c")
    files = [
        exported.write(folder / f"{name}.c", c.written(exported.case(name).description)).name
        for name in exported.CASES
    ]
    shared = ["-shared", "-fPIC", "-o", "all.so", *files, "-lm"]
    done = subprocess.run(
        [exported.COMPILER, *exported.STRICT, *shared], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == 0 and not done.stderr, done.stderr
    return ctypes.CDLL(str(folder / "all.so"))


def answers(function, shape):
    """What a function of the library says at all points."""
    places = exported.points()
    found = np.empty((len(places), *shape))
    pointer = ctypes.POINTER(ctypes.c_double)
    if not shape:
        function.restype = ctypes.c_double
        return np.array([function(row.ctypes.data_as(pointer)) for row in places])
    function.restype = None
    for row, y in zip(places, found, strict=True):
        function(row.ctypes.data_as(pointer), y.ctypes.data_as(pointer))
    return found


@pytest.mark.parametrize("name", exported.CASES)
def test_equal_to_python(library, name):
    """Random points, edges, training runs, and outside of the ranges."""
    case = exported.case(name)
    shape = case.fit.values.shape[1:]
    case.check(*(answers(getattr(library, f"{name}{end}"), shape) for end in ("", "_std")))


def test_coordinates_are_constant_arrays(library):
    """Numbers as doubles, names as strings."""
    heights = (ctypes.c_double * 3).in_dll(library, "gp_field_height")
    sides = (ctypes.c_char_p * 4).in_dll(library, "gp_field_side")
    assert list(heights) == [0.0, 0.5, 2.0]
    assert list(sides) == [b"l", b'm"', b"n\\", b"o"]


def test_the_head_tells_what_a_caller_needs():
    """Names, units, ranges, levels by number, study, surrogate, Q2, constants."""
    text = c.written(exported.case("gp").description).decode()
    head = text[: text.index("#include")]
    for words in (
        "surrogate 'gp' of the study 'of / * hard * / text",
        "in mmHg",
        "Q2 0.9",
        "x[0]  tension in N/mm, from 0.05 to 0.14",
        "x[1]  cloth, the number of its level: 0 p, 1 q, 2 r",
        "x[2]  c10 in kPa, normal(mean=5, std=1)",
        "x[4]  teeth, whole numbers 3 to 12",
        "Held by the study: mu = 0.6, yarn = wool.",
    ):
        assert words in head, words
    assert "malloc" not in text and "static double" in text


def test_not_a_number_stays_one(library):
    """Of a level, too."""
    library.linear.restype = ctypes.c_double
    for i in range(6):
        x = np.array([0.1, 1.0, 5.0, 2.0, 5.0, 10.0])
        x[i] = np.nan
        assert np.isnan(library.linear(x.ctypes.data_as(ctypes.POINTER(ctypes.c_double))))
