"""How far adaptive designs came, and whether choosing points paid."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from surrogate.adaptive.aim import ACCURACY, Rule
from surrogate.adaptive.gain import Runs, gain
from surrogate.adaptive.outcome import ATTRIBUTE, Grown, Outcome, outcome_data, outcome_from
from surrogate.runs import dataset as rundata
from surrogate.space.space import Space
from surrogate.stages.comparison import TEST


def adaptive(rules: Mapping[str, Rule], space: Space, runs: xr.Dataset) -> dict[str, Grown]:
    """Each adaptive design of the study, by name."""
    told = json.loads(runs.attrs.get(ATTRIBUTE, "{}"))
    found = {}
    for name, rule in rules.items():
        if name in told:
            one = outcome_from(told[name])
            chosen = rule.aim.kind == ACCURACY and one.rows > one.initial and not rule.levels
            paid = tuple(_paid(rule, name, one, space, runs)) if chosen else ()
            found[name] = Grown(one, paid)
    return found


def figures(found: Mapping[str, Grown]) -> dict[str, Any]:
    """JSON data for summary.json."""
    return {
        name: {**outcome_data(grown.outcome), "paid": list(grown.paid)}
        for name, grown in found.items()
    }


def _paid(rule: Rule, name: str, one: Outcome, space: Space, runs: xr.Dataset) -> Iterator[str]:
    names = runs["design"].values.astype(str)
    if TEST not in names:
        yield (
            "whether choosing the points paid cannot be told, because the study has no test "
            "design; add designs: test"
        )
        return
    rows = np.flatnonzero(names == name)
    for output in rule.aim.outputs:
        first, whole = (_runs(runs, output, part) for part in (rows[: one.initial], rows))
        test = rundata.training(runs, output, (TEST,))
        yield gain(space, first, whole, test, output, str(runs[output].attrs.get("units", "")))


def _runs(runs: xr.Dataset, output: str, rows: np.ndarray) -> Runs:
    """Finished runs among some rows of one design."""
    some = runs.isel(run=rows)
    return rundata.training(some, output, np.unique(some["design"].values.astype(str)).tolist())
