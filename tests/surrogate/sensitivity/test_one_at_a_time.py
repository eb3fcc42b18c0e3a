"""The old rule: effects of one parameter at a time, and what it keeps."""

import numpy as np
import pytest

from surrogate.errors import StudyError
from surrogate.sensitivity.one_at_a_time import kept_by_rule, main_effects, one_at_a_time
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space


def unit_space(*names):
    return Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in names))


def test_squared_shares_of_a_plane_are_its_sobol_indices(reference):
    """Table III of Chassagne et al. 2018: effect 2 b_j, squared share b_j^2 / sum b^2."""
    facts = reference["reduced_model_table_3"]
    names = list(facts["sobol_indices"])
    b = np.array([facts["coefficients_mmHg_per_coded_unit"][name] for name in names])
    table = one_at_a_time(lambda x: 32.73 + x @ b, unit_space(*names)).isel(output=0)
    np.testing.assert_allclose(table["effect"], 2.0 * b, rtol=1e-12)
    np.testing.assert_allclose(table["share"], np.abs(b) / np.abs(b).sum(), rtol=1e-12)
    np.testing.assert_allclose(
        table["share_squared"], list(facts["sobol_indices"].values()), atol=6e-7
    )


def test_rule_is_blind_to_interactions_and_to_curves(textbook):
    """f = x + 10 y z + 10 w^2: moved alone from the middle only x has an effect."""
    table = one_at_a_time(
        lambda t: t[:, 0] + 10 * t[:, 1] * t[:, 2] + 10 * t[:, 3] ** 2, unit_space(*"xyzw")
    ).isel(output=0)
    np.testing.assert_allclose(table["share"], [1.0, 0.0, 0.0, 0.0], atol=1e-15)
    assert table["kept_by_share"].values.tolist() == [True, False, False, False]


def test_effects_depend_on_where_the_others_rest():
    """y z at z = 0.5 gives y the effect 2 z; `base` is in physical values."""
    space = Space((Parameter("y", uniform(0.0, 10.0)), Parameter("z", uniform(0.0, 10.0))))
    table = one_at_a_time(lambda t: t[:, 0] * t[:, 1], space, base={"z": 7.5}).isel(output=0)
    np.testing.assert_allclose(table["effect"], [1.0, 0.0], atol=1e-15)
    assert "z 7.5" in table.attrs["moved"]


def test_levels_and_unbounded_parameters_are_moved_as_the_page_says():
    """Largest difference of two levels; from the 2.5 to the 97.5 percentile."""
    space = Space(
        (
            Parameter("kind", levels=("a", "b", "c")),
            Parameter("t", distribution("normal", mean=0.0, std=2.0)),
        )
    )
    table = one_at_a_time(lambda x: np.abs(x[:, 0]) * 3.0 + space["t"].decode(x[:, 1]), space)
    np.testing.assert_allclose(table["effect"][0], [3.0, 2 * 2 * 1.959963984540054])


@pytest.mark.parametrize(
    ("share", "kept"),
    [
        ([0.6, 0.34, 0.05, 0.01], [True, True, False, False]),
        ([0.5, 0.43, 0.05, 0.02], [True, True, True, False]),
        ([0.01, 0.95, 0.02, 0.02], [False, True, False, False]),
        ([0.0, 0.0, 0.0, 0.0], [False, False, False, False]),
    ],
)
def test_rule_keeps_the_largest_until_they_exceed_the_threshold(share, kept):
    """'more than 93 %': exactly 93 % is not enough."""
    assert kept_by_rule(np.array(share), 0.93).tolist() == kept


def test_main_effects_of_a_two_level_design_are_differences_of_means():
    """Box, Hunter and Hunter: mean at the upper less mean at the lower level."""
    space = unit_space("a", "b")
    coded = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    values = np.array([3.0, 7.0, 4.0, 12.0])
    effects = main_effects(space, coded, values)["effect"][0]
    np.testing.assert_allclose(effects, [(7 + 12 - 3 - 4) / 2, (4 + 12 - 3 - 7) / 2])


def test_runs_that_do_not_determine_the_effects_are_refused():
    """Two runs for two effects and a mean."""
    with pytest.raises(StudyError, match="2 runs do not determine the effects of 2"):
        main_effects(unit_space("a", "b"), np.eye(2), np.ones(2))


def test_field_has_the_root_mean_square_of_its_effects():
    """(3 x, 4 x): effect 2 sqrt((9 + 16) / 2)."""
    table = one_at_a_time(lambda t: t[:, :1] * np.array([[3.0, 4.0]]), unit_space("x"))
    np.testing.assert_allclose(table["effect"][0], [2.0 * np.sqrt(12.5)])


def test_rounding_is_no_effect():
    """3 + 1e-16 noise: no effects, so no shares and nothing kept."""
    table = one_at_a_time(lambda x: 3.0 + 4e-16 * x[:, 0] - 4e-16 * x[:, 1], unit_space("x", "y"))
    assert (table["share"] == 0.0).all() and not table["kept_by_share"].any()
