"""`surrogate serve`: the surrogates and the solver of a study, over loopback."""

import json
import signal
import subprocess
import sys
import threading
from contextlib import closing
from http.client import HTTPConnection

import pytest

from surrogate import Study
from surrogate.cli.serving import server
from surrogate.errors import ResultsError, StudyError

STUDY = """\
study: served
solver: {name: "served_solver:Moody"}
parameters: {x: [0, 10], kind: {levels: [soft, stiff]}}
designs: {train: {method: full_factorial, levels: {x: 4}}}
surrogates: {quadratic: {method: quadratic}}
execution: {timeout: 1 s}
"""
SOLVER = '''\
import os, time
from surrogate.errors import SolverError
from surrogate.solver import Input, Output

class Moody:
    """Square of x; refuses, dies or sleeps beyond the study's range."""
    version = "1"
    inputs = {"x": Input(unit="mm"), "kind": Input(levels=("soft", "stiff")),
              "more": Input(nominal=2.0)}
    outputs = {"y": Output(unit="mm")}
    def __call__(self, x, kind, more):
        if x == 20: raise SolverError("too far")
        if x == 21: os._exit(3)
        if x == 22: time.sleep(60)
        return {"y": x**2 * more * (2 if kind == "stiff" else 1)}
'''


@pytest.fixture
def study(tmp_path):
    (tmp_path / "served_solver.py").write_text(SOLVER)
    (tmp_path / "served.yaml").write_text(STUDY)
    return Study.from_yaml(tmp_path / "served.yaml")


def ask(port, vector):
    with closing(HTTPConnection("127.0.0.1", port, timeout=30)) as connection:
        connection.request("POST", "/Evaluate", json.dumps({"name": "served", "input": [vector]}))
        return json.loads(connection.getresponse().read())


def serving(made):
    threading.Thread(target=made.serve_forever, daemon=True).start()
    return made.server_address[1]


def test_the_surrogate_of_a_study(study, tmp_path):
    with pytest.raises(ResultsError, match="no finished runs"), server(study, tmp_path / "r"):
        pass
    study.run(results=tmp_path / "r", workers=1)
    with server(study, tmp_path / "r", port=0) as made:
        port = serving(made)
        found = ask(port, [3.0, 0])["output"][0]
        made.shutdown()
    exact = study.fit(study.stored(tmp_path / "r"))["quadratic"]["y"]
    assert found == exact.predict(study.space.encode({"x": [3.0], "kind": ["soft"]})).tolist()


def test_the_solver_of_a_study_survives_what_it_does(study, tmp_path):
    """A refusal, a crash and a call over the time limit cost their own call only."""
    with server(study, tmp_path, solver=True, port=0, workers=1) as made:
        port = serving(made)
        assert ask(port, [3.0, 1]) == {"output": [[36.0]]}
        for x, sentence in ((20, "too far"), (21, "ended its process"), (22, "time limit")):
            assert sentence in ask(port, [x, 1])["error"]["message"]
            assert ask(port, [3.0, 0]) == {"output": [[18.0]]}
        made.shutdown()


def test_either_surrogate_or_solver(study, tmp_path):
    with (
        pytest.raises(StudyError, match="not both"),
        server(study, tmp_path, surrogate="quadratic", solver=True),
    ):
        pass


def test_ctrl_c_ends_the_command(study, tmp_path):
    """Exit status 130, and no process of the solver stays."""
    words = [sys.executable, "-m", "surrogate", "serve", "served.yaml", "--solver", "--port", "0"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, cwd=tmp_path, **pipes) as process:
        line = process.stdout.readline()
        port = int(line.split(";")[0].rsplit(":", 1)[1])
        assert line.startswith("served: http://127.0.0.1:") and ask(port, [1.0, 0])["output"]
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 130 and "Traceback" not in process.stderr.read()
