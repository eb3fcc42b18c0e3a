"""Shapley effects, screening and surrogates where constraints join the parameters."""

import numpy as np
import pytest

from surrogate import Study
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.sensitivity.conditional import Pairs
from surrogate.sensitivity.screening import decide
from surrogate.sensitivity.shapley import shapley
from surrogate.sensitivity.sobol import sobol
from surrogate.space.constraint_text import parse
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def box(names, *texts):
    parameters = tuple(Parameter(name, uniform(0.0, 1.0)) for name in names)
    return Space(parameters, None, tuple(parse(text, dict.fromkeys(names, "")) for text in texts))


def weighted(space, *weights):
    def function(coded):
        physical = space.decode(coded)
        return sum(w * physical[name] for w, name in zip(weights, space.names, strict=True))

    return function


def test_effects_on_a_triangle():
    """f = a on a + b <= 1, uniform: Var a = 1/18, Var E[a | b] = Var((1 - b) / 2) = 1/72."""
    space = box("ab", "a + b <= 1")
    found = shapley(weighted(space, 1.0, 0.0), space, samples=2**13)
    assert found["closed_first_order"].values[0] == pytest.approx([1.0, 0.25], abs=0.02)
    assert found["independent_total"].values[0] == pytest.approx([0.75, 0.0], abs=0.02)
    assert found["shapley"].values[0] == pytest.approx([0.875, 0.125], abs=0.02)


def test_effects_on_a_small_triangle_walk_there():
    """The same on a + b <= 0.02, 2e-4 of the box."""
    space = box("ab", "a + b <= 0.02")
    found = shapley(weighted(space, 1.0, 0.0), space, samples=2**13)
    assert found["shapley"].values[0] == pytest.approx([0.875, 0.125], abs=0.03)


def test_effects_of_a_mixture():
    """f = a on the simplex of three: Var E[a | b] / Var a = 1/4, nothing varies given two."""
    space = box("abc", "a + b + c = 1")
    found = shapley(weighted(space, 1.0, 0.0, 0.0), space, samples=2**13)
    assert found["closed_first_order"].values[0] == pytest.approx([1.0, 0.25, 0.25], abs=0.02)
    assert found["independent_total"].values[0] == pytest.approx(np.zeros(3), abs=1e-12)
    # v(a) = 1, v(b) = v(c) = 1/4, v of any two = 1: (1 + 3/4 + 0 .. ) averaged over orders
    assert found["shapley"].values[0] == pytest.approx([7 / 12, 5 / 24, 5 / 24], abs=0.02)


def test_partners_keep_the_constraints_and_the_rest():
    space = box("abcd", "a + b + c = 1", "d <= a + 0.2")
    pairs = Pairs.of(space, np.random.default_rng(0).random((512, 8)))
    assert space.contains(pairs.points()).all()
    for redrawn in ((0,), (0, 1), (1, 3), (0, 1, 2, 3)):
        partners = pairs.partners(redrawn)
        assert space.contains(partners).all()
        fixed = [j for j in range(4) if j not in redrawn]
        assert np.array_equal(partners[:, fixed], pairs.points()[:, fixed])


def test_sobol_refuses():
    space = box("ab", "a + b <= 1")
    with pytest.raises(StudyError, match="these are joined by constraints"):
        sobol(weighted(space, 1.0, 0.0), space)


@pytest.mark.parametrize("estimator", [Linear(), Quadratic(), PolynomialChaos(), GaussianProcess()])
def test_surrogates_of_mixtures_are_not_singular(estimator):
    """f = 3 a + b - c: found from 20 points; the constant and all components would be singular."""
    space = box("abcx", "a + b + c = 1")
    coded = latin_hypercube(space, runs=20, seed=0)
    truth = weighted(space, 3.0, 1.0, -1.0, 0.5)
    one = fit(space, coded, truth(coded), estimator, surrogate="s")
    fresh = space.sample(50, seed=9)
    assert one.predict(fresh) == pytest.approx(truth(fresh), abs=1e-2)
    assert np.isfinite(shapley(one, space, samples=64, draws=4)["shapley_high"]).all()
    if isinstance(estimator, Linear):
        table = one.estimator.regression_table()
        assert table["term"].values.tolist() == ["1", "a", "b", "x"]
        assert np.isfinite(table["vif"].values[1:]).all()


def test_screening_where_constraints_join_parameters():
    space = box("abx", "a + b <= 1")
    fits = {"y": weighted(space, 1.0, 0.0, 0.0)}
    indices = shapley(fits["y"], space, samples=2**11)
    decided = decide(indices, 0.05, fits=fits, space=space, samples=2**11)
    assert decided.keep == ("a", "b") and decided.freeze == ("x",)
    assert decided.variance_kept[0].share == pytest.approx(1.0)


STUDY = """\
study: joined
solver: borehole
parameters:
  rw: [0.05, 0.15]
  L: {range: [1.12, 1.68], unit: km}
  Kw: {range: [9855, 12045], integer: true}
  Tu: [63070, 115600]
constraints:
  - L <= 1000 m + 4000*rw
  - Kw*rw/L <= 1.5 m/year
constants: {Hu: 1000}
designs:
  train: {method: latin_hypercube, runs: 30, seed: 1}
  test: {method: sobol, runs: 10, seed: 1}
surrogates: {linear: linear, gp: gaussian_process}
sensitivity: {method: shapley, samples: 256, draws: 5}
screening: {freeze_below: 0.05}
"""


def test_a_study_reads_constraints():
    study = Study.from_text(STUDY)
    for design in study.designs.values():
        assert study.space.contains(design.coded).all()
        physical = study.space.decode(design.coded)
        assert (physical["L"] <= 1000.0 + 4000.0 * physical["rw"]).all()


@pytest.mark.parametrize(
    "old, new, said",
    [
        ("L <= 1000 m", "L <= 1000", "9:5: constraint .* has no unit"),
        ("L <= 1000 m + 4000*rw", "L + 100 m <= Hu", "constraint 'L . 100 m <= Hu' leaves nothing"),
        ("method: shapley, samples: 256,", "method: sobol,", "joined by constraints; use method"),
        (
            "method: latin_hypercube, runs: 30, seed: 1",
            "method: full_factorial",
            "cuts .* of the 16",
        ),
    ],
)
def test_a_study_says_what_is_wrong_with_constraints(old, new, said):
    with pytest.raises(StudyError, match=said):
        Study.from_text(STUDY.replace(old, new))
