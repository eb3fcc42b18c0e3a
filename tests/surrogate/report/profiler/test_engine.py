"""What the profiler works out in the browser, against Python, theory and scipy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import node
import numpy as np
import pytest
from made_up import make
from scipy import optimize, stats

from surrogate.fitting.extrapolation import extrapolates
from surrogate.report.profiler.chosen import chosen, notes
from surrogate.report.profiler.payload import payload
from surrogate.space.constraint_text import parse
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

pytestmark = node.needed
ENGINE = Path(__file__).parents[3] / "support" / "engine.mjs"
DRAWS = 100_000

LAWS = Space(
    (
        Parameter("flat", uniform(1.0, 3.0)),
        Parameter("cut", distribution("normal", mean=5.0, std=1.0, range=(-5.0, 8.0))),
        Parameter("bent", distribution("beta", a=2.0, b=5.0, range=(0.0, 4.0))),
        Parameter("free", distribution("lognormal", mean=2.0, std=0.4)),
        Parameter("teeth", integers((3, 9), "triangular", mode=4.0)),
        Parameter("pipe", listed([10.0, 12.0, 20.0])),
        Parameter("cloth", levels=("p", "q", "r")),
    )
)


def content_of(space, **options):
    return make(space, sensitivity=False, **{"surrogates": ("quadratic",), "test": 0, **options})


def ask(content, *questions):
    """The engine's answers about a study at its starting point, unless a question says more."""
    data = payload(content, chosen(content))
    start = {
        "values": [parameter["start"] for parameter in data["parameters"]],
        "places": [0] * len(data["outputs"]),
        "held": [False] * len(data["parameters"]),
    }
    asked = [{**start, **question} for question in questions]
    return node.answered(ENGINE, {"data": data, "questions": asked})


def draws(content, **more):
    limits = [[None, None]] * len(chosen(content))
    (found,) = ask(content, {"kind": "draw", "draws": DRAWS, "seed": 1, "limits": limits, **more})
    return found


def close_to(found, mean, variance, values):
    """Within four standard errors; that of a variance from the fourth moment of `values`."""
    deviation = np.sqrt(variance)
    assert abs(found["mean"] - mean) <= 4.0 * deviation / np.sqrt(DRAWS)
    fourth = ((values - values.mean()) ** 4).mean()
    assert abs(found["deviation"] ** 2 - variance) <= 4.0 * np.sqrt((fourth - variance**2) / DRAWS)


def test_draws_have_the_moments_of_closed_forms():
    """Uniform, truncated, beta, unbounded, integer, listed and named inputs of a quadratic."""
    content = content_of(LAWS, train=90)
    fit = chosen(content)[0].fit
    exact = fit.estimator.sobol_indices()
    (found,) = draws(content)
    assert found["n"] == DRAWS
    values = fit.predict(LAWS.sample(200_000, seed=3))
    close_to(found, exact.mean, exact.variance, values)
    for p, quantile in zip((0.05, 0.5, 0.95), found["quantiles"], strict=True):
        below = (values < quantile).mean()  # of another 200 000 points
        assert abs(below - p) <= 4.0 * np.sqrt(p * (1.0 - p) * (1.0 / DRAWS + 1.0 / 200_000))


def test_correlated_uniform_inputs():
    """A plane in inputs joined by a copula: their correlations are 6 / pi arcsin(c / 2)."""
    copula = ((1.0, 0.8, 0.0), (0.8, 1.0, -0.3), (0.0, -0.3, 1.0))
    space = Space(tuple(Parameter(name, uniform(0, 1)) for name in "abc"), copula)
    content = content_of(space, train=40, surrogates=("linear",))
    fit = chosen(content)[0].fit
    mean, *slopes = fit.estimator.coef_
    correlations = 6.0 / np.pi * np.arcsin(np.array(copula) / 2.0)
    variance = slopes @ correlations @ slopes / 3.0
    (found,) = draws(content)
    close_to(found, mean, variance, fit.predict(space.sample(200_000, seed=3)))


def test_correlated_inputs_of_other_laws():
    """A copula over truncated, integer and named inputs, against Python's own draws."""
    copula = np.eye(7)
    copula[0, 1] = copula[1, 0] = copula[2, 4] = copula[4, 2] = 0.7
    space = Space(LAWS.parameters, tuple(map(tuple, copula.tolist())))
    content = content_of(space, train=90)
    values = chosen(content)[0].fit.predict(space.sample(300_000, seed=3))
    (found,) = draws(content)
    close_to(found, values.mean(), values.var(), values)


def test_held_inputs_stay():
    """The variance of what is left, and a share within limits."""
    content = content_of(LAWS, train=90, surrogates=("linear",))
    fit = chosen(content)[0].fit
    point = LAWS.sample(200_000, seed=3)
    point[:, [0, 2]] = 0.25, -0.5
    values = fit.predict(point)
    held = [True, False, True, False, False, False, False]
    start = LAWS.decode([[0.25, 0.0, -0.5, 0.0, -1.0, -1.0, -1.0]])
    limits = [[float(np.quantile(values, 0.2)), None]]
    (found,) = draws(
        content, values=[start[n].item() for n in LAWS.names], held=held, limits=limits
    )
    close_to(found, values.mean(), values.var(), values)
    assert found["inside"] == pytest.approx(0.8, abs=4 * np.sqrt(0.16 * (1 / DRAWS + 1 / 200_000)))


def constrained(*texts):
    space = Space(tuple(Parameter(name, uniform(0.0, 1.0), unit="mm") for name in "abc"))
    units = {name: "mm" for name in "abc"}
    return replace(space, constraints=tuple(parse(text, units) for text in texts))


@pytest.mark.parametrize(
    "texts",
    [
        ("a + b <= 0.12 cm", "sqrt(a*b) >= 0.1 mm"),
        ("a + b + c = 1 mm",),
    ],
)
def test_constraints_keep_what_python_keeps(texts):
    """Draws inside of constraints and on a mixture; marks of points that break them."""
    space = constrained(*texts)
    content = content_of(space, train=space.sample(40, seed=1), surrogates=("linear",))
    fit = chosen(content)[0].fit
    values = fit.predict(space.sample(200_000, seed=3))
    (found,) = draws(content)
    close_to(found, values.mean(), values.var(), values)
    points = np.random.default_rng(1).uniform(-0.05, 1.05, (60, 3)).round(3)
    coded = space.encode(dict(zip("abc", points.T, strict=True)))
    if space.region.equalities:
        coded = space.region.equalities.solve(coded)
    answers = ask(content, *({"kind": "profile", "values": row.tolist()} for row in points))
    inside = [not (one["outside"] or one["broken"]) for one in answers]
    assert inside == space.contains(coded).tolist()
    assert 0 < sum(inside) < len(inside)
    np.testing.assert_allclose([one["coded"] for one in answers], coded, atol=1e-12)


def test_cloud_of_rows_is_pythons():
    """Hidden extrapolation of a table's correlated rows."""
    copula = ((1.0, 0.9), (0.9, 1.0))
    space = Space(tuple(Parameter(name, uniform(0, 1)) for name in "ab"), copula)
    content = content_of(space, train=40, surrogates=("linear",))
    content.runs.attrs["recorded"] = "true"
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (60, 2))
    values = (points + 1.0) / 2.0
    answers = ask(content, *({"kind": "profile", "values": row.tolist()} for row in values))
    hidden = extrapolates(space, chosen(content)[0].fit.coded, points)
    assert [one["hidden"] for one in answers] == hidden.tolist()
    assert 5 < hidden.sum() < 55


def desirability(goal, y):
    """Derringer and Suich 1980, equations 1 and 2, exponents 1."""
    kind, low, target, high = (goal[key] for key in ("kind", "low", "target", "high"))
    if kind == "target":
        rising, falling = (y - low) / (target - low), (high - y) / (high - target)
        return np.clip(np.minimum(rising, falling), 0.0, 1.0)
    share = (y - low) / (high - low) if kind == "maximise" else (high - y) / (high - low)
    return np.clip(share, 0.0, 1.0)


def test_search_finds_scipys_optimum():
    """A target for one output against another's: conflict, weights, and a held parameter."""
    content = content_of(None, train=70, outputs=("pressure_b1", "slope"))
    fits = [one.fit for one in chosen(content)]
    goals = [
        {"kind": "maximise", "low": 25.0, "target": 0.0, "high": 60.0, "weight": 2.0, "soft": 1.0},
        {"kind": "minimise", "low": 0.2, "target": 0.0, "high": 2.5, "weight": 1.0, "soft": 1.0},
    ]
    held = [True, *[False] * 6]

    def merit(rest):
        """Of coded values (6,) or (6, m) of the free inputs."""
        points = np.vstack([np.zeros((1, rest[0].size)), np.reshape(rest, (6, -1))]).T
        d = [desirability(goal, fit.predict(points)) for goal, fit in zip(goals, fits, strict=True)]
        return d[0] ** (2.0 / 3.0) * d[1] ** (1.0 / 3.0)

    best = optimize.differential_evolution(
        lambda x: -merit(x),
        [(-1.0, 1.0)] * 6,
        seed=1,
        tol=1e-12,
        vectorized=True,
        updating="deferred",
        polish=False,
    )
    (found,) = ask(content, {"kind": "search", "goals": goals, "held": held})
    assert 0.1 < found["merit"] < 0.95
    assert found["merit"] == pytest.approx(-float(best.fun), abs=1e-7)
    columns = np.array(found["values"])[:, None]
    coded = content.space.encode(dict(zip(content.space.names, columns, strict=True)))
    assert coded[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert merit(coded[0, 1:])[0] == pytest.approx(found["merit"], abs=1e-9)


def test_search_meets_targets_and_says_how_surely():
    """Two targets at once are met; probabilities are Student's of the prediction errors."""
    content = content_of(LAWS, train=90, outputs=("pressure_b1", "slope"))
    fits = [one.fit for one in chosen(content)]
    goals = [
        {"kind": "target", "low": 33.0, "target": 34.0, "high": 36.0, "weight": 1.0, "soft": 1.0},
        {"kind": "limits", "low": 1.1, "target": 0.0, "high": 1.3, "weight": 1.0, "soft": 0.1},
    ]
    first, again = ask(content, *[{"kind": "search", "goals": goals}] * 2)
    assert first == again and first["allowed"]
    assert first["merit"] == pytest.approx(1.0, abs=1e-6)
    columns = {name: np.array([v]) for name, v in zip(LAWS.names, first["values"], strict=True)}
    coded = LAWS.encode(columns)
    assert LAWS.contains(coded).all()
    for goal, fit, told in zip(goals, fits, first["outputs"], strict=True):
        mean, std = fit.predict(coded, return_std=True)
        law = stats.t(fit.estimator.interval_freedom, mean[0], std[0])
        assert told["mean"] == pytest.approx(mean[0], rel=1e-9)
        expected = law.cdf(goal["high"]) - law.cdf(goal["low"])
        assert told["probability"] == pytest.approx(expected, abs=1e-9)
    product = np.prod([told["probability"] for told in first["outputs"]])
    assert first["probability"] == pytest.approx(product)


def test_search_keeps_a_mixture():
    """The largest a of a + b + c = 1 with a <= 0.7, by a plane."""
    space = constrained("a + b + c = 1 mm", "a <= 0.7 mm")
    content = content_of(space, train=space.sample(40, seed=1), surrogates=("linear",))
    fit = chosen(content)[0].fit
    goal = {"kind": "maximise", "low": 0.0, "target": 0.0, "high": 100.0, "weight": 1, "soft": 1}
    (found,) = ask(content, {"kind": "search", "goals": [goal]})
    corners = space.encode({"a": [0, 0, 0.7, 0.7], "b": [1, 0, 0.3, 0.0], "c": [0, 1, 0.0, 0.3]})
    assert found["outputs"][0]["mean"] == pytest.approx(fit.predict(corners).max(), abs=1e-6)
    assert sum(found["values"]) == pytest.approx(1.0, abs=1e-12)


def test_best_surrogate_without_portable_form_is_named():
    """The best portable one is shown in its place, and the page says so."""
    content = content_of(None, train=30, surrogates=("linear", "interactions"))
    best = content.best("pressure_b1")
    other = next(name for name in content.fits if name != best)
    hidden = replace(content.fits[best]["pressure_b1"], estimator=object())
    content = replace(content, fits={**content.fits, best: {"pressure_b1": hidden}})
    (shown,) = chosen(content)
    assert (shown.surrogate, shown.best) == (other, best)
    (said,) = notes(content, [shown])
    assert said.startswith(f"pressure_b1 is shown by {other}") and best in said


def test_the_map_starts_with_the_inputs_that_matter_most():
    content = content_of(LAWS)
    assert payload(content, chosen(content), ["teeth", "cut"])["leading"] == [4, 1, 0, 2, 3, 5, 6]
