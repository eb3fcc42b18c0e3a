"""What the conformity suite of UM-Bridge 1.0 asks of a server, over HTTP, of both its kinds.

Surrogates have derivatives, a solver has none; both refuse what is wrong in the protocol's
own words. The suite itself: UM-Bridge/umbridge, testing/protocol_conformity_1.0.
"""

import json
import threading
from contextlib import closing
from http.client import HTTPConnection

import numpy as np
import pytest

from surrogate.serving.server import Server

DERIVATIVES = {
    "/Gradient": {"outWrt": 0, "inWrt": 0, "sens": [0.0, 0.0]},
    "/ApplyJacobian": {"outWrt": 0, "inWrt": 0, "vec": [0.5, 0.5, 0.5]},
    "/ApplyHessian": {
        "outWrt": 0,
        "inWrt1": 0,
        "inWrt2": 0,
        "sens": [0.0, 0.0],
        "vec": [0.5, 0.5, 0.5],
    },
}
LENGTHS = {"/Gradient": 3, "/ApplyJacobian": 2, "/ApplyHessian": 3}
INPUT = [[0.5, 0.5, 0.5], [0.5]]


class Model:
    """Two vectors in, of three and one; two out, of two and one."""

    input_sizes, output_sizes = (3, 1), (2, 1)
    scales = (np.ones(3), np.ones(1))

    def __init__(self, name, differentiable):
        self.name, self.differentiable = name, differentiable

    def __call__(self, vectors):
        x, (u,) = vectors
        return [np.array([x @ x * u, x.sum()]), np.array([u**3])]


@pytest.fixture(scope="module")
def port():
    models = {"surrogate": Model("surrogate", True), "solver": Model("solver", False)}
    with Server(models, 0) as made:
        threading.Thread(target=made.serve_forever, daemon=True).start()
        yield made.server_address[1]
        made.shutdown()


@pytest.fixture
def ask(port):
    def asked(path, **body):
        with closing(HTTPConnection("127.0.0.1", port, timeout=30)) as connection:
            content = json.dumps({"config": {}, **body}, indent=4) if body else None
            connection.request("POST" if body else "GET", path, content)
            reply = connection.getresponse()
            return reply.status, json.loads(reply.read())

    return asked


def is_refused(reply, kind):
    status, body = reply
    error = body["error"]
    return status == 400 and error.keys() == {"type", "message"} and error["type"] == kind


def test_info_lists_the_models(ask):
    assert ask("/Info") == (200, {"protocolVersion": 1.0, "models": ["surrogate", "solver"]})


@pytest.mark.parametrize("name", ["surrogate", "solver"])
def test_outputs_have_the_sizes_that_are_told(ask, name):
    status, body = ask("/Evaluate", name=name, input=INPUT)
    assert status == 200 and body.keys() == {"output"}
    assert [len(vector) for vector in body["output"]] == ask("/OutputSizes", name=name)[1][
        "outputSizes"
    ]
    assert all(type(value) is float for vector in body["output"] for value in vector)


@pytest.mark.parametrize("path", ["/Evaluate", *DERIVATIVES])
def test_unknown_models_are_not_found(ask, path):
    assert is_refused(ask(path, name="wrong_model_name"), "ModelNotFound")


@pytest.mark.parametrize("path", DERIVATIVES)
def test_derivatives_that_are_not_offered_are_unsupported(ask, path):
    """Whatever else the request holds, or lacks."""
    assert not ask("/ModelInfo", name="solver")[1]["support"][path[1:]]
    assert is_refused(ask(path, name="solver"), "UnsupportedFeature")
    assert is_refused(
        ask(path, name="solver", input=INPUT, **DERIVATIVES[path]), "UnsupportedFeature"
    )


@pytest.mark.parametrize("path", DERIVATIVES)
def test_derivatives_have_the_length_of_what_they_are_of(ask, path):
    assert ask("/ModelInfo", name="surrogate")[1]["support"][path[1:]]
    status, body = ask(path, name="surrogate", input=INPUT, **DERIVATIVES[path])
    assert status == 200 and body.keys() == {"output"} and len(body["output"]) == LENGTHS[path]


@pytest.mark.parametrize("path", ["/Evaluate", *DERIVATIVES])
def test_inputs_of_wrong_length_are_invalid(ask, path):
    longer = [[*vector, 0.5] for vector in INPUT]
    words = {"name": "surrogate", **DERIVATIVES.get(path, {})}
    for wrong in (longer, INPUT[:1], []):
        assert is_refused(ask(path, **words, input=wrong), "InvalidInput")


@pytest.mark.parametrize(
    ("path", "word"), [(path, word) for path, words in DERIVATIVES.items() for word in words]
)
def test_vectors_and_indices_out_of_range_are_invalid(ask, path, word):
    given = DERIVATIVES[path][word]
    wrong = {word: 2 if isinstance(given, int) else [*given, 0.5]}
    words = {"name": "surrogate", "input": INPUT, **DERIVATIVES[path], **wrong}
    assert is_refused(ask(path, **words), "InvalidInput")
