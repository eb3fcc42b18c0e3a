"""The exported module runs in Node and gives Python's numbers."""

from __future__ import annotations

import json
import subprocess

import exported
import node
import numpy as np
import pytest

from surrogate.export import javascript

pytestmark = node.needed
RUN = """
import { readFileSync } from "node:fs";
const { names, points, objects } = JSON.parse(readFileSync(0, "utf8"));
const found = {};
for (const name of names) {
  const own = await import(`./${name}.mjs`);
  found[name] = [points.map((x) => own[name](x)), points.map((x) => own[`${name}_std`](x)),
    objects.map((x) => own[name](x)), own.INPUTS, own.COORDINATES ?? null];
}
process.stdout.write(JSON.stringify(found));
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What all modules say, in one process."""
    folder = tmp_path_factory.mktemp("javascript")
    for name in exported.CASES:
        content = javascript.written(exported.case(name).description)
        exported.write(folder / f"{name}.mjs", content)
    exported.write(folder / "run.mjs", RUN.encode())
    columns = exported.named(exported.points()[:5])
    objects = [
        {name: np.asarray(column)[k].item() for name, column in columns.items()} for k in range(5)
    ]
    given = {
        "names": exported.CASES,
        "points": exported.points().tolist(),
        "objects": objects,
    }
    return node.answered(folder / "run.mjs", given)


@pytest.mark.parametrize("name", exported.CASES)
def test_equal_to_python(answers, name):
    """Random points, edges, training runs, and outside of the ranges."""
    case = exported.case(name)
    shape = (-1, *case.fit.values.shape[1:])
    mean, std, *_ = answers[name]
    case.check(*(np.array(found, dtype=float).reshape(shape) for found in (mean, std)))


def test_objects_by_names(answers):
    """An object with names of levels is the array with their numbers."""
    mean, _, objects, inputs, _ = answers["gp"]
    assert objects == mean[:5] and inputs == list(exported.SPACE.names)
    assert answers["gp_field"][4] == {"height": [0, 0.5, 2], "side": ["l", 'm"', "n\\", "o"]}


def test_mistakes_are_told(tmp_path):
    """A level that is unknown, an input that lacks, an array that is too short."""
    exported.write(tmp_path / "m.mjs", javascript.written(exported.case("linear").description))
    calls = ["[0.1, 'z', 5, 2, 5, 10]", "{tension: 0.1}", "[1, 2]"]
    text = 'import { linear } from "./m.mjs";\nconst said = [];\n' + "".join(
        f"try {{ linear({call}); }} catch (error) {{ said.push(error.message); }}\n"
        for call in calls
    )
    exported.write(tmp_path / "run.mjs", f"{text}console.log(JSON.stringify(said));".encode())
    done = subprocess.run(
        ["node", "run.mjs"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    level, lacking, short = json.loads(done.stdout)
    assert level == "cloth: z must be one of p, q, r"
    assert lacking == "cloth: undefined must be one of p, q, r"
    assert short.startswith("2 values; give tension, cloth")
