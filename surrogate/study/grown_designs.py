"""Adaptive designs as far as they have grown: in the results folder, else in stored runs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from surrogate.adaptive.aim import Rule
from surrogate.adaptive.judge import NOTHING_LEFT
from surrogate.adaptive.kept import Kept, State
from surrogate.adaptive.outcome import ATTRIBUTE, outcome_from
from surrogate.designs.design import Design
from surrogate.runs.dataset import LEVEL


def kept(results: Path, rule: Rule) -> Kept:
    """Where a results folder holds the choices of a rule."""
    return Kept(results / "designs" / rule.identity)


def states(
    rules: Mapping[str, Rule],
    designs: Mapping[str, Design],
    results: Path,
    stored: Iterable[xr.Dataset],
) -> dict[str, State]:
    """The state of each adaptive design; nothing yet of one whose initial points are not found.

    Raises `ResultsError` for a damaged file.
    """
    found, stored = {}, tuple(stored)
    for name, rule in rules.items():
        if not designs[name].at_hand:
            found[name] = State(np.empty((0, 0)))
            continue
        initial = designs[name].initial
        state = kept(results, rule).read(*initial.shape)
        if not len(state.points) and not state.reviews:
            state = _in(stored, name, rule) or state
        found[name] = state
    return found


def _in(stored: Iterable[xr.Dataset], name: str, rule: Rule) -> State | None:
    """The state of a rule that stored runs tell."""
    for runs in stored:
        told = json.loads(runs.attrs.get(ATTRIBUTE, "{}"))
        if told.get(name, {}).get("identity") != rule.identity:
            continue
        found = outcome_from(told[name])
        own = runs.isel(run=np.flatnonzero(runs["design"].values.astype(str) == name))
        if own.sizes["run"] == found.rows:
            chosen = own.isel(run=slice(found.initial, None))
            levels = tuple(chosen[LEVEL].values.astype(str).tolist()) if rule.levels else ()
            closed = found.ended == NOTHING_LEFT
            return State(chosen["coded"].values, found.reviews, closed, levels)
    return None
