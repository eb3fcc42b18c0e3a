"""The exported Python file needs NumPy alone and gives Python's numbers."""

from __future__ import annotations

import re
import subprocess
import sys

import exported
import numpy as np
import pytest

from surrogate.export import python


def loaded(name):
    """What the file of a case defines."""
    space = {}
    exec(compile(python.written(exported.case(name).description), name, "exec"), space)
    return space


@pytest.mark.parametrize("name", exported.CASES)
def test_equal_to_python(name):
    """Random points, edges, training runs, and outside of the ranges."""
    case, file = exported.case(name), loaded(name)
    at = exported.points()
    case.check(file[name](at), file[f"{name}_std"](at))


@pytest.mark.parametrize("name", ["quadratic", "gp_field"])
def test_points_are_given_as_one_likes(name):
    """Keywords with names of levels, arrays that broadcast, one point, no point, more axes."""
    gp, at = loaded(name)[name], exported.points()[:6]
    whole = gp(at)
    np.testing.assert_allclose(gp(**exported.named(at)), whole, rtol=1e-9)
    assert np.shape(gp(at[0])) == whole.shape[1:]
    np.testing.assert_allclose(gp(at.reshape(2, 3, 6)), whole.reshape(2, 3, *whole.shape[1:]))
    assert gp(np.empty((0, 6))).shape == (0, *whole.shape[1:])
    one = {key: column[0] for key, column in exported.named(at).items()}
    many = gp(**one | {"tension": at[:, 0]})
    assert many.shape == whole.shape
    np.testing.assert_allclose(many[0], whole[0], rtol=1e-9)


def test_mistakes_are_told():
    """Names that lack or are unknown, a wrong number of columns, an unknown level."""
    gp = loaded("linear")["linear"]
    named = exported.named(exported.points()[:1])
    with pytest.raises(TypeError, match="tension: missing or unknown"):
        gp(**{key: value for key, value in named.items() if key != "tension"})
    with pytest.raises(TypeError, match="shape \\(1, 5\\); the last must be 6"):
        gp(exported.points()[:1, :5])
    with pytest.raises(ValueError, match="cloth: level 'z' is unknown; allowed: p, q, r"):
        gp(**named | {"cloth": "z"})
    with pytest.raises(TypeError, match="not both"):
        gp(exported.points()[:1], **named)


def test_numpy_is_all_it_imports(tmp_path):
    """In a fresh interpreter."""
    exported.write(tmp_path / "gp.py", python.written(exported.case("gp").description))
    words = "import sys; from gp import gp; print(*{n.split('.')[0] for n in sys.modules})"
    done = subprocess.run(
        [sys.executable, "-c", words], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert "numpy" in done.stdout and not re.search(r"surrogate\b|scipy|sklearn", done.stdout)
