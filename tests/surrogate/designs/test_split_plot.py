"""Split-plot designs: what is constant in a whole plot, what each error is tested with."""

import numpy as np
import pytest

from surrogate.designs.split_plot import split_plot
from surrogate.errors import DesignError, StudyError
from surrogate.regressors.mixed_model import MixedModel
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.study import Study


def space(plots=8):
    heat, load, time, speed = (
        Parameter(n, uniform(0, 1)) for n in ("heat", "load", "time", "speed")
    )
    batch = Parameter("batch", levels=tuple(f"b{k}" for k in range(plots)))
    return Space((heat, time, batch, load, speed))


HARD = {"whole_plots": "batch", "hard_to_change": ["heat", "load"]}


def test_hard_parameters_are_set_once_in_a_whole_plot():
    """8 whole plots of 2^2 runs: each of the 2^2 settings twice, all 16 corners in two plots."""
    design = split_plot(space(), **HARD, seed=1)
    assert design.shape == (32, 5)
    plots = design.reshape(8, 4, 5)
    assert (plots[:, :, [0, 2, 3]] == plots[:, :1, [0, 2, 3]]).all()
    _, settings = np.unique(plots[:, 0, [0, 3]], axis=0, return_counts=True)
    assert settings.tolist() == [2, 2, 2, 2]
    _, corners = np.unique(design[:, [0, 1, 3, 4]], axis=0, return_counts=True)
    assert corners.tolist() == [2] * 16
    assert not np.array_equal(design, split_plot(space(), **HARD, seed=2))


def test_each_kind_of_parameter_has_its_own_error():
    """8 whole plots less 1 + 2 terms between them; 32 - 8 - 2 within them."""
    of = space()
    design = split_plot(of, **HARD, seed=1)
    y = design[:, 1] + 0.1 * np.random.default_rng(0).normal(size=32)
    y += np.random.default_rng(1).normal(size=8)[np.repeat(np.arange(8), 4)]
    model = MixedModel("batch", space=of).fit(design, y)
    assert model.freedoms == (5, 22)
    error = model.regression_table()["standard_error"].to_series()
    assert error["heat"] > 5 * error["time"]


@pytest.mark.parametrize(
    ("of", "options", "told"),
    [
        (space(), {**HARD, "whole_plots": "heat"}, "whole_plots: 'heat' is no parameter with lev"),
        (
            space(),
            {**HARD, "hard_to_change": ["head"]},
            "hard_to_change: 'head' is unknown; .*heat",
        ),
        (space(), {**HARD, "hard_to_change": []}, "name some of the parameters"),
        (space(6), HARD, "6 levels for 4 settings of heat, load; .*such as 8"),
        (space(4), HARD, "4 levels for 4 settings"),
    ],
)
def test_mistakes_are_told(of, options, told):
    with pytest.raises(DesignError, match=told):
        split_plot(of, **options)


def test_a_study_tells_mistakes_at_their_place():
    words = {
        "study": "demo",
        "solver": "ishigami",
        "parameters": {"X1": [-1, 1], "X2": [-1, 1]},
        "designs": {
            "train": {"method": "split_plot", "whole_plots": "oven", "hard_to_change": ["X1"]}
        },
        "surrogates": {"linear": "linear"},
    }
    with pytest.raises(StudyError, match="designs.train.*whole_plots: 'oven' is no parameter"):
        Study.from_mapping(words)
