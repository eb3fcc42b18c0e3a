"""Every installed plug-in keeps its contract, and the checks notice those that do not."""

import inspect
import sys
from importlib.metadata import entry_points

import numpy as np
import pytest
import spaces
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.linear_model import LinearRegression

from surrogate.conformance import (
    check_augmentation,
    check_design,
    check_regressor,
    check_solver,
)
from surrogate.errors import DesignError, PluginError, SolverError
from surrogate.solver import Constraint, Input, Output, broken
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

#: What a plug-in needs in order to be built, by entry-point name.
SOLVER_OPTIONS = {
    "command": {
        "command": [sys.executable, "-c", "print('y =', {{ x }} ** 2)"],
        "inputs": {"x": {"unit": "mm", "nominal": 1.0, "range": [-2, 2]}},
        "outputs": {"y": {"unit": "mm^2", "regex": r"y = (\S+)"}},
    }
}
#: Solvers whose runs are too long for every test run; their own tests run them.
SLOW = {"leg_bandage", "leg_bandage_patient"}
DESIGN_OPTIONS = {
    "fractional_factorial": {"resolution": 3},
    "nested": {"runs": {"cheap": 20, "true": 12}},
    "supersaturated": {"runs": 6},
    "split_plot": {"whole_plots": "batch", "hard_to_change": ["length"]},
}
BATCHES = Space(
    (
        *(Parameter(name, uniform(0, 1)) for name in ("length", "width")),
        Parameter("batch", levels=("a", "b", "c", "d")),
    )
)
#: Where a design is not for the usual three parameters.
DESIGN_SPACES = {"supersaturated": spaces.cube(10), "split_plot": BATCHES}
#: Options and inputs of regressors that need some.
REGRESSOR_OPTIONS = {"mixed_model": ({"random": "batch"}, BATCHES)}


def plugins(group):
    """All entry points of a group, third-party ones included."""
    return [
        pytest.param(point, id=point.name)
        for point in sorted(entry_points(group=group), key=lambda point: point.name)
    ]


def needed(found, options):
    """Names of constructor arguments without a default that `options` does not give."""
    return [
        p.name
        for p in inspect.signature(found).parameters.values()
        if p.default is p.empty and p.kind is p.POSITIONAL_OR_KEYWORD and p.name not in options
    ]


@pytest.mark.parametrize("point", plugins("surrogate.solvers"))
def test_installed_solvers(point):
    """Each installed solver, with its default options."""
    found, options = point.load(), SOLVER_OPTIONS.get(point.name, {})
    if inspect.isclass(found) and needed(found, options):
        pytest.skip(f"needs options: {', '.join(needed(found, options))}")
    solver = found(**options) if inspect.isclass(found) else found
    check_solver(solver, runs=0 if point.name in SLOW else 8)


@pytest.mark.parametrize("point", plugins("surrogate.designs"))
def test_installed_designs(point, tmp_path):
    """Each installed design method, on spaces of every kind."""
    options = DESIGN_OPTIONS.get(point.name)
    if point.name == "csv":
        (tmp_path / "points.csv").write_text("length,width,height\n1,-3,0\n3,-1,2\n")
        options = {"path": str(tmp_path / "points.csv")}
    check_design(point.load(), options=options, space=DESIGN_SPACES.get(point.name))


@pytest.mark.parametrize("point", plugins("surrogate.augmentations"))
def test_installed_augmentations(point):
    """Each installed augmentation."""
    check_augmentation(point.load())


@pytest.mark.parametrize("point", plugins("surrogate.regressors"))
def test_installed_regressors(point):
    """Each installed regressor with its default arguments, where it can do without others."""
    options, space = REGRESSOR_OPTIONS.get(point.name, ({}, None))
    check_regressor(point.load()(**options), **({"space": space} if space else {}))


@pytest.mark.parametrize("group", ["solvers", "designs", "augmentations", "regressors"])
def test_there_are_plugins(group):
    """The tests above are not empty."""
    assert entry_points(group=f"surrogate.{group}")


class Spring:
    """Elongation of a spring."""

    version = "1"
    inputs = {
        "force": Input(unit="N", nominal=1.0, range=(0.0, 10.0)),
        "kind": Input(levels=("steel", "rubber"), nominal="steel"),
    }
    outputs = {
        "length": Output(unit="mm"),
        "curve": Output(unit="N", dims=("x",), coordinates={"x": np.arange(3.0)}),
    }

    def __call__(self, force, kind):
        if force > 9.9:
            raise SolverError("the spring broke")
        stiffness = {"steel": 2.0, "rubber": 1.0}[kind]
        return {"length": force / stiffness, "curve": force * np.arange(3.0)}


def test_a_good_solver_passes():
    """Also one that refuses some points with a sentence."""
    check_solver(Spring(), runs=12, impossible=[{"force": 9.95, "kind": "steel"}])


def broken_solver(**attributes):
    return type("Broken", (Spring,), {"__doc__": "Broken.", **attributes})()


def answering(change):
    def call(self, force, kind):
        answer = Spring()(force, kind)
        return change(answer, force, kind)

    return call


def unstable(answer, force, kind):
    return {**answer, "length": np.random.default_rng().random()}


def complain(answer, force, kind):
    if kind == "rubber":
        raise ValueError("boom")
    return answer


def silent(answer, force, kind):
    if kind == "rubber":
        raise SolverError("")
    return answer


@pytest.mark.parametrize(
    "attributes, said",
    [
        ({"__doc__": ""}, "has no docstring"),
        ({"version": None}, "has no `version`; give a text"),
        ({"inputs": None}, "has no `inputs`"),
        ({"outputs": {}}, "has no `outputs`"),
        ({"inputs": {"force": 3}}, "inputs\\['force'\\] is a int; make it a Input"),
        ({"inputs": {"the force": Input()}}, "a name has letters"),
        ({"inputs": {"force": Input(unit="Nn")}}, "pint does not know the unit 'Nn'"),
        ({"inputs": {"force": Input(range=(2.0, 1.0))}}, "upside down"),
        ({"inputs": {"force": Input(nominal=3.0, range=(0, 1))}}, "nominal 3.0 lies outside"),
        (
            {"inputs": {"kind": Input(nominal="steal", levels=("steel", "b"))}},
            "did you mean 'steel'",
        ),
        ({"outputs": {"a": Output(unit="??")}}, "does not know the unit"),
        ({"outputs": {"a": Output(dims=("x",))}}, "give coordinate values for each dimension"),
        (
            {"outputs": {"a": Output(dims=("x",), coordinates={"x": np.zeros(2)})}},
            "different values",
        ),
        ({"outputs": {"force": Output()}}, "'force' is both an input and an output"),
        (
            {"outputs": {"a": Output(dims=("kind",), coordinates={"kind": np.arange(2.0)})}},
            "dimension 'kind' is also an input",
        ),
        (
            {
                "outputs": {
                    n: Output(dims=("x",), coordinates={"x": np.arange(float(i + 1))})
                    for i, n in enumerate("ab")
                }
            },
            "other coordinates than in another output",
        ),
        ({"__call__": answering(lambda a, f, k: [1.0])}, "returned a list; return a mapping"),
        ({"__call__": answering(lambda a, f, k: {"length": 1.0})}, "return exactly these"),
        ({"__call__": answering(lambda a, f, k: {**a, "more": 1.0})}, "return exactly these"),
        (
            {"__call__": answering(lambda a, f, k: {**a, "length": "long"})},
            "is 'long'; return a float",
        ),
        (
            {"__call__": answering(lambda a, f, k: {**a, "curve": np.zeros(2)})},
            r"has shape \(2,\); its dims \['x'\] say \(3,\)",
        ),
        (
            {"__call__": answering(lambda a, f, k: {**a, "length": np.nan})},
            "not finite; raise SolverError with a sentence",
        ),
        ({"__call__": answering(unstable)}, "two calls with the same inputs differ"),
        ({"__call__": answering(complain)}, "raised ValueError: boom; raise SolverError with a"),
        ({"__call__": answering(silent)}, "raised SolverError without a message"),
        (
            {"inputs": {"force": Input(nominal=9.95), "kind": Spring.inputs["kind"]}},
            "the nominal point raised SolverError: the spring broke; choose nominal values",
        ),
    ],
)
def test_broken_solvers(attributes, said):
    """One broken thing, one sentence that names it and the cure."""
    with pytest.raises(PluginError, match=said):
        check_solver(broken_solver(**attributes), runs=12)


def test_solver_side_effects():
    """Declarations that change in a call, attributes that do not pickle, false refusals."""

    class Changing(Spring):
        """Changes its outputs."""

        def __call__(self, force, kind):
            self.outputs = {**self.outputs, "length": Output(unit="m")}
            return super().__call__(force, kind)

    with pytest.raises(PluginError, match="changed during a call"):
        check_solver(Changing(), picklable=False)
    solver = broken_solver()
    solver.hook = lambda: None
    with pytest.raises(PluginError, match="pickling raised"):
        check_solver(solver)
    with pytest.raises(PluginError, match="has an answer; raise SolverError"):
        check_solver(Spring(), impossible=[{"force": 1.0, "kind": "steel"}])


def test_solver_may_be_random_when_it_says_so():
    """`deterministic = False` allows two answers to one call."""
    check_solver(broken_solver(__call__=answering(unstable), deterministic=False), picklable=False)


def test_zero_runs_does_not_call():
    """Declarations of a solver that takes hours."""

    def never(self, **inputs):
        raise AssertionError("called")

    check_solver(broken_solver(__call__=never), runs=0, picklable=False)


def good_design(space, *, runs: int = 8, seed=None):
    """Random points."""
    return space.sample(runs, seed=seed)


def test_a_good_design_passes():
    """Random points from the space's law."""
    check_design(good_design)


def positional(space, runs=8, seed=None):
    """Options by position."""
    return space.sample(runs, seed=seed)


def no_seed(space, *, runs: int):
    """No seed."""
    return space.sample(runs, seed=0)


def global_state(space, *, runs: int, seed=None):
    """Global state."""
    np.random.seed(seed)  # noqa: NPY002 - what is tested
    return space.quantile(np.random.random((runs, space.size)))  # noqa: NPY002


def unseeded(space, *, runs: int, seed=None):
    """Forgets its seed."""
    return space.sample(runs)


def physical(space, *, runs: int, seed=None):
    """Not coded."""
    return 5.0 * space.sample(runs, seed=seed)


def one_dimensional(space, *, runs: int, seed=None):
    """One row."""
    return space.sample(runs, seed=seed)[0]


def between(space, *, runs: int, seed=None):
    """Ignores levels."""
    return np.full((runs, space.size), 0.1)


def at_ends(space, *, runs: int, seed=None):
    """Ignores missing ends."""
    return np.ones((runs, space.size))


def listing(space, *, runs: int, seed=None):
    """Lists."""
    return space.sample(runs, seed=seed).tolist()


def failing(space, *, runs: int, seed=None):
    """Fails on some."""
    return space.sample(runs, seed=seed) / (space.size == 3)


def refusing(space, *, runs: int, seed=None):
    """Refuses everything."""
    raise DesignError("no")


def untyped(space, *, runs, path, seed=None):
    """No types."""
    return space.sample(runs, seed=seed)


@pytest.mark.parametrize(
    "method, said",
    [
        (positional, "options runs, seed are not keyword-only"),
        (no_seed, "takes no `seed`"),
        (global_state, "uses NumPy's global random state"),
        (unseeded, "the same seed gave other points"),
        (physical, r"leaves \[-1, 1\]"),
        (one_dimensional, r"returned shape \(3,\)"),
        (between, "parameter side takes values between its levels"),
        (at_ends, "parameter load has no ends"),
        (listing, "returned list; return a NumPy array"),
        (refusing, "on three ranges raised DesignError: no"),
        (untyped, "option runs has no type(?s:.)*option path has no default"),
        (lambda *, runs: int, "has no docstring(?s:.)*takes no space"),
    ],
)
def test_broken_designs(method, said):
    """One broken thing, one sentence that names it and the cure."""
    with pytest.raises(PluginError, match=said):
        check_design(method)


def test_design_that_fails_on_some_spaces():
    """Anything but DesignError is reported with the space."""
    with np.errstate(divide="ignore", invalid="ignore"):
        with pytest.raises(PluginError, match="on seven ranges leaves"):
            check_design(failing)


def test_broken_augmentation():
    """It may not change the design that it grows."""

    def mirror(space, coded, *, seed=None):
        """Mirror in place."""
        coded *= -1.0
        return coded.copy()

    with pytest.raises(PluginError, match="changes the design that it is given"):
        check_augmentation(mirror)


class Line(RegressorMixin, BaseEstimator):
    """Least squares."""

    def __init__(self, scale=1.0, space=None):
        self.scale = scale
        self.space = space

    def fit(self, X, y):
        self.model_ = LinearRegression().fit(X, y)
        self.y_ = y.copy()
        return self

    def predict(self, X, return_std=False):
        mean = self.model_.predict(X)
        return (mean, np.ones(len(X))) if return_std else mean


def test_good_regressors_pass():
    """scikit-learn's own, and one with the optional parts."""
    check_regressor(Line())
    check_regressor(LinearRegression())


def broken_regressor(**methods):
    return type("Broken", (Line,), {"__doc__": "Broken.", **methods})()


def fit_in_place(self, X, y):
    Line.fit(self, X, y)
    y -= y.mean()
    return self


def fit_without_return(self, X, y):
    Line.fit(self, X, y)


def fit_randomly(self, X, y):
    Line.fit(self, X, y)
    self.model_.coef_ = self.model_.coef_ + np.random.default_rng().random(3)
    return self


def fit_and_keep_a_lambda(self, X, y):
    self.hook_ = lambda: None
    return Line.fit(self, X, y)


@pytest.mark.parametrize(
    "methods, said",
    [
        ({"fit": fit_in_place}, "fit changes its training data"),
        ({"fit": fit_without_return}, "end it with `return self`"),
        ({"fit": fit_randomly}, "a second fit to the same data predicts differently"),
        ({"fit": fit_and_keep_a_lambda}, "pickling raised"),
        ({"predict": lambda self, X: self.model_.predict(X)[:, None]}, r"shape \(25,\)"),
        ({"predict": lambda self, X: self.model_.predict(X) * np.nan}, "not finite"),
        (
            {"predict": lambda self, X: self.model_.predict(X - X.mean(axis=0))},
            "depend on which points are asked together",
        ),
        (
            {
                "predict": lambda self, X, return_std=False: (
                    (self.model_.predict(X), -np.ones(len(X)))
                    if return_std
                    else self.model_.predict(X)
                )
            },
            "is negative somewhere",
        ),
        (
            {
                "predict": lambda self, X, return_std=False: (
                    (self.model_.predict(X) + 1, np.ones(len(X)))
                    if return_std
                    else self.model_.predict(X)
                )
            },
            "another mean than predict",
        ),
        ({"leave_one_out": lambda self: np.zeros(3)}, "leave_one_out of 40 points"),
        ({"portable": lambda self: {"a": np.zeros(3)}}, "return plain dictionaries"),
        ({"sobol_indices": lambda self: Indices(np.array([0.5, 0.5, 1.5]))}, "leaves \\[0, 1\\]"),
        ({"sobol_indices": lambda self: Indices(np.zeros(2))}, "must have shape"),
        ({"__doc__": ""}, "has no docstring"),
        ({"predict": None}, "has no predict"),
        (
            {
                "__init__": lambda self, *, scale=1.0, space=None: self.__dict__.update(
                    scale=scale * 2, space=space
                )
            },
            "sklearn.base.clone raised",
        ),
    ],
)
def test_broken_regressors(methods, said):
    """One broken thing, one sentence that names it and the cure."""
    with pytest.raises(PluginError, match=said):
        check_regressor(broken_regressor(**methods))


class Indices:
    """First-order and total indices."""

    def __init__(self, values):
        self.first_order = self.total = values


SOFT = Constraint(("force", "kind"), lambda f, k: k == "steel" or f < 5, "rubber takes 5 N")


def test_a_solver_with_a_constraint_passes():
    """And `broken` counts the points that do not keep it."""
    solver = broken_solver(constraints=(SOFT,))
    check_solver(solver, picklable=False)
    points = [{"force": f, "kind": k} for f in (1.0, 4.0, 6.0, 9.0) for k in ("steel", "rubber")]
    assert broken(solver, points) == {"rubber takes 5 N": 2}
    assert broken(solver, points[:4]) == {} == broken(Spring(), points)


@pytest.mark.parametrize(
    "constraints, sentence",
    [
        ([SOFT], "not a tuple"),
        ((Constraint(("force",), lambda f: f < 5, ""),), "has no sentence"),
        ((Constraint(("froce",), lambda f: f < 5, "x"),), r"\['froce'\] are no inputs"),
        ((Constraint(("force",), lambda f: f > 5, "x"),), "nominal point breaks it"),
        ((Constraint(("force",), lambda f: f.boom, "x"),), "at the nominal point"),
    ],
)
def test_wrong_constraints(constraints, sentence):
    """Each mistake in a sentence."""
    with pytest.raises(PluginError, match=sentence):
        check_solver(broken_solver(constraints=constraints), runs=0)
