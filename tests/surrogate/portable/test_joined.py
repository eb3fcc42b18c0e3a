"""ES modules joined into one script, and numbers packed as text."""

import base64

import numpy as np
import pytest

from surrogate.portable.joined import JAVASCRIPT, modules, script
from surrogate.portable.packing import Packer


def test_modules_stand_behind_what_they_need(tmp_path):
    """A diamond of imports: each module once, the entry last, no import or export left."""
    (tmp_path / "a.js").write_text("export const a = 1;\n")
    (tmp_path / "b.js").write_text('import { a } from "./a.js";\nexport const b = a + 1;\n')
    (tmp_path / "c.js").write_text('import { a } from "./a.js";\nexport const c = a + 2;\n')
    entry = tmp_path / "d.js"
    entry.write_text(
        'import { b } from "./b.js";\nimport { c } from "./c.js";\n// A sum.\nconst d = b + c;\n'
    )
    assert [path.name for path in modules(entry)] == ["a.js", "b.js", "c.js", "d.js"]
    body = "const a = 1;\nconst b = a + 1;\nconst c = a + 2;\nconst d = b + c;\n"
    assert script(entry) == f'"use strict";\n(() => {{\n{body}}})();\n'


def test_a_name_declared_twice_is_refused(tmp_path):
    """Joined modules share a scope."""
    (tmp_path / "a.js").write_text("export function same() {}\n")
    entry = tmp_path / "b.js"
    entry.write_text('import { same } from "./a.js";\nconst other = same;\nfunction same() {}\n')
    with pytest.raises(ValueError, match=r"a\.js and b\.js both declare 'same'"):
        script(entry)


def test_the_evaluators_join():
    """The evaluators have one scope, and know no page."""
    text = script(JAVASCRIPT / "surrogate.js")
    assert "import" not in text and "document." not in text and "window" not in text


def test_equal_numbers_are_written_once():
    """Points of two processes of the same runs; what is short stays as it is."""
    points = np.arange(8.0).reshape(4, 2).tolist()
    packer = Packer()
    packed = packer.packed({"a": {"points": points}, "b": {"points": points}, "c": [1.5, None]})
    assert packed == {
        "a": {"points": {"shared": 0}},
        "b": {"points": {"shared": 0}},
        "c": [1.5, None],
    }
    (only,) = packer.shared
    numbers = np.frombuffer(base64.b64decode(only["float64"]), "<f8")
    assert numbers.reshape(only["shape"]).tolist() == points
