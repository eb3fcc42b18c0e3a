"""Plug-ins: an installed third-party package is found without an edit; bad ones get sentences."""

import os
import subprocess
import sys
from inspect import Parameter
from pathlib import Path

import numpy as np
import pytest
from typing_extensions import get_type_hints

from surrogate.errors import PluginError, StudyError
from surrogate.sensitivity.independence import spoilt
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter as Uncertain
from surrogate.space.space import Space
from surrogate.stages.plugin import parameters_of
from surrogate.study import plugins
from surrogate.study.options import option_mistakes
from surrogate.study.reading.methods import GIVEN_TO_SENSITIVITY as GIVEN
from surrogate.study.study import Study

NUMERIC = Space(tuple(Uncertain(name, uniform(0.0, 1.0)) for name in ("length", "width")))
REPOSITORY = str(Path(__file__).parents[3])

MODULE = '''
import numpy as np
from sklearn.neighbors import KNeighborsRegressor
from surrogate.solver import Input, Output

class Spring:
    """Force of a spring."""
    version = "1"
    inputs = {"k": Input(unit="N/mm", range=(1, 10)), "x": Input(unit="mm", range=(0, 5))}
    outputs = {"force": Output(unit="N")}
    def __call__(self, k, x):
        return {"force": k * x}

def corners_and_middle(space, *, seed=None, extra: int = 1):
    """Two corners and the middle."""
    d = space.size
    return np.vstack([-np.ones(d), np.ones(d), *[np.full(d, 0.1 * i) for i in range(extra)]])

class Nearest(KNeighborsRegressor):
    """The nearest run."""
    def __init__(self):
        super().__init__(n_neighbors=1)

def broken():
    """Never loads: see the entry point."""
'''

ENTRY_POINTS = """\
[surrogate.solvers]
spring = springs:Spring
lost = springs:not_there
[surrogate.designs]
corners_and_middle = springs:corners_and_middle
[surrogate.regressors]
nearest = springs:Nearest
"""

STUDY = """\
study: springs
solver: spring
parameters: {k: [1, 10], x: {range: [0, 0.5], unit: cm}}
designs: {train: {method: corners_and_middle, extra: 4}}
surrogates: {near: nearest, wide: {method: linear}}
execution: {workers: 1}
"""


@pytest.fixture
def installed(tmp_path):
    """A folder that looks like an installed third-party package, and its environment."""
    info = tmp_path / "springs-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: springs\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(ENTRY_POINTS)
    (tmp_path / "springs.py").write_text(MODULE)
    (tmp_path / "springs.yaml").write_text(STUDY)
    return tmp_path, {**os.environ, "PYTHONPATH": str(tmp_path)}


def command(installed, *words):
    place, environment = installed
    return subprocess.run(
        [sys.executable, "-m", "surrogate", *words],
        cwd=place,
        text=True,
        env=environment,
        capture_output=True,
        timeout=300,
    )


def test_a_third_party_package_needs_no_edit_here(installed):
    """Its solver, design and regressor are listed, checked and run by their names."""
    listed = command(installed, "list").stdout
    assert "Force of a spring." in listed and "Two corners and the middle." in listed
    done = command(installed, "run", "springs.yaml")
    assert done.returncode == 0, done.stderr
    assert (installed[0] / "results/springs/report.html").exists()


def test_a_plugin_that_does_not_load_is_an_error(installed):
    """A named plug-in whose object is missing: a sentence, status 2; `list` still works."""
    (installed[0] / "springs.yaml").write_text(STUDY.replace("solver: spring", "solver: lost"))
    done = command(installed, "check", "springs.yaml")
    assert done.returncode == 2 and "'lost' does not load" in done.stderr
    assert "does not load" in command(installed, "list").stdout


@pytest.mark.parametrize(
    "name, words",
    [
        ("no_module_of_this_name:Thing", "does not load: ModuleNotFoundError"),
        ("json:NoSuchClass", "does not load: AttributeError"),
        ("bohrehole", "did you mean 'borehole'"),
    ],
)
def test_names_that_lead_nowhere(name, words):
    """Unknown names and paths are PluginErrors that say what is known."""
    with pytest.raises(PluginError, match=words):
        plugins.load(plugins.SOLVERS, name)


def raises(space, *, seed=None):
    raise KeyError(f"no idea of {space.size}")


def gives_nothing(space, *, seed=None):
    return None


def gives_too_many_columns(space, *, seed=None):
    return np.zeros((9, space.size + 1))


def gives_gaps(space, *, seed=None):
    return np.full((9, space.size), np.nan)


not_callable = 3


class Unbuildable:
    def __init__(self):
        raise RuntimeError("no licence")

    def fit(self, X, y):
        return self

    def predict(self, X):
        return X[:, 0]


@pytest.mark.parametrize(
    "name, words",
    [
        (
            "raises",
            r"test_plugins:raises' fails: KeyError: 'no idea of 3' \(test_plugins.py, line",
        ),
        ("gives_nothing", r"gave an array of shape \(\); it must give coded points \(run, 3\)"),
        ("gives_too_many_columns", r"gave an array of shape \(9, 4\)"),
        ("gives_gaps", "all finite"),
        ("not_callable", "is not a method"),
    ],
)
def test_a_design_of_a_stranger_that_goes_wrong_is_a_mistake_of_the_study(name, words):
    """It stands among the other mistakes, with its place."""
    part = {"method": f"{__name__}:{name}"}
    data = {
        "study": "strange",
        "solver": "ishigami",
        "parameters": {name: [-1, 1] for name in ("X1", "X2", "X3")},
        "designs": {
            "train": part,
            "test": {"method": "latin_hypercube", "runs": 9, "augment": [part]},
        },
        "surrogates": {"unbuildable": f"{__name__}:Unbuildable"},
    }
    with pytest.raises(StudyError, match=words) as caught:
        Study.from_mapping(data)
    train, test, unbuildable = caught.value.mistakes
    assert train.startswith("designs.train") and test.startswith("designs.test")
    assert unbuildable.startswith("surrogates.unbuildable") and "no licence" in unbuildable


class Sketch:
    """Looks like a solver and says nothing that a study could use."""

    version = "1"
    inputs = {"X1": (-1, 1)}
    outputs = ["y"]

    def __call__(self, X1):
        return {"y": X1}


def test_a_solver_that_describes_itself_in_other_words_is_a_mistake_of_the_study():
    with pytest.raises(StudyError) as caught:
        Study.from_mapping(
            {
                "study": "strange",
                "solver": f"{__name__}:Sketch",
                "parameters": {"X1": [-1, 1]},
                "designs": {"train": "sobol"},
            }
        )
    assert [s.partition("its ")[2] for s in caught.value.mistakes if "not a solver" in s] == [
        "inputs must map names to surrogate.solver.Input",
        "outputs must map names to surrogate.solver.Output",
    ]


def test_options_are_checked_against_the_signature():
    """Names and annotated types of options; `given` ones are not the user's."""

    def method(space, *, runs: int, seed=None):
        return space, runs, seed

    def problems(**options):
        return [one.sentence for one in option_mistakes(method, options, ("space",))]

    assert problems(runs=3) == []
    assert problems(rnus=3) == [
        "option 'rnus' is unknown; did you mean 'runs'? Allowed: runs, seed"
    ]
    assert problems(space=1, runs=1)[0].startswith("option 'space' is unknown")
    assert "'three' is not accepted" in problems(runs="three")[0]
    assert problems() == ["option 'runs' is needed"]


TOUCH = {"args": ["touch", "touched"]}


@pytest.mark.parametrize(
    "part",
    [
        {"solver": {"name": "subprocess:run", "options": TOUCH}},
        {"solver": {"name": "subprocess:Popen", "options": TOUCH}},
        {"solver": {"name": "os:mkdir", "options": {"path": "touched"}}},
        {"designs": {"train": {"method": "subprocess:run", **TOUCH}}},
        {"designs": {"train": {"method": "os:mkdir", "path": "touched"}}},
        {"designs": {"train": {"method": "sobol", "runs": 8, "augment": [
            {"method": "subprocess:run", **TOUCH}]}}},
        {"surrogates": {"a": {"method": "subprocess:Popen", "options": TOUCH}}},
        {"surrogates": {"a": {"method": "subprocess:run", "options": TOUCH}}},
        {"validation": {"cases": "x.csv", "models": {
            "m": {"name": "subprocess:run", "options": TOUCH}}}},
    ],
)  # fmt: skip
def test_what_is_no_plugin_is_not_called_with_options(part, tmp_path, monkeypatch):
    """Reading a study calls nothing that does not look like what it is named for."""
    monkeypatch.chdir(tmp_path)
    study = {
        "study": "harm",
        "solver": "ishigami",
        "parameters": {name: [-1, 1] for name in ("X1", "X2", "X3")},
        "designs": {"train": {"method": "sobol", "runs": 8}},
    }
    with pytest.raises(StudyError, match="is not called: an? (solver|design|augm|regr)"):
        Study.from_mapping({**study, **part})
    assert not list(tmp_path.iterdir())


OWN = """
from surrogate.solver import Input, Output
from {package}factor import FACTOR

class M:
    version = "1"
    inputs = {{"x": Input(nominal=1.0)}}
    outputs = {{"y": Output()}}
    def __call__(self, x):
        return {{"y": FACTOR * x}}
"""


def own_modules(folder, factor, package="solvers"):
    """A package `solvers` and a module `factor` beside a study."""
    (folder / "solvers").mkdir(parents=True)
    (folder / "solvers/__init__.py").write_text("")
    (folder / "solvers/mine.py").write_text(OWN.format(package=""))
    (folder / "factor.py").write_text(f"FACTOR = {factor}\n")
    (folder / "own.yaml").write_text(
        'study: own\nsolver: "solvers.mine:M"\nparameters: {x: [0, 1]}\n'
        "designs: {train: {method: sobol, runs: 4}}\n"
    )
    return folder / "own.yaml"


def test_two_studies_with_modules_of_one_name(tmp_path):
    """Each gets the modules beside it, in one process, one after the other and again."""
    paths = [own_modules(tmp_path / name, factor) for name, factor in (("a", 2.0), ("b", 3.0))]
    studies = [Study.from_yaml(path) for path in (*paths, *paths)]
    assert [study.spec.solver(x=1.0)["y"] for study in studies] == [2.0, 3.0, 2.0, 3.0]


@pytest.mark.parametrize(
    "name",
    [
        "solvers.leg_bandage.plugin:LegBandage",
        "solvers.textbook:Borehole",
        "solvers.laplace:Laplace",
    ],
)
def test_the_old_name_of_the_built_in_solvers_still_finds_them(name, tmp_path, monkeypatch):
    """`solvers.x:Y` is the user's where she has one, and the built-in one elsewhere."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [one for one in sys.path if one not in ("", REPOSITORY)])
    path = own_modules(tmp_path / "own", 2.0)
    assert Study.from_yaml(path).spec.solver(x=1.0) == {"y": 2.0}
    found = plugins.load(plugins.SOLVERS, name, tmp_path / "own")
    assert found.__module__.startswith("surrogate_solvers.")
    with pytest.raises(PluginError, match="No module named 'solvers.nothing'"):
        plugins.load(plugins.SOLVERS, "solvers.nothing:X", tmp_path / "own")


def test_a_folder_called_solvers_beside_the_study(tmp_path):
    """Its solver and a built-in one, run by the command in that folder."""
    own_modules(tmp_path, 2.0)
    (tmp_path / "built_in.yaml").write_text(
        "study: built_in\nsolver: borehole\nparameters: {rw: [0.05, 0.15]}\n"
        "designs: {train: {method: sobol, runs: 4}}\n"
    )
    for study in ("own", "built_in"):
        done = command((tmp_path, os.environ), "run", f"{study}.yaml")
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("group", plugins.NOUNS)
def test_every_option_of_a_shipped_plug_in_has_a_type_that_the_study_file_is_checked_against(group):
    """Annotations that cannot be read would let any value through, unsaid."""
    for name in plugins.available(group):
        found = plugins.load(group, name)
        types = get_type_hints(found.__init__ if isinstance(found, type) else found)
        untyped = [
            option
            for option, taken in parameters_of(found).items()
            if option not in types and taken.kind is not Parameter.VAR_KEYWORD
        ]
        assert not untyped, name


@pytest.mark.parametrize("seed", [0, 3, [1, 2]])
def test_sensitivity_methods_take_the_seeds_that_numpy_takes(seed):
    for name in plugins.available(plugins.SENSITIVITY):
        assert not option_mistakes(plugins.load(plugins.SENSITIVITY, name), {"seed": seed}, GIVEN)


def test_a_seed_that_is_no_number_is_refused_before_any_run():
    (mistake,) = {
        mistake.sentence
        for name in plugins.available(plugins.SENSITIVITY)
        for mistake in option_mistakes(
            plugins.load(plugins.SENSITIVITY, name), {"seed": "abc"}, GIVEN
        )[:1]
    }
    assert "option 'seed'" in mistake and "'abc'" in mistake


def test_methods_that_correlated_parameters_would_spoil_say_so():
    correlated = Space(NUMERIC.parameters, ((1.0, 0.5), (0.5, 1.0)))
    marked = [
        name
        for name in plugins.available(plugins.SENSITIVITY)
        if spoilt(plugins.load(plugins.SENSITIVITY, name), correlated)
    ]
    assert marked == ["dgsm", "morris", "pawn", "quantile", "rbd_fast", "sobol", "target"]
    assert not any(spoilt(plugins.load(plugins.SENSITIVITY, name), NUMERIC) for name in marked)
