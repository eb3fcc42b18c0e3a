"""UM-Bridge: derivatives against exact ones, and every malformed request a sentence."""

import json

import numpy as np
import pytest

from surrogate.errors import SolverError
from surrogate.serving.protocol import PATHS, answer


class Quartic:
    """y = x0^4 + x0^2 x1, z = (x0 u0, x1 u0^3): two vectors in, two out."""

    name = "quartic"
    input_sizes = (2, 1)
    output_sizes = (1, 2)
    differentiable = True
    scales = (np.array([1.0, 2.0]), np.array([0.5]))

    def __call__(self, vectors):
        (x0, x1), (u0,) = vectors
        if x0 > 100:
            raise SolverError("x0 is too large")
        return [np.array([x0**4 + x0**2 * x1]), np.array([x0 * u0, x1 * u0**3])]


MODELS = {"quartic": Quartic()}
POINT = {"name": "quartic", "input": [[1.5, -0.7], [0.3]]}


def ask(path, **more):
    reply = answer(MODELS, path, {**POINT, **more})
    assert reply.status == 200, reply.body
    return reply.body


def test_what_the_model_is():
    assert answer(MODELS, "/Info", None).body == {"protocolVersion": 1.0, "models": ["quartic"]}
    assert ask("/InputSizes") == {"inputSizes": [2, 1]}
    assert ask("/OutputSizes") == {"outputSizes": [1, 2]}
    assert all(ask("/ModelInfo")["support"].values())


def test_evaluate():
    assert ask("/Evaluate")["output"] == [
        [1.5**4 - 1.5**2 * 0.7],
        pytest.approx([0.45, -0.7 * 0.027], rel=1e-15),
    ]


def test_derivatives_are_exact_to_ten_digits():
    """dy/dx = (4 x0^3 + 2 x0 x1, x0^2); dz/du = (x0, 3 x1 u0^2); d2y/dx2 by hand."""
    x0, x1, u0 = 1.5, -0.7, 0.3
    slope = np.array([4 * x0**3 + 2 * x0 * x1, x0**2])
    assert ask("/Gradient", outWrt=0, inWrt=0, sens=[2.0])["output"] == pytest.approx(
        2 * slope, rel=1e-10
    )
    assert ask("/ApplyJacobian", outWrt=0, inWrt=0, vec=[3.0, -1.0])["output"] == pytest.approx(
        [slope @ [3.0, -1.0]], rel=1e-10
    )
    assert ask("/ApplyJacobian", outWrt=1, inWrt=1, vec=[2.0])["output"] == pytest.approx(
        [2 * x0, 6 * x1 * u0**2], rel=1e-10
    )
    second = np.array([[12 * x0**2 + 2 * x1, 2 * x0], [2 * x0, 0.0]])
    found = ask("/ApplyHessian", outWrt=0, inWrt1=0, inWrt2=0, sens=[2.0], vec=[1.0, 0.5])
    assert found["output"] == pytest.approx(2 * second @ [1.0, 0.5], rel=1e-8)
    mixed = ask("/ApplyHessian", outWrt=1, inWrt1=0, inWrt2=1, sens=[1.0, 1.0], vec=[1.0])
    assert mixed["output"] == pytest.approx([1.0, 3 * u0**2], rel=1e-8)


def test_no_direction_no_change():
    assert ask("/ApplyJacobian", outWrt=1, inWrt=0, vec=[0.0, 0.0])["output"] == [0.0, 0.0]


@pytest.mark.parametrize(
    "path, body, kind, sentence",
    [
        ("/Nowhere", POINT, "NotFound", "there is no /Nowhere"),
        ("/Evaluate", None, "InvalidInput", "no JSON object"),
        ("/Evaluate", [], "InvalidInput", "no JSON object"),
        ("/Evaluate", {}, "InvalidInput", "has no 'name'"),
        ("/Evaluate", {"name": "quartic"}, "InvalidInput", "has no 'input'"),
        ("/Evaluate", POINT | {"name": "other"}, "ModelNotFound", "'other' is unknown"),
        ("/Evaluate", POINT | {"name": {}}, "ModelNotFound", "is unknown"),
        ("/Evaluate", POINT | {"input": [[1, 2]]}, "InvalidInput", "2 vectors are needed"),
        ("/Evaluate", POINT | {"input": [[1], [2]]}, "InvalidInput", "input 0: a list of 2"),
        ("/Evaluate", POINT | {"input": [["1", 2], [3]]}, "InvalidInput", "'1' is not a number"),
        ("/Evaluate", POINT | {"input": [[True, 2], [3]]}, "InvalidInput", "True is not a number"),
        ("/Evaluate", POINT | {"input": [[1e400, 2], [3]]}, "InvalidInput", "must be finite"),
        ("/Evaluate", POINT | {"input": [[10**400, 2], [3]]}, "InvalidInput", "too large"),
        ("/Evaluate", POINT | {"input": [[101, 2], [3]]}, "InvalidInput", "x0 is too large"),
        ("/Gradient", POINT | {"outWrt": 2}, "InvalidInput", "outWrt: 2 must be one of 0..1"),
        ("/Gradient", POINT | {"outWrt": "0"}, "InvalidInput", "must be one of"),
        ("/Gradient", POINT | {"outWrt": 0, "inWrt": 0}, "InvalidInput", "has no 'sens'"),
        (
            "/Gradient",
            POINT | {"outWrt": 0, "inWrt": 0, "sens": [1, 2]},
            "InvalidInput",
            "sens: a list of 1 numbers",
        ),
    ],
)
def test_a_malformed_request_is_a_sentence(path, body, kind, sentence):
    reply = answer(MODELS, path, body)
    assert reply.status in (400, 404) and json.dumps(reply.body)
    assert reply.body["error"]["type"] == kind and sentence in reply.body["error"]["message"]


def test_a_model_without_derivatives_says_so():
    class Rough(Quartic):
        differentiable = False

    models = {"rough": Rough()}
    info = answer(models, "/ModelInfo", {"name": "rough"}).body["support"]
    assert info == {
        "Evaluate": True,
        "Gradient": False,
        "ApplyJacobian": False,
        "ApplyHessian": False,
    }
    asked = POINT | {"name": "rough", "outWrt": 0, "inWrt": 0, "sens": [1.0]}
    reply = answer(models, "/Gradient", asked)
    assert reply.body["error"]["type"] == "UnsupportedFeature"


def test_a_model_that_breaks_is_an_error_of_the_server():
    class Broken(Quartic):
        def __call__(self, vectors):
            raise ZeroDivisionError("oh")

    reply = answer({"quartic": Broken()}, "/Evaluate", POINT)
    assert reply.status == 500 and "ZeroDivisionError: oh" in reply.body["error"]["message"]
    assert set(PATHS) >= {"/Info", "/Evaluate", "/Gradient", "/ApplyJacobian", "/ApplyHessian"}
