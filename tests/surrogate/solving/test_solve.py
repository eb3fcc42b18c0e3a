"""The search for inputs against answers that are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize, stats

from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Quadratic
from surrogate.solving.goals import Desire, Objective, Target
from surrogate.solving.outlook import Outlook, correlation
from surrogate.solving.problem import Problem
from surrogate.solving.promise import Verified
from surrogate.solving.search import Choice
from surrogate.solving.solve import solve
from surrogate.space.constraint_text import parse
from surrogate.space.discrete import integers
from surrogate.space.distributions import distribution
from surrogate.space.space import Parameter, Space


def box(*names, low=-1.0, high=1.0):
    return Space(tuple(Parameter(n, distribution("uniform", range=(low, high))) for n in names))


def noisy(space, function, runs=60, scatter=0.0, seed=1):
    coded = space.sample(runs, seed=seed)
    columns = space.decode(coded)
    noise = scatter * np.random.default_rng(seed).standard_normal(runs)
    return coded, function(**columns) + noise


def quadratic(space, function, output="y", **given):
    coded, values = noisy(space, function, **given)
    return fit(space, coded, values, Quadratic(), surrogate="quadratic", output=output)


def test_the_optimum_of_a_quadratic_is_its_stationary_point():
    space = box("a", "b", "c")

    def bowl(a, b, c):
        return (a - 0.3) ** 2 + 2 * (b + 0.2) ** 2 + (c - 0.1) ** 2 + 0.5 * (a - 0.3) * (b + 0.2)

    found = solve(
        Problem("low", (Objective("y"),), free=space.names), space, {"y": quadratic(space, bowl)}
    )
    best = found.candidates[0].inputs
    assert [best[n] for n in "abc"] == pytest.approx([0.3, -0.2, 0.1], abs=2e-3)
    assert len(found.candidates) == 1  # there is one optimum, so there is one answer


def test_an_optimum_under_a_limit_is_that_of_slsqp():
    space = box("a", "b")
    fits = {
        "mass": quadratic(space, lambda a, b: 3 + a + 2 * b + 0.5 * a**2, "mass"),
        "stress": quadratic(space, lambda a, b: 5 - 2 * a - b + a * b, "stress"),
    }
    limit = parse("stress <= 4", {"stress": ""})
    problem = Problem("light", (Objective("mass"),), (limit,), space.names)
    best = solve(problem, space, fits).candidates[0]
    exact = optimize.minimize(
        lambda x: 3 + x[0] + 2 * x[1] + 0.5 * x[0] ** 2,
        [0.0, 0.0],
        bounds=[(-1, 1)] * 2,
        constraints={"type": "ineq", "fun": lambda x: 4 - (5 - 2 * x[0] - x[1] + x[0] * x[1])},
        method="SLSQP",
    )
    assert best.predicted["mass"].value == pytest.approx(exact.fun, abs=5e-3)
    assert best.probability >= 0.9


def test_the_probability_of_a_target_is_that_of_student_s_t():
    """A line with noise: at its candidate the solver's next value follows the known law."""
    space = box("a")
    coded, values = noisy(space, lambda a: 10 + 3 * a, runs=30, scatter=0.5)
    fitted = fit(space, coded, values, Quadratic(), surrogate="quadratic", output="y")
    problem = Problem("ten", (Target("y", 10.0, 9.5, 10.5),), free=("a",))
    best = solve(problem, space, {"y": fitted}).candidates[0]
    mean, std = fitted.predict(space.encode({"a": [best.inputs["a"]]}), return_std=True)
    law = stats.t(30 - 3, loc=mean[0], scale=std[0])
    assert best.probability == pytest.approx(law.cdf(10.5) - law.cdf(9.5), abs=0.003)
    assert best.predicted["y"].low == pytest.approx(law.ppf(0.025), abs=0.02)


def test_uncertain_inputs_enter_the_probability_by_their_law():
    """y = a + u, u normal: the chance to lie in a band about 0 is that of the normal law."""
    normal = Parameter("u", distribution("normal", mean=0.0, std=0.3))
    space = Space((box("a").parameters[0], normal))
    coded = space.sample(60, seed=2)
    columns = space.decode(coded)
    fitted = fit(space, coded, columns["a"] + columns["u"], GaussianProcess(), output="y")
    problem = Problem("zero", (Target("y", 0.0, -0.4, 0.4),), free=("a",), uncertain=("u",))
    best = solve(problem, space, {"y": fitted}).candidates[0]
    assert best.inputs["a"] == pytest.approx(0.0, abs=0.05)
    assert best.probability == pytest.approx(2 * stats.norm.cdf(0.4 / 0.3) - 1, abs=0.02)


def test_with_a_probability_the_value_that_is_kept_counts():
    """Mean falls with a, spread grows with it: the surest low value lies between."""
    normal = Parameter("u", distribution("normal", mean=0.0, std=1.0))
    space = Space((box("a").parameters[0], normal))
    coded = space.sample(100, seed=2)
    columns = space.decode(coded)
    y = -columns["a"] + (1 + columns["a"]) ** 2 * columns["u"]
    fitted = fit(space, coded, y, GaussianProcess(starts=1), output="y")
    problem = Problem("low", (Objective("y"),), free=("a",), uncertain=("u",), probability=0.9)
    best = solve(problem, space, {"y": fitted}).candidates[0]
    z = stats.norm.ppf(0.9)  # -a + (1 + a)^2 z is least at a = 1 / (2 z) - 1
    assert best.inputs["a"] == pytest.approx(1 / (2 * z) - 1, abs=0.03)
    assert best.promised["y"] == pytest.approx(1 - 1 / (4 * z), abs=0.05)
    free = solve(
        Problem("low", (Objective("y"),), free=("a",), uncertain=("u",)), space, {"y": fitted}
    )
    assert free.candidates[0].inputs["a"] > 0.9


def test_levels_integers_and_constraints_are_kept():
    space = Space(
        (
            Parameter("fabric", levels=("soft", "stiff", "wool")),
            Parameter("teeth", integers((1.0, 8.0))),
            box("a").parameters[0],
        ),
        constraints=(parse("teeth + 2*a <= 6", {"teeth": "", "a": ""}),),
    )
    coded = space.sample(90, seed=3)
    x = space.decode(coded)
    y = x["teeth"] + x["a"] + 2.0 * (x["fabric"] == "stiff")
    fitted = fit(space, coded, y, Quadratic(), output="y")
    best = solve(Problem("high", (Objective("y", -1),), free=space.names), space, {"y": fitted})
    found = best.candidates[0].inputs
    # teeth 8 would need a <= -1: 8 - 1 + 2; teeth 7 and a = -0.5 give 8.5
    assert found["fabric"] == "stiff"
    assert (found["teeth"], found["a"]) == pytest.approx((8, -1.0), abs=0.02)
    held = Problem(
        "high", (Objective("y", -1),), free=("a",), held={"teeth": 8.0, "fabric": "wool"}
    )
    with pytest.raises(StudyError, match="no values of the free inputs keep"):
        solve(
            held,
            Space(space.parameters, constraints=(parse("teeth <= 7", {"teeth": ""}),)),
            {"y": fitted},
        )


def test_the_pareto_front_of_two_parabolas_is_the_line_between_their_ends():
    """Schaffer (1985): x^2 and (x - 1)^2 trade off for x from 0 to 1, b rests at 0."""
    space = box("x", "b", low=-2.0, high=2.0)
    fits = {
        "f": quadratic(space, lambda x, b: x**2 + b**2, "f"),
        "g": quadratic(space, lambda x, b: (x - 1) ** 2 + b**2, "g"),
    }
    found = solve(Problem("both", (Objective("f"), Objective("g")), free=space.names), space, fits)
    x = np.array([one.inputs["x"] for one in found.candidates])
    assert len(x) > 10
    assert all(abs(one.inputs["b"]) < 0.02 for one in found.candidates)
    assert np.all(np.diff(x) > 0)  # ordered by the first objective
    assert (x.min(), x.max()) == pytest.approx((0.0, 1.0), abs=0.02)
    assert np.diff(x).max() < 0.2


def test_desirability_finds_the_compromise():
    """d1 = (x + 1) / 2 and d2 = (1 - x) / 2: their geometric mean is largest at 0."""
    space = box("x")
    fits = {
        "y": quadratic(space, lambda x: x, "y"),
        "z": quadratic(space, lambda x: x + 0 * x, "z"),
    }
    goals = (Desire("y", "maximise", -1.0, 1.0), Desire("z", "minimise", -1.0, 1.0))
    best = solve(Problem("both", goals, free=("x",)), space, fits).candidates[0]
    assert best.inputs["x"] == pytest.approx(0.0, abs=0.01)
    assert best.desirability == pytest.approx(0.5, abs=1e-4)


def test_candidates_stay_among_the_rows_of_a_table():
    """Rows on a diagonal: the corner that they leave empty is no answer."""
    space = box("a", "b")
    rng = np.random.default_rng(5)
    a = rng.uniform(-1, 1, 80)
    coded = np.column_stack([a, np.clip(a + 0.1 * rng.standard_normal(80), -1, 1)])
    fitted = fit(space, coded, coded[:, 0] - coded[:, 1], Quadratic(), output="y")
    problem = Problem("high", (Objective("y", -1),), free=space.names)
    inside = solve(problem, space, {"y": fitted}, among=True).candidates[0].inputs
    corner = solve(problem, space, {"y": fitted}).candidates[0].inputs
    assert corner["a"] - corner["b"] == pytest.approx(2.0, abs=0.01)
    assert inside["a"] - inside["b"] < 0.8


def test_errors_of_outputs_at_one_point_are_correlated_as_those_left_out():
    space = box("a")
    rng = np.random.default_rng(0)
    coded = space.sample(400, seed=1)
    shared, own = rng.standard_normal((2, 400))
    y, z = shared, 0.8 * shared + 0.6 * own
    fits = [fit(space, coded, v, Quadratic(), output=n) for n, v in (("y", y), ("z", z))]
    assert correlation(fits)[0, 1] == pytest.approx(0.8, abs=0.05)
    drawn = Outlook(space, {"y": fits[0], "z": fits[1]}, (), 1, 4096, 0)._standardised
    assert np.corrcoef(drawn["y"][0], drawn["z"][0])[0, 1] == pytest.approx(0.8, abs=0.06)


def test_a_field_is_refused():
    space = box("a")
    coded = space.sample(20, seed=1)
    fitted = fit(space, coded, coded * np.ones(3), Quadratic(), output="y")
    with pytest.raises(StudyError, match="'y' is a field"):
        solve(Problem("low", (Objective("y"),), free=("a",)), space, {"y": fitted})


def test_the_pool_fills_what_may_be_chosen():
    space = box("a", "b")
    pool = Choice(space, (0,), np.array([0.0, 0.25])).pool(64, seed=0)
    assert np.all(pool[:, 1] == 0.25)
    assert np.diff(np.sort(pool[:, 0])).max() < 0.1


def test_the_answer_says_what_counts_as_hit_where_nobody_did():
    space = box("a")
    fitted = quadratic(space, lambda a: 10 * a)
    found = solve(Problem("five", (Target("y", 5.0),), free=("a",)), space, {"y": fitted})
    half = 0.05 * np.ptp(fitted.values)
    assert found.goal == f"y = 5; y counts as hit from {5 - half:.4g} to {5 + half:.4g}"
    told = Problem("five", (Target("y", 5.0, 4.0, 6.0),), free=("a",))
    assert solve(told, space, {"y": fitted}).goal == "y from 4 to 6"


def test_what_the_solver_said_is_told_beside_the_promises():
    space = box("a")
    problem = Problem("five", (Target("y", 5.0, 4.0, 6.0),), free=("a",))
    found = solve(problem, space, {"y": quadratic(space, lambda a: 10 * a)})
    assert found.tested == ""

    def beside(*verified):
        rows = [replace(found.candidates[0], probability=0.9, verified=one) for one in verified]
        return replace(found, candidates=tuple(rows)).tested

    assert beside(Verified({"y": (5.1, 7.0)}, 1), Verified({"y": (4.2,)}, 1)) == (
        "The solver was run at 3 points: 2 met the goal; the probabilities promise 2.7."
    )
    assert beside(Verified({"y": ()}, 0, 2)) == "2 of the solver's runs at the candidates failed."
    assert beside(Verified({"y": (5.0,)}, 1, 1)).endswith(
        "promise 0.9. 1 of the solver's runs at the candidates failed."
    )
