"""Morris, DGSM and PAWN against closed forms and the theorems that bind them to Sobol'."""

import numpy as np
import pytest
from sklearn.ensemble import RandomForestRegressor

from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.sensitivity.dgsm import dgsm
from surrogate.sensitivity.morris import morris
from surrogate.sensitivity.pawn import pawn
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

METHODS = [morris, dgsm, pawn]
SMALL = {morris: {}, dgsm: {"samples": 128}, pawn: {"samples": 256, "slices": 8}}


def unit_space(*names):
    return Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in names))


def test_morris_effects_of_a_plane_are_its_slopes():
    """f = 3 x - y: mu = (6, -2) over the ranges, mu_star their sizes, sigma 0 (Morris 1991)."""
    effects = morris(lambda t: t @ [3.0, -1.0, 0.0], unit_space(*"xyz")).isel(output=0)
    np.testing.assert_allclose(effects["mu"], [6.0, -2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(effects["mu_star"], [6.0, 2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(effects["sigma"], 0.0, atol=1e-10)


def test_morris_tells_interaction_by_sigma():
    """f = x y: effects of x are 2 y, of mean 0 and spread; a plane's have no spread."""
    effects = morris(lambda t: t[:, 0] * t[:, 1] + 2.0 * t[:, 2], unit_space(*"xyz")).isel(output=0)
    assert (np.abs(effects["mu"][:2]) <= effects["mu_sampling"][:2] + 0.1).all()
    assert (effects["sigma"][:2] > 1.0).all() and float(effects["sigma"][2]) < 1e-10


def test_dgsm_of_ishigami_is_its_integral(textbook):
    """E[(df/dx)^2] in closed form, times (2 pi)^2 for the whole range; within the intervals."""
    case = textbook("ishigami")
    found = dgsm(case.function, case.space, samples=2**12, confidence=0.999).isel(output=0)
    exact = np.array(list(case.facts["dgsm_E_df2"].values())) * (2.0 * np.pi) ** 2
    assert (np.abs(found["nu"] - exact) <= found["nu_sampling"] + 2e-4 * exact).all()
    np.testing.assert_allclose(found["nu"], exact, rtol=5e-3)


@pytest.mark.parametrize("name", ["ishigami", "borehole", "piston"])
def test_dgsm_bounds_total_indices(name, textbook):
    """T_i <= nu_i / (pi^2 V) for uniform inputs (Sobol' and Kucherenko 2009)."""
    case = textbook(name)
    found = dgsm(case.function, case.space).isel(output=0)
    assert (found["total_bound"] >= case.total).all()


def test_dgsm_of_normal_inputs_uses_their_law():
    """f = z, z ~ N(0, 1), u = F(z): df/du = 1 / pdf(z); the bound exceeds T = 1 and T = 0 stays."""
    space = Space(
        (
            Parameter("z", distribution("normal", mean=0.0, std=1.0, range=(-2.0, 2.0))),
            Parameter("x", uniform(-1.0, 1.0)),
        )
    )
    found = dgsm(lambda t: t[:, 0], space, samples=2**12).isel(output=0)
    z = np.linspace(-2.0, 2.0, 200_001)
    law = space["z"].distribution
    exact = np.trapezoid(0.25 / law.pdf(z), z)
    assert float(found["nu"][0]) == pytest.approx(exact, rel=1e-2)
    assert float(found["total_bound"][0]) > 1.0 and float(found["total_bound"][1]) == 0.0


def test_dgsm_refuses_what_has_no_derivative():
    """Levels, and the steps of a forest, with the cure."""
    space = unit_space("x", "y")
    coded = space.sample(60, seed=0)
    forest = fit(
        space,
        coded,
        coded[:, 0] ** 2,
        RandomForestRegressor(10, random_state=0),
        surrogate="forest",
        output="y",
    )
    with pytest.raises(StudyError, match="forest has no derivative.*method sobol"):
        dgsm(forest, space)
    levels = Space((Parameter("kind", levels=("a", "b")), Parameter("x", uniform(0.0, 1.0))))
    with pytest.raises(StudyError, match="kind is categorical"):
        dgsm(lambda t: t[:, 0], levels)


def test_pawn_of_the_only_input_is_that_of_its_slices():
    """f = x: slice k of n is uniform there; distance max(k, n - 1 - k) / n, median and maximum."""
    found = pawn(lambda t: t[:, 0], unit_space("x"), slices=16).isel(output=0, parameter=0)
    distances = [max(k, 15 - k) / 16 for k in range(16)]
    assert float(found["maximum"]) == pytest.approx(max(distances), abs=0.01)
    assert float(found["median"]) == pytest.approx(np.median(distances), abs=0.01)


def test_pawn_ranks_ishigami_as_published(textbook):
    """Pianosi and Wagener 2015, doi 10.1016/j.envsoft.2015.01.004: X2, then X1, then X3."""
    case = textbook("ishigami")
    found = pawn(case.function, case.space, samples=2**10).isel(output=0)
    assert list(np.argsort(-found["median"].values)) == [1, 0, 2]


@pytest.mark.parametrize("method", METHODS)
def test_methods_share_one_layout_and_show_both_parts(method, textbook):
    """Each measure with `_low`, `_high`, `_sampling`, `_surrogate`, and the stamp."""
    case = textbook("ishigami")
    coded = case.space.sample(40, seed=1)
    surrogate = fit(
        case.space, coded, case.function(coded), GaussianProcess(), surrogate="tested", output="y"
    )
    found = method(surrogate, case.space, draws=4, replicates=4, **SMALL[method])
    measures = [str(name) for name in found.data_vars if f"{name}_low" in found]
    assert len(measures) >= 2 and found.attrs["method"] == method.__name__
    for name in measures:
        assert (found[f"{name}_low"] <= found[name]).all()
        assert (found[name] <= found[f"{name}_high"]).all()
        assert float(found[f"{name}_surrogate"].max()) > 0.0
    assert found.attrs["surrogate_part"].startswith("posterior draws")


@pytest.mark.parametrize("method", METHODS)
def test_numbers_depend_on_the_seed_alone(method, textbook):
    """Same seed same numbers, and NumPy's global state is left as it was."""
    case = textbook("ishigami")
    np.random.seed(3)  # noqa: NPY002
    state = np.random.get_state()[1].copy()  # noqa: NPY002
    one, same, other = (
        method(case.function, case.space, seed=s, replicates=4, **SMALL[method]) for s in (1, 1, 2)
    )
    np.testing.assert_array_equal(np.random.get_state()[1], state)  # noqa: NPY002
    assert one.equals(same) and not one.equals(other)


@pytest.mark.parametrize("method", METHODS)
def test_correlated_parameters_and_arrays_are_refused(method):
    """With the method that takes them."""
    correlated = Space(unit_space("a", "b").parameters, ((1.0, 0.5), (0.5, 1.0)))
    with pytest.raises(StudyError, match="correlated.*shapley"):
        method(lambda t: t[:, 0], correlated)
    with pytest.raises(StudyError, match="array; use method sobol"):
        method(lambda t: t[:, :, None] * np.ones(3), unit_space("a", "b"))


@pytest.mark.parametrize(
    ("method", "options", "sentence"),
    [
        (morris, {"levels": 5}, "levels: 5 must be even.*take 6"),
        (morris, {"trajectories": 0}, "trajectories: 0 is too few"),
        (pawn, {"samples": 16}, "samples: 16 is too few; take 128"),
        (dgsm, {"samples": 1}, "samples: 1 is too few"),
        (dgsm, {"replicates": 1}, "replicates: 1 is too few"),
        (dgsm, {"draws": -1}, "draws: -1 is too few"),
    ],
)
def test_options_without_sense_are_refused_with_the_cure(method, options, sentence):
    """The value, what is allowed, the cure."""
    with pytest.raises(StudyError, match=sentence):
        method(lambda t: t[:, 0], unit_space("a", "b"), **options)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ripple", [0.0, 4e-16])
def test_output_that_does_not_vary_has_no_effects(method, ripple):
    """Rounding moves no distribution and has no derivative, and no variance divides."""
    effects = method(lambda t: 3.0 + ripple * t[:, 0], unit_space("x", "y"), **SMALL[method])
    for name in ("mu_star", "nu", "total_bound", "maximum"):
        if name in effects:
            assert (effects[name] == 0.0).all() and (effects[f"{name}_high"] == 0.0).all()
