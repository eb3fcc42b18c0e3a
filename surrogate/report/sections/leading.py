"""The inputs that matter most for an output: by which measure, how much, in words and shares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.sections.indices import DECIMALS, of_output, refusal
from surrogate.report.sections.measures import (
    index,
    measures_of,
    names_of,
    unit_of,
    variance_of,
)

#: The leading inputs are those that explain so much of the variance, and so many at most.
ENOUGH, MOST = 0.8, 3
#: Names of inputs in a cell of the first table.
LISTED = 2
#: Indices that are shares of the variance, and what they are called.
SHARES = {"total": "total index", "shapley": "Shapley effect"}


@dataclass(frozen=True, eq=False)
class Leading:
    """The sensitivity of an output, its leading measure, and the inputs by its size.

    order  numbers of the inputs, the largest measure first
    """

    table: xr.Dataset
    measure: str
    order: NDArray[np.intp]

    @property
    def names(self) -> list[str]:
        """The inputs, the largest measure first."""
        names = names_of(self.table)
        return [names[k] for k in self.order]

    @property
    def values(self) -> NDArray[np.float64]:
        """The measure of each input, in the order of the study."""
        return np.asarray(self.table[self.measure].values, dtype=float)


def leading(content: Content, output: str) -> Leading | None:
    """None without a sensitivity analysis of the output, and when its indices are refused."""
    table = of_output(content, output)
    if table is None or refusal(content, output):
        return None
    measure = "total" if "total" in table else next(iter(measures_of(table)), "")
    if not measure:
        return None
    sizes = np.abs(np.asarray(table[measure].values, dtype=float))
    return Leading(table, measure, np.argsort(-np.nan_to_num(sizes, nan=-1.0), kind="stable"))


def clause(content: Content, output: str) -> str:
    """The inputs that matter, in a clause; "" without a sensitivity analysis."""
    if refusal(content, output):
        return "what matters is not answered, because its indices are refused"
    found = leading(content, output)
    if found is None:
        return ""
    table, measure, order, names = found.table, found.measure, found.order, found.names
    if measure not in SHARES:
        unit = unit_of(measure, table, content.unit(output))
        size = index(table, measure)
        largest = digits.with_interval(
            *(size[part][order[0]] for part in ("value", "low", "high")), most=DECIMALS
        )
        return f"{names[0]} has the largest {measure}, {digits.with_unit(largest, unit)}"
    for count in range(1, min(MOST, len(names)) + 1):
        share = explained(table, order[:count])
        if share >= ENOUGH:
            break
    verb = "explains" if count == 1 else "explain"
    named = digits.listing(names[:count])
    percent = f"{digits.fixed(100.0 * share, 0)}{digits.THIN}%"
    return f"{named} {verb} {percent} of {variance_of(table)}"


def explained(table: xr.Dataset, inputs: np.ndarray) -> float:
    """Share of the variance that these inputs explain together, at most 1.

    Sobol' indices: the sum of the first-order indices and of the second-order ones inside the
    group; the closed index of the group is no less (Saltelli et al. 2008, 4.6). Dependent
    inputs: the sum of their Shapley effects.
    """
    if "first_order" not in table:
        return float(np.clip(np.nansum(table["shapley"].values[inputs]), 0.0, 1.0))
    share = float(np.nansum(table["first_order"].values[inputs]))
    if "second_order" in table:
        pairs = np.asarray(table["second_order"].values, dtype=float)[np.ix_(inputs, inputs)]
        share += float(np.nansum(np.tril(np.maximum(pairs, 0.0), -1)))
    return float(np.clip(share, 0.0, 1.0))


def words(content: Content, output: str) -> str:
    """The first inputs with their sizes, for a cell of a table."""
    found = leading(content, output)
    if found is None:
        return "not answered" if refusal(content, output) else ""
    shown = found.values[found.order[:LISTED]]
    told = (
        [digits.fixed(value, 2) for value in shown]
        if found.measure in SHARES
        else digits.column(shown, 2)
    )
    return ", ".join(
        f"{name} {size}" for name, size in zip(found.names[:LISTED], told, strict=True)
    )


def shares(content: Content, output: str) -> tuple[tuple[str, float], ...]:
    """Sizes of the leading measure by input, in the order of the study, the largest 1."""
    found = leading(content, output)
    if found is None:
        return ()
    sizes = np.nan_to_num(np.abs(found.values))
    whole = 1.0 if found.measure in SHARES else float(sizes.max(initial=0.0)) or 1.0
    return tuple(
        (name, float(min(size / whole, 1.0)))
        for name, size in zip(names_of(found.table), sizes, strict=True)
    )
