"""The index by which screening decides: how much a parameter can matter at most.

Independent parameters: the total index T_i = E[Var(f | x outside i)] / Var f, the share that
is lost when x_i is frozen (Sobol' 1993). Dependent parameters: no single index tells. With
v(S) = Var E[f | x_S] / Var f, method shapley gives three means of v(S + i) - v(S) >= 0, what
x_i adds to a set S of others:

    full first-order index    S empty: x_i with all that depends on it
    independent total index   S all others: x_i without all that depends on it
    Shapley effect            the average over all orders of the inputs

(Mara, Tarantola and Annoni 2015, doi 10.1016/j.envsoft.2015.07.010, for the first two; Song,
Nelson and Staum 2016, doi 10.1137/15M1048070, for the last). A parameter may be frozen when
the upper ends of the intervals of all three lie below the limit. One alone is not enough: of
two inputs that say nearly the same both have an independent total index near 0, f = x_1 x_2
with x_1 near x_3 hides x_1 from the first two, and an average over many orders hides a large
contribution to a few. As no contribution is negative, a Shapley effect e bounds each of them:
v(S + i) - v(S) <= d binom(d - 1, |S|) e. For independent parameters the total index is the
largest of the three, so that both rules agree.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from surrogate.errors import StudyError
from surrogate.sensitivity.sobol import worst_case

TOTAL = "total index"
#: Indices of method shapley, in words.
DEPENDENT = {
    "shapley": "Shapley effect",
    "closed_first_order": "full first-order index",
    "independent_total": "independent total index",
}
#: What decides, in words: of method shapley the largest of three.
LARGEST = "largest of Shapley effect, full first-order and independent total index"


def importance(indices: xr.Dataset) -> xr.Dataset:
    """Variables `total`, `_low`, `_high`, `_worst` of the index that decides, and its name.

    They have dimensions output and parameter; `index` says in words which one each is, the
    attribute `decides` what decides. Raises `StudyError` where the dataset has no such index.
    """
    if "total_high" in indices:
        named = xr.full_like(indices["total"], "", dtype=object) + TOTAL
        return indices.assign(index=named).assign_attrs(decides=TOTAL)
    if not all(f"{name}_high" in indices for name in DEPENDENT):
        raise StudyError(
            f"screening needs total indices or Shapley effects, which method "
            f"{indices.attrs.get('method')} does not give; use method sobol or shapley"
        )
    dims = ("output", "parameter")
    highest = np.stack([indices[f"{name}_high"].values for name in DEPENDENT]).argmax(axis=0)
    parts = {}
    for end in ("", "_low", "_high"):
        stack = np.stack([indices[name + end].values for name in DEPENDENT])
        parts[f"total{end}"] = (dims, np.take_along_axis(stack, highest[None], axis=0)[0])
    known = zip(parts["total"][1], indices["q2"].values.tolist(), strict=True)
    parts["total_worst"] = (dims, np.stack([worst_case(row, q2) for row, q2 in known]))
    parts["index"] = (dims, np.array(list(DEPENDENT.values()), dtype=object)[highest])
    return indices.assign(parts).assign_attrs(decides=LARGEST)
