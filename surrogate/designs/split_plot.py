"""Split-plot design: parameters that are hard to change are set once for several runs.

Whole plots are the levels of a parameter of their own (batches, furnace loads). Each has one
setting of the hard-to-change parameters, whose factorial is repeated over the whole plots, and
within it all combinations of the other parameters (Montgomery, Design and Analysis of
Experiments, section 14.4). The regressor `mixed_model` gives both kinds of parameters their own
error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.requirements import affordable, bounded, uncut
from surrogate.errors import DesignError, nearest
from surrogate.space.space import Space


def split_plot(
    space: Space,
    *,
    whole_plots: str,
    hard_to_change: Sequence[str],
    levels: int | dict[str, int] = 2,
    seed: int | None = None,
) -> NDArray[np.float64]:
    """Coded (run, parameter), whole plot by whole plot.

    whole_plots     parameter whose levels are the whole plots; their number must be a multiple of
                    the settings of the hard-to-change parameters, twice them or more, so that the
                    scatter between whole plots is seen
    hard_to_change  parameters that are set once in a whole plot
    levels          of each parameter, or of the named ones, as in `full_factorial`
    seed            of the order of the settings over the whole plots, and of the runs in each

    Raises `DesignError` with all that is wrong.
    """
    bounded(space, "split_plot")
    _check(space, whole_plots, hard_to_change)
    own = [name for name in space.names if name != whole_plots]
    hard = [name for name in own if name in hard_to_change]
    easy = [name for name in own if name not in hard_to_change]
    settings, runs = (_factorial(space, names, levels) for names in (hard, easy))
    plots = space[whole_plots].coded_levels
    _check_plots(whole_plots, len(plots), hard, len(settings))
    affordable(len(plots) * len(runs), "split_plot", "take fewer levels")
    rng = np.random.default_rng(seed)
    order = rng.permutation(np.arange(len(plots)) % len(settings))
    rows = []
    for plot, setting in zip(plots, settings[order], strict=True):
        rows.append(
            np.column_stack([np.tile([plot, *setting], (len(runs), 1)), rng.permutation(runs)])
        )
    place = [[whole_plots, *hard, *easy].index(name) for name in space.names]
    return uncut(space, np.vstack(rows)[:, place], "split_plot")


def _factorial(space: Space, names: list[str], levels: int | dict[str, int]) -> NDArray[np.float64]:
    """Every combination of some of the parameters."""
    if isinstance(levels, dict):
        levels = {name: count for name, count in levels.items() if name in names}
    return full_factorial(Space(tuple(space[name] for name in names)), levels=levels)


def _check(space: Space, whole_plots: str, hard_to_change: Sequence[str]) -> None:
    """Refuse names that are not there, and what leaves nothing to vary in a whole plot."""
    wrong = []
    if whole_plots not in space.names or not space[whole_plots].categorical:
        wrong.append(
            f"whole_plots: '{whole_plots}' is no parameter with levels; add one, such as "
            "batch: {levels: [b1, b2, b3, b4]}"
        )
    for name in hard_to_change:
        if name not in space.names or name == whole_plots:
            others = [one for one in space.names if one != whole_plots]
            wrong.append(f"hard_to_change: '{name}' is unknown; {nearest(name, others)}")
    if not wrong and not 0 < len(set(hard_to_change)) < space.size - 1:
        wrong.append(
            "hard_to_change: name some of the parameters, and leave others to vary within whole "
            "plots"
        )
    if wrong:
        raise DesignError("\n".join(wrong))


def _check_plots(name: str, plots: int, hard: list[str], settings: int) -> None:
    if plots % settings or plots < 2 * settings:
        least = 2 * settings * max(1, math.ceil(plots / (2 * settings)))
        raise DesignError(
            f"whole_plots: {name} has {plots} levels for {settings} settings of "
            f"{', '.join(hard)}; give it a multiple of {settings}, twice that or more, such as "
            f"{least}, so that each setting is there in several whole plots"
        )
