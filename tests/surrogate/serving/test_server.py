"""The server over loopback: umbridge's own client, and requests that mean harm."""

import json
import socket
import threading
from contextlib import closing
from http.client import HTTPConnection

import numpy as np
import pytest

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.polynomial import Quadratic
from surrogate.serving import server as serving
from surrogate.serving.models import SolverModel, SurrogateModel
from surrogate.solver import Output
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space((Parameter("a", uniform(0.0, 4.0)), Parameter("kind", levels=("x", "y"))))


def exact(a, kind):
    return 1 + a + a**2 + (2 * a if kind == "y" else 0.0)


@pytest.fixture(scope="module")
def port():
    coded = latin_hypercube(SPACE, runs=24, seed=1)
    columns = SPACE.decode(coded)
    values = np.array([exact(a, k) for a, k in zip(columns["a"], columns["kind"], strict=True)])
    field = values[:, None] * np.array([1.0, -1.0, 0.5])
    fits = {
        name: fit(SPACE, coded, y, Quadratic(), surrogate="q", output=name)
        for name, y in {"y": values, "field": field}.items()
    }
    models = {
        "surrogate": SurrogateModel("surrogate", SPACE, fits),
        "solver": SolverModel("solver", SPACE, {"y": Output()}, lambda at: {"y": exact(**at)}),
    }
    with serving.Server(models, port=0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server.server_address[1]
        server.shutdown()


def test_umbridge_talks_to_a_surrogate(port):
    """The unmodified client; the derivative of 1 + a + a^2 + 2 a at a = 3 is 9."""
    umbridge = pytest.importorskip("umbridge")
    url = f"http://127.0.0.1:{port}"
    assert umbridge.supported_models(url) == ["surrogate", "solver"]
    model = umbridge.HTTPModel(url, "surrogate")
    assert model.get_input_sizes() == [2] and model.get_output_sizes() == [1, 3]
    value, field = model([[3.0, 1]])
    assert value == pytest.approx([19.0], rel=1e-9)
    assert field == pytest.approx([19.0, -19.0, 9.5], rel=1e-9)
    assert model.supports_gradient() and model.supports_apply_hessian()
    slope = model.apply_jacobian(0, 0, [[3.0, 1]], [1.0, 0.0])
    assert slope == pytest.approx([9.0], rel=1e-8)
    assert model.gradient(0, 0, [[3.0, 1]], [1.0]) == pytest.approx([9.0, 0.0], rel=1e-8)
    solver = umbridge.HTTPModel(url, "solver")
    assert solver([[3.0, 0]]) == [[13.0]] and not solver.supports_gradient()
    with pytest.raises(Exception, match="2 is not the number of a level"):
        solver([[3.0, 2]])


def post(port, content, headers=None, path="/Evaluate"):
    with closing(HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.request("POST", path, content, headers or {})
        reply = connection.getresponse()
        return reply.status, json.loads(reply.read())


@pytest.mark.parametrize(
    "content, headers, status, sentence",
    [
        (b"{", {}, 400, "no JSON"),
        (b"[" * 100_000, {}, 400, "no JSON"),
        (b"\xff\xfe", {}, 400, "no JSON"),
        (b"", {"Content-Length": "99999999999"}, 413, "larger than"),
        (b"", {"Content-Length": "9" * 5000}, 413, "larger than"),
        (b"", {"Content-Length": "-1"}, 411, "does not tell its length"),
        (b"", {"Content-Length": "\u00b2".encode("latin-1")}, 411, "does not tell its length"),
    ],
)
def test_harmful_requests_are_refused(port, content, headers, status, sentence):
    found, body = post(port, content, headers)
    assert found == status and sentence in body["error"]["message"]
    assert post(port, json.dumps({"name": "solver", "input": [[1.0, 0]]}))[0] == 200


def test_a_dripping_client_is_given_up(port, monkeypatch):
    """Half a body and then silence: it ends, and meanwhile others are served."""
    monkeypatch.setattr(serving, "PATIENCE", 0.2)
    monkeypatch.setattr(serving._Handler, "timeout", 0.3)
    with closing(socket.create_connection(("127.0.0.1", port), timeout=10)) as slow:
        slow.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\n{")
        assert post(port, json.dumps({"name": "solver", "input": [[1.0, 0]]}))[0] == 200
        assert b"did not arrive within" in slow.recv(1000) or not slow.recv(1)


def test_a_port_that_is_taken_is_a_sentence(port):
    with pytest.raises(StudyError, match=f"port {port} of 127.0.0.1 cannot be had"):
        serving.Server({}, port=port)
