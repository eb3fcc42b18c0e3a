"""A UM-Bridge model as a solver: against a server of our own, and servers that misbehave."""

import json
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import numpy as np
import pytest

from surrogate import Study
from surrogate.conformance import check_solver
from surrogate.errors import SolverError, StudyError
from surrogate.serving.server import Server
from surrogate_solvers.umbridge import client as client_module
from surrogate_solvers.umbridge.solver import UMBridge


class Beam:
    """Two vectors in, a number and a field out."""

    name = "beam"
    input_sizes = (2, 1)
    output_sizes = (1, 3)
    differentiable = False
    scales = ()

    def __call__(self, vectors):
        (load, length), (kind,) = vectors
        if load > 90:
            raise SolverError("the beam breaks")
        tip = load * length**3 * (1.0 + kind)
        return [np.array([tip]), tip * np.array([0.0, 0.5, 1.0])]


OPTIONS = {
    "model": "beam",
    "inputs": [
        {"load": {"unit": "N", "range": [0, 100]}, "length": {"unit": "m", "nominal": 2.0}},
        {"kind": {"levels": ["soft", "stiff"], "nominal": "soft"}},
    ],
    "outputs": [{"tip": {"unit": "mm"}}, {"shape": {"unit": "mm", "dims": {"x": [0, 1, 2]}}}],
    "timeout": "10 s",
}


@pytest.fixture(scope="module")
def url():
    with Server({"beam": Beam()}, port=0, parallel=4) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()


def test_vectors_become_names_and_units(url):
    solver = UMBridge(url, **OPTIONS)
    found = solver(load=3.0, length=2.0, kind="stiff")
    assert found["tip"] == 48.0 and found["shape"].tolist() == [0.0, 24.0, 48.0]
    assert solver.inputs["load"].unit == "N" and solver.outputs["shape"].shape == (3,)
    check_solver(solver)


def test_an_answer_without_a_value_is_a_failed_run(url):
    with pytest.raises(SolverError, match="InvalidInput: the beam breaks"):
        UMBridge(url, **OPTIONS)(load=95.0, length=2.0, kind="soft")


def test_the_address_is_no_part_of_a_runs_identity(url):
    one, other = UMBridge(url, **OPTIONS), UMBridge("http://elsewhere:1", **OPTIONS)
    assert one.identity_options == other.identity_options and one.version == other.version


@pytest.mark.parametrize(
    "change, sentence",
    [
        ({"model": "plate"}, "has no model 'plate'; it has beam"),
        ({"inputs": {"load": {}}}, r"the study declares vectors of \[1\] numbers; the model has"),
        ({"outputs": {"tip": {}}}, r"declares vectors of \[1\] numbers; the model has \[1, 3\]"),
    ],
)
def test_a_model_of_another_shape_is_told(url, change, sentence):
    with pytest.raises(SolverError, match=sentence):
        UMBridge(url, **OPTIONS | change)(load=1.0, length=1.0, kind="soft")


@pytest.mark.parametrize(
    "change, sentence",
    [
        ({"url": "localhost:4242"}, "is no address; write http"),
        ({"inputs": {"load": {"unti": "N"}}}, "inputs.0.load.unti: extra inputs"),
        ({"outputs": []}, "must be one or more names"),
        ({"inputs": [{"a": {}}, {"a": {}}]}, "must be one or more names that all differ"),
        ({"timeout": "soon"}, "'soon' is not a time"),
    ],
)
def test_options_that_do_not_fit_are_sentences(change, sentence):
    with pytest.raises(StudyError, match=sentence):
        UMBridge(**{"url": "http://localhost:1", **OPTIONS, **change})


class Flaky(BaseHTTPRequestHandler):
    """Breaks at the first request and answers the second."""

    asked = 0

    def do_GET(self):
        Flaky.asked += 1
        body = json.dumps({"protocolVersion": 1.0, "models": ["beam"]}).encode()
        self.send_response(503 if Flaky.asked == 1 else 200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *args):
        pass


def test_a_server_that_breaks_is_asked_again(monkeypatch):
    monkeypatch.setattr(client_module, "PAUSE", 0.0)
    with HTTPServer(("127.0.0.1", 0), Flaky) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        url = f"http://127.0.0.1:{server.server_address[1]}"
        assert client_module.Client(url, "beam", retries=1).models() == ["beam"]
        assert Flaky.asked == 2
        server.shutdown()


def test_a_server_that_is_away_is_no_answer_of_the_model(monkeypatch):
    """Not a `SolverError`: such a run is tried again by the study."""
    monkeypatch.setattr(client_module, "PAUSE", 0.0)
    solver = UMBridge("http://127.0.0.1:9", **OPTIONS)
    with pytest.raises(client_module.Unreachable, match="cannot be reached"):
        solver(load=1.0, length=1.0, kind="soft")


def test_a_study_runs_on_a_server(url, tmp_path):
    study = Study.from_mapping(
        {
            "study": "bridge",
            "solver": {"name": "umbridge", "options": {"url": url, **OPTIONS}},
            "parameters": {"load": [1, 9], "length": {"range": [50, 200], "unit": "cm"}},
            "outputs": ["tip"],
            "designs": {"train": {"method": "full_factorial", "levels": 2}},
        }
    )
    runs = study.run(workers=2, results=tmp_path / "bridge")
    assert runs["tip"].values == pytest.approx(runs["load"].values * runs["length"].values ** 3)
