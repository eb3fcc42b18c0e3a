"""The exported graph runs in ONNX Runtime and gives Python's numbers."""

from __future__ import annotations

import sys

import exported
import numpy as np
import pytest
from scipy import special

from surrogate.errors import PluginError, StudyError
from surrogate.export import onnx as exporting
from surrogate.export.erf import erf
from surrogate.export.graph import Graph, Tensor

onnx = pytest.importorskip("onnx", reason="no onnx")
runtime = pytest.importorskip("onnxruntime", reason="no onnxruntime")


def session(content):
    """A session of one thread."""
    options = runtime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return runtime.InferenceSession(content, options, providers=["CPUExecutionProvider"])


@pytest.mark.parametrize("name", exported.CASES)
def test_equal_to_python(name):
    """Random points, edges, training runs, and outside of the ranges."""
    case = exported.case(name)
    own = session(exporting.written(case.description))
    case.check(*own.run(["mean", "std"], {"x": exported.points()}))


def test_what_the_file_states():
    """Opset, float64, shapes, and where it comes from; equal surrogates are equal files."""
    case = exported.case("quadratic_field")
    content = exporting.written(case.description)
    model = onnx.load_from_string(content)
    assert [(one.domain, one.version) for one in model.opset_import] == [("", 17)]
    own = session(content)
    assert [(one.name, one.shape, one.type) for one in own.get_inputs()] == [
        ("x", ["batch", 6], "tensor(double)")
    ]
    assert [(one.name, one.shape) for one in own.get_outputs()] == [
        ("mean", ["batch", 3, 4]),
        ("std", ["batch", 3, 4]),
    ]
    told = {one.key: one.value for one in model.metadata_props}
    assert told["surrogate"] == "quadratic" and told["x[0]"].startswith("tension in N/mm")
    assert exporting.written(case.description) == content


def test_erf():
    """Against scipy, in the tails too."""
    graph = Graph()
    graph.output("y", erf(Tensor(graph, "x")), ())
    content = graph.model("erf", 1, "", {}).SerializeToString()
    z = np.concatenate([np.linspace(-10, 10, 2001), np.linspace(-0.5, 0.5, 1001)])
    (found,) = session(content).run(["y"], {"x": z[:, None]})
    np.testing.assert_allclose(found.ravel(), special.erf(z), rtol=5e-16, atol=0)


def test_the_package_may_be_missing(monkeypatch):
    """Then the sentence says how to get it."""
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(PluginError, match=r"pip install 'surrogate-studies\[export\]'"):
        exporting.written(exported.case("linear").description)


def test_two_gigabytes_are_the_limit(monkeypatch):
    """Of protocol buffers; other formats have none."""
    monkeypatch.setattr(exporting, "LARGEST", 2**20)
    with pytest.raises(StudyError, match="use --format c or json"):
        exporting.written(exported.case("gp").description)
