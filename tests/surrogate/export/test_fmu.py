"""The exported unit passes FMPy's validation and simulates with Python's numbers."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import exported
import numpy as np
import pytest

from surrogate.errors import PluginError, StudyError
from surrogate.export import fmu

fmpy = pytest.importorskip("fmpy", reason="no fmpy")
validation = pytest.importorskip("fmpy.validation", reason="no fmpy")
pytestmark = [
    exported.needs_compiler,
    pytest.mark.skipif(sys.platform not in ("linux", "darwin"), reason="no binaries of FMI 2.0"),
]
NAMES = ("linear", "gp_linear", "chaos_field")


@pytest.fixture(scope="module")
def units(tmp_path_factory):
    """A file of each case."""
    folder = tmp_path_factory.mktemp("fmu")
    return {
        name: exported.write(folder / f"{name}.fmu", fmu.written(exported.case(name).description))
        for name in NAMES
    }


@pytest.mark.parametrize("name", NAMES)
def test_valid(units, name):
    """No word against its description."""
    assert validation.validate_fmu(str(units[name])) == []


@pytest.mark.parametrize("name", NAMES)
def test_equal_to_python(units, name):
    """Points one after the other as inputs over time; levels and whole numbers are integers."""
    case, at = exported.case(name), exported.points()
    kinds = [(n, "<i4" if n in ("cloth", "teeth", "pipe") else "<f8") for n in exported.SPACE.names]
    whole = np.isin(np.arange(6), [1, 4, 5])
    at = np.where(whole, np.rint(at), at)
    unit = fmpy.read_model_description(str(units[name]))
    outputs = [one.name for one in unit.modelVariables if one.causality == "output"]
    folder = fmpy.extract(str(units[name]))
    instance = fmpy.instantiate_fmu(folder, unit)
    references = {one.name: one.valueReference for one in unit.modelVariables}
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    found = []
    for step, row in enumerate(at):
        for (given, kind), value in zip(kinds, row, strict=True):
            put = instance.setInteger if kind == "<i4" else instance.setReal
            put([references[given]], [int(value) if kind == "<i4" else value])
        instance.doStep(float(step), 1.0)
        found.append(instance.getReal([references[output] for output in outputs]))
    instance.terminate()
    instance.freeInstance()
    mean, std = np.split(np.array(found), 2, axis=1)
    shape = (-1, *case.fit.values.shape[1:])
    own_mean, own_std = case.fit.predict(exported.SPACE.encode(exported.named(at)), return_std=True)
    scale = case.fit.values.std()
    rounding = 2.0 * case.description.formula.rounding.reshape(own_mean.shape[1:])
    assert (np.abs(mean.reshape(shape) - own_mean) <= exported.MEAN * scale + rounding).all()
    np.testing.assert_allclose(std.reshape(shape), own_std, rtol=0, atol=exported.STD * scale)


def test_simulates_from_start_values(units):
    """As a tool that imports it does: nothing set but one input."""
    case = exported.case("linear")
    found = fmpy.simulate_fmu(str(units["linear"]), start_values={"teeth": 7}, stop_time=1.0)
    start = {"tension": 0.1, "cloth": "q", "c10": 5.0, "t": case.description.inputs[3].start}
    at = {key: [value] for key, value in {**start, "teeth": 7.0, "pipe": 10.0}.items()}
    unit = fmpy.read_model_description(str(units["linear"]))
    variables = {one.name: one for one in unit.modelVariables}
    assert float(variables["tension"].start) == 0.1 and int(variables["cloth"].start) == 1
    at["pipe"] = [float(variables["pipe"].start)]
    expected = case.fit.predict(exported.SPACE.encode(at))[0]
    np.testing.assert_allclose(found["linear"], expected, rtol=1e-12)


def test_units_ranges_and_sources(units):
    """N/mm in base units, ends as minimum and maximum, C files of the unit."""
    with zipfile.ZipFile(units["linear"]) as archive:
        names = set(archive.namelist())
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    assert {"sources/linear.c", "sources/fmu.c", "sources/fmi2.h"} < names
    assert any(name.startswith("binaries/") for name in names)
    base = root.find("UnitDefinitions/Unit[@name='N/mm']/BaseUnit")
    assert base.attrib == {"kg": "1", "s": "-2", "factor": "1000.0", "offset": "0.0"}
    real = root.find("ModelVariables/ScalarVariable[@name='tension']/Real")
    assert real.attrib == {"start": "0.1", "min": "0.05", "max": "0.14", "unit": "N/mm"}
    level = root.find("ModelVariables/ScalarVariable[@name='cloth']/Integer")
    assert level.attrib == {"start": "1", "min": "0", "max": "2"}


def test_sources_compile_without_a_warning(units, tmp_path):
    """By the strictest compiler, as another machine would do it."""
    with zipfile.ZipFile(units["chaos_field"]) as archive:
        archive.extractall(tmp_path)
    command = [exported.COMPILER, *exported.STRICT, "-fPIC", "-shared", "fmu.c", "chaos_field.c"]
    done = subprocess.run(
        [*command, "-lm"], cwd=tmp_path / "sources", capture_output=True, text=True
    )
    assert done.returncode == 0 and not done.stderr, done.stderr


def test_equal_surrogates_are_equal_units(units):
    """The identifier follows from the content, so it is the same tomorrow."""
    case = exported.case("linear")
    assert fmu._archive({"a": b"1"}) == fmu._archive({"a": b"1"})
    first, again = (
        fmpy.read_model_description(str(path)).guid
        for path in (
            units["linear"],
            exported.write(units["linear"].with_name("again.fmu"), fmu.written(case.description)),
        )
    )
    assert first == again


def test_no_compiler_is_a_sentence(monkeypatch):
    """And a compiler that fails says why."""
    monkeypatch.setenv("CC", "no_such_compiler")
    with pytest.raises(PluginError, match=r"no C compiler \(no_such_compiler\).*--format c"):
        fmu.written(exported.case("linear").description)
    monkeypatch.setenv("CC", "false")
    with pytest.raises(PluginError, match="failed: 1; set CC"):
        fmu.written(exported.case("linear").description)


def test_two_variables_of_one_name_are_refused():
    """An input that is called as the output is."""
    from dataclasses import replace

    told = replace(exported.case("linear").description, name="t")
    with pytest.raises(StudyError, match="'t' is an input and the output"):
        fmu.written(told)
