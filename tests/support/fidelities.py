"""A function of two inputs at two costs, and a cheap one that does not see the second input."""

import numpy as np

from surrogate.solver import Input, Output


class Toy:
    """mesh: "fine" is the truth, "coarse" is near it."""

    version = "1"
    inputs = {
        "a": Input(nominal=0.5, range=(0, 1)),
        "b": Input(nominal=0.5, range=(0, 1)),
        "c": Input(nominal=1.0, range=(0, 2)),
    }
    outputs = {"y": Output(unit="mm")}

    def __init__(self, mesh: str = "fine"):
        self.mesh = mesh

    def __call__(self, a, b, c):
        low = np.sin(6 * a) + b**2 + c
        return {"y": low if self.mesh == "coarse" else 1.5 * low + 0.3 * a * b}


class Blind:
    """The coarse one without b."""

    version = "1"
    inputs = {name: one for name, one in Toy.inputs.items() if name != "b"}
    outputs = Toy.outputs

    def __call__(self, a, c):
        return {"y": np.sin(6 * a) + c}


class Inches(Blind):
    """The same in another unit, and without y's sister."""

    outputs = {"y": Output(unit="inch")}
