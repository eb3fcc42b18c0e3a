"""Portable documents: an evaluator in plain Python that knows the format alone."""

import json
import math

import numpy as np
import pytest

from surrogate.errors import FitError
from surrogate.fitting.fit import fit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.regressors.selection import Stepwise
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate.stages.portable import documents

SPACE = Space(
    (
        Parameter("tension", uniform(0.05, 0.14), unit="N/mm"),
        Parameter("cloth", levels=("p", "q", "r")),
        Parameter("c10", distribution("normal", mean=5, std=1), unit="kPa"),
        Parameter("t", distribution("lognormal", mean=2, std=0.4)),
        Parameter("nu", distribution("normal", mean=0.3, std=0.1, range=(0.1, 0.4))),
    )
)


def coded(document, physical):
    """Coded inputs of a dict of physical ones."""
    x = []
    for given in document["inputs"]:
        v, c = physical[given["name"]], given["coding"]
        if c["kind"] == "range":
            x.append(2 * (v - c["low"]) / (c["high"] - c["low"]) - 1)
        elif c["kind"] == "levels":
            x.append(2 * c["levels"].index(v) / (len(c["levels"]) - 1) - 1)
        elif c["kind"] == "normal":
            x.append(math.erf((v - c["mean"]) / (c["std"] * math.sqrt(2))))
        elif c["kind"] == "lognormal":
            x.append(math.erf((math.log(v) - c["mu"]) / (c["sigma"] * math.sqrt(2))))
    return x


def column(spec, x):
    if "level" not in spec:
        return x[spec["input"]]
    index = round((x[spec["input"]] + 1) * (spec["levels"] - 1) / 2)
    return 1.0 if index == spec["level"] else -1.0 if index == 0 else 0.0


def powers(terms, c):
    return sum(
        term["coefficient"] * math.prod(c[j] ** q for j, q in term["powers"]) for term in terms
    )


def polynomial(model, x):
    return powers(model["terms"], [column(spec, x) for spec in model["columns"]])


def orthonormal(base, degree, x):
    if "levels" in base:
        return base["values"][degree][round((x + 1) * (base["levels"] - 1) / 2)]
    before, now = 0.0, 1.0
    for k in range(degree):
        before, now = (
            now,
            ((x - base["alpha"][k]) * now - base["beta"][k] * before) / base["beta"][k + 1],
        )
    return now


def chaos(model, x):
    return sum(
        term["coefficient"]
        * math.prod(orthonormal(model["bases"][i], q, x[i]) for i, q in term["degrees"])
        for term in model["terms"]
    )


def gaussian_process(model, x):
    c = [column(spec, x) for spec in model["columns"]]
    total = powers(model["trend"], c)
    for point, weight in zip(model["points"], model["weights"], strict=True):
        for a, b, length in zip(c, point, model["lengths"], strict=True):
            s = math.sqrt(5) * abs(a - b) / length
            weight *= (1 + s + s * s / 3) * math.exp(-s)
        total += weight
    return model["offset"] + model["scale"] * total


def completed(common, own):
    joined = {**common, **own}
    for key in common.keys() & own.keys():
        joined[key] = completed(common[key], own[key])
    return joined


def field(model, x):
    common = model.get("common", {})
    amplitudes = [evaluate(completed(common, one), x) for one in model["amplitudes"]]
    return [
        mean + sum(a * mode[i] for a, mode in zip(amplitudes, model["modes"], strict=True))
        for i, mean in enumerate(model["mean"])
    ]


def evaluate(model, x):
    return {
        "polynomial": polynomial,
        "chaos": chaos,
        "gaussian_process": gaussian_process,
        "field": field,
    }[model["kind"]](model, x)


def truth(x):
    return 40 + 5 * x[:, 0] + np.where(x[:, 1] == 0, 3.0, 0) * x[:, 2] + np.sin(x[:, 3]) * x[:, 4]


@pytest.mark.parametrize(
    "estimator",
    [
        Linear(),
        Interactions(),
        Quadratic(),
        Stepwise(),
        PolynomialChaos(),
        GaussianProcess(),
        GaussianProcess(trend="linear"),
    ],
    ids=str,
)
@pytest.mark.parametrize("output", ["scalar", "field"])
def test_plain_python_reproduces_predictions(estimator, output):
    """The JSON document and the format's description suffice, to 1e-10 of the values."""
    x = SPACE.sample(60, seed=1)
    values = truth(x)
    if output == "field":
        values = values[:, None, None] * np.ones((2, 3)) + x[:, :1, None] ** 2 * np.arange(3)
    fitted = fit(SPACE, x, values, estimator, surrogate="s", output="pressure")
    document = json.loads(json.dumps(fitted.portable()))
    assert document["output"] == "pressure" and document["inputs"][0]["unit"] == "N/mm"
    new = SPACE.sample(20, seed=2)
    physical = SPACE.decode(new)
    for k, expected in enumerate(fitted.predict(new)):
        point = {name: values[k] for name, values in physical.items()}
        got = np.reshape(evaluate(document["model"], coded(document, point)), np.shape(expected))
        np.testing.assert_allclose(got, expected, rtol=1e-10, atol=1e-10)


def test_laws_that_have_no_formula_are_refused():
    space = Space((Parameter("k", distribution("gamma", a=2.0)),))
    x = space.sample(10, seed=0)
    with pytest.raises(FitError, match="k: .*give it a range"):
        fit(space, x, x[:, 0], Linear()).portable()


def test_what_modes_have_in_common_stands_once():
    """Runs of all modes are one list, and documents that repeat them, as version 1 did, work."""
    x = SPACE.sample(40, seed=1)
    values = truth(x)[:, None] * np.ones(3) + x[:, :1] ** 2 * np.arange(3)
    for estimator in (GaussianProcess(), Quadratic(), PolynomialChaos()):
        model = fit(SPACE, x, values, estimator).portable()["model"]
        common, amplitudes = model["common"], model["amplitudes"]
        assert len(amplitudes) > 1 and "columns" in common or "bases" in common
        assert not any(key in one for one in amplitudes for key in ("points", "kind", "bases"))
        repeated = {
            **{key: value for key, value in model.items() if key != "common"},
            "amplitudes": [completed(common, one) for one in amplitudes],
        }
        assert field(repeated, x[0]) == field(model, x[0])


def test_documents_keep_all_digits():
    numbers = [0.1, 1 / 3, 5e-324, 1.7976931348623157e308, -1e-8, 2.0**70, float("nan")]
    (content,) = documents({"s": {"y": {"numbers": numbers}}}).values()
    assert json.loads(content) == {"y": {"numbers": [*numbers[:-1], None]}}
