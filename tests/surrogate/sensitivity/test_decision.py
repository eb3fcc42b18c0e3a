"""Keep or freeze, and what it costs."""

import json

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression

from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.sensitivity.frozen import variance_kept
from surrogate.sensitivity.model import model
from surrogate.sensitivity.morris import morris
from surrogate.sensitivity.screening import decide
from surrogate.sensitivity.sobol import sobol
from surrogate.sensitivity.table import combine
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SMALL = {"samples": 2**10, "draws": 20}


def unit_space(*names):
    return Space(tuple(Parameter(name, uniform(-1.0, 1.0), unit="mm") for name in names))


def fitted(function, space, estimator, output="y", runs=60):
    coded = space.sample(runs, seed=0)
    return fit(space, coded, function(coded), estimator, surrogate="tested", output=output)


def decided(space, freeze_below, *fits, **options):
    indices = combine([sobol(one, space, **SMALL) for one in fits])
    return decide(
        indices,
        freeze_below,
        space=space,
        fits={one.output: one for one in fits},
        **{**SMALL, **options},
    )


def test_small_parameters_are_frozen_and_the_cost_is_that_of_the_group():
    """Quadratic f = 10 x + y + z + 2 y z: V = 100/3 + 2/3 + 4/9, T_{yz} = (2/3 + 4/9) / V."""
    space = unit_space("x", "y", "z")
    surrogate = fitted(lambda t: t @ [10.0, 1.0, 1.0] + 2.0 * t[:, 1] * t[:, 2], space, Quadratic())
    decision = decided(space, 0.05, surrogate, nominal={"y": 0.5}, samples=2**14)
    assert decision.keep == ("x",) and decision.freeze == ("y", "z")
    assert decision.frozen_values == {"y": 0.5, "z": 0.0}
    variance, lost = 100 / 3 + 2 / 3 + 4 / 9, 2 / 3 + 4 / 9
    kept = decision.variance_kept[0]
    assert kept.share == pytest.approx(1.0 - lost / variance, abs=1e-3)
    assert kept.low <= 1.0 - lost / variance <= kept.high
    # Summing the totals would count the interaction twice.
    assert kept.share > 1.0 - (lost + 4 / 9) / variance + 0.005


def test_error_of_freezing_at_a_point_follows_sobol_and_others_2007():
    """f = x + y frozen at y0: error (1/3 + y0^2) / (2/3); twice T = 1/2 on average over y0."""
    space = unit_space("x", "y")
    one = model(lambda t: t.sum(axis=1), space)
    for y0 in (0.0, 0.6):
        kept = variance_kept(one, [1], np.array([0.0, y0]))
        assert kept.share == pytest.approx(0.5, abs=1e-3)
        assert kept.frozen_error == pytest.approx((1 / 3 + y0**2) / (2 / 3), rel=1e-3)


def test_a_parameter_is_kept_when_any_output_concerned_needs_it():
    """x matters for a, y for b; asked for b alone, x is frozen."""
    space = unit_space("x", "y", "z")
    a = fitted(lambda t: t[:, 0], space, Linear(), "a")
    b = fitted(lambda t: t[:, 1], space, Linear(), "b")
    assert decided(space, 0.02, a, b).keep == ("x", "y")
    assert decided(space, 0.02, a, b, outputs=["b"]).freeze == ("x", "z")


def test_poor_surrogate_decides_nothing(textbook):
    """The stamp is repeated, every parameter kept."""
    case = textbook("ishigami")
    decision = decided(case.space, 0.3, fitted(case.function, case.space, Linear()))
    assert decision.refused.startswith("Not to be trusted")
    assert decision.freeze == () and decision.keep == case.space.names
    assert decision.sentences[0] == decision.refused
    assert decision.variance_kept[0].share == 1.0


def test_variance_that_the_surrogate_misses_may_be_anybodys(textbook):
    """A plane through the piston misses 9 %: P0, Ta, T0 (below 0.2 %) are not surely below 2 %."""
    case = textbook("piston")
    surrogate = fitted(case.function, case.space, Linear(), runs=100)
    assert 0.02 < 1.0 - surrogate.q2 < 0.2
    decision = decided(case.space, 0.02, surrogate)
    assert decision.freeze == ()
    unsettled = next(v for v in decision.verdicts if v.parameter == "Ta")
    assert "undecided" in unsettled.sentence and "the surrogate misses" in unsettled.sentence
    assert decided(case.space, 0.3, surrogate).freeze != ()


def test_old_rule_stands_beside_and_decides_nothing():
    """f = 5 x + y z: moved alone, y and z show nothing; Sobol' keeps them."""
    space = unit_space("x", "y", "z")
    surrogate = fitted(lambda t: 5.0 * t[:, 0] + 3.0 * t[:, 1] * t[:, 2], space, Quadratic())
    decision = decided(space, 0.02, surrogate)
    assert decision.keep == ("x", "y", "z") and decision.kept_by_old_rule == ("x",)
    assert "one-at-a-time rule of 93% keeps x" in decision.sentences[-1]
    assert [v.one_at_a_time for v in decision.verdicts] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


def test_sentences_name_value_unit_bound_and_output():
    """What a reader needs to repeat the decision."""
    space = unit_space("x", "y")
    decision = decided(space, 0.02, fitted(lambda t: t[:, 0], space, Linear()))
    assert decision.sentences[1].startswith("y: freeze at 0 mm. Its total index is at most")
    assert "(y), below 0.02" in decision.sentences[1]
    assert decision.sentences[0].startswith("x: keep. Its total index is 1 and at least 1")


def test_summary_is_plain_json():
    """Numbers that are not known are null, never NaN."""
    space = unit_space("x", "y")
    indices = sobol(lambda t: t[:, 0], space, **SMALL)
    decision = decide(indices, 0.02, space=space, fits={"y": lambda t: t[:, 0]}, **SMALL)
    summary = json.loads(json.dumps(decision.summary(), allow_nan=False))
    assert summary["keep"] == ["x"] and summary["freeze"] == ["y"]
    assert summary["variance_kept"]["y"]["share"] == 1.0
    assert summary["verdicts"][0]["worst_case"] is None


def test_other_measures_and_unknown_outputs_are_refused_with_the_cure():
    """Screening needs total indices of outputs that exist."""
    space = unit_space("x", "y")

    def function(t):
        return t[:, 0]

    with pytest.raises(StudyError, match="method morris does not give; use method sobol"):
        decide(morris(function, space), 0.02, space=space, fits={"y": function})
    with pytest.raises(StudyError, match="'z' has no sensitivity indices"):
        decide(
            sobol(function, space, **SMALL), 0.02, space=space, fits={"y": function}, outputs=["z"]
        )


def test_an_output_that_does_not_vary_has_no_voice():
    """Beside f = x a constant output, sampled or in closed form: y is frozen, at no cost."""
    space = unit_space("x", "y")
    fits = [
        fitted(lambda t: t[:, 0], space, Linear(), "moves"),
        fitted(lambda t: np.full(len(t), 10 / 3), space, Linear(), "rests"),
        fitted(lambda t: np.full(len(t), 10 / 3), space, LinearRegression(), "sampled"),
    ]
    decision = decided(space, 0.02, *fits)
    assert decision.freeze == ("y",)
    for kept in decision.variance_kept:
        assert kept.share == pytest.approx(1.0) and kept.frozen_error == pytest.approx(0.0)


def test_cost_of_freezing_on_a_large_constant():
    """f = 1e8 + x + y / 2 at y = 0: error (1 / 12) / (5 / 12) all the same."""
    one = model(lambda t: 1e8 + t @ [1.0, 0.5], unit_space("x", "y"))
    assert variance_kept(one, [1], np.zeros(2)).frozen_error == pytest.approx(0.2, rel=1e-3)
