"""Keep or freeze: the decision that reduces a study to the parameters that matter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import StudyError, nearest
from surrogate.estimator import Array
from surrogate.sensitivity.frozen import VarianceKept, variance_kept
from surrogate.sensitivity.importance import TOTAL, importance
from surrogate.sensitivity.model import Analysed, Model, Seed, model
from surrogate.sensitivity.one_at_a_time import base_point, one_at_a_time, quantity
from surrogate.space.space import Space


@dataclass(frozen=True)
class Verdict:
    """The decision on one parameter.

    total, high      largest index that decides over the outputs, and largest upper bound
    worst_case       largest such index should all that a surrogate misses be this parameter's
    one_at_a_time    its largest share of the sum of effects of one parameter at a time
    kept_by_old_rule whether the rule on those shares keeps it for some output
    value            where it is frozen, in the parameter's unit; None when kept
    sentence         the decision and its reason
    """

    parameter: str
    frozen: bool
    total: float
    high: float
    worst_case: float
    one_at_a_time: float
    kept_by_old_rule: bool
    value: float | str | None
    sentence: str


@dataclass(frozen=True)
class Screening:
    """Which parameters to keep, and what that costs.

    refused    why nothing was decided, or empty; then every parameter is kept
    threshold  of the old rule, a share of the sum of effects
    index      what decides, in words
    """

    freeze_below: float
    confidence: float
    outputs: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    variance_kept: tuple[VarianceKept, ...]
    threshold: float
    refused: str = ""
    index: str = TOTAL

    @property
    def keep(self) -> tuple[str, ...]:
        """Parameters to keep, in the space's order."""
        return tuple(v.parameter for v in self.verdicts if not v.frozen)

    @property
    def freeze(self) -> tuple[str, ...]:
        """Parameters to freeze, in the space's order."""
        return tuple(v.parameter for v in self.verdicts if v.frozen)

    @property
    def frozen_values(self) -> dict[str, float | str]:
        """Parameters to freeze and the value at which, in their units."""
        return {v.parameter: v.value for v in self.verdicts if v.value is not None}

    @property
    def kept_by_old_rule(self) -> tuple[str, ...]:
        """What the one-at-a-time rule would have kept."""
        return tuple(v.parameter for v in self.verdicts if v.kept_by_old_rule)

    @property
    def sentences(self) -> tuple[str, ...]:
        """The decision in words: one sentence or two for each parameter, then the old rule's."""
        old = (
            f"The one-at-a-time rule of {self.threshold:.0%} keeps "
            f"{', '.join(self.kept_by_old_rule) or 'nothing'}."
        )
        return (*filter(None, [self.refused]), *(v.sentence for v in self.verdicts), old)

    def summary(self) -> dict[str, Any]:
        """The same as plain numbers and words, for `summary.json`; unknown numbers are None."""
        return {
            "keep": list(self.keep),
            "freeze": list(self.freeze),
            "frozen_values": self.frozen_values,
            "variance_kept": {kept.output: asdict(kept) for kept in self.variance_kept},
            "freeze_below": self.freeze_below,
            "confidence": self.confidence,
            "refused": self.refused,
            "kept_by_old_rule": list(self.kept_by_old_rule),
            "old_rule_threshold": self.threshold,
            "verdicts": [_known(asdict(verdict)) for verdict in self.verdicts],
        }


def decide(
    indices: xr.Dataset,
    freeze_below: float,
    *,
    fits: Mapping[str, Analysed],
    space: Space,
    outputs: Sequence[str] | None = None,
    nominal: Mapping[str, Any] | None = None,
    threshold: float = 0.93,
    samples: int = 2**14,
    draws: int = 100,
    seed: Seed = 0,
) -> Screening:
    """Freeze each parameter whose index has an interval below `freeze_below`.

    indices    dataset of method sobol, or of shapley; the upper end of the interval of the
               index that `surrogate.sensitivity.importance` names decides, for every output
               concerned: the total index, or the largest of three for dependent parameters
    fits       output -> fit (or function of coded points) that the indices were computed of
    outputs    the outputs concerned; default: all in `indices`
    nominal    name -> physical value at which to freeze; default: the middle of the range
    threshold  of the one-at-a-time rule, which is listed beside and decides nothing

    When an output's indices carry a refusal nothing is frozen. Raises `StudyError` for an
    output or index that is not there.
    """
    indices = importance(indices)
    outputs = _concerned(indices, fits, outputs)
    chosen = indices.sel(output=list(outputs))
    at = base_point(space, nominal)
    refused = " ".join(dict.fromkeys(s for s in chosen["refused"].values.tolist() if s))
    old = [one_at_a_time(fits[name], space, base=nominal, threshold=threshold) for name in outputs]
    evidence = chosen.assign(
        one_at_a_time=_over_outputs(old, "share"),
        kept_by_old_rule=_over_outputs(old, "kept_by_share"),
    )
    verdicts = tuple(
        _verdict(evidence.isel(parameter=j), space, at, freeze_below, refused)
        for j in range(space.size)
    )
    frozen = [j for j, verdict in enumerate(verdicts) if verdict.frozen]
    kept = tuple(
        variance_kept(
            _model(fits[name], space, chosen, name),
            frozen,
            at,
            samples=samples,
            draws=draws,
            confidence=indices.attrs["confidence"],
            seed=seed,
        )
        for name in outputs
    )
    return Screening(
        freeze_below,
        indices.attrs["confidence"],
        outputs,
        verdicts,
        kept,
        threshold,
        refused,
        indices.attrs["decides"],
    )


def _concerned(
    indices: xr.Dataset, fits: Mapping[str, Analysed], outputs: Sequence[str] | None
) -> tuple[str, ...]:
    """Names of the outputs concerned, all of which have indices and a fit."""
    there = [str(name) for name in indices["output"].values]
    outputs = tuple(there if outputs is None else outputs)
    for name in outputs:
        if name not in there or name not in fits:
            raise StudyError(f"output '{name}' has no sensitivity indices; {nearest(name, there)}")
    return outputs


def _over_outputs(tables: list[xr.Dataset], name: str) -> xr.DataArray:
    return xr.concat([table[name] for table in tables], "output", join="exact")


def _model(fit: Analysed, space: Space, chosen: xr.Dataset, output: str) -> Model:
    """The model with the Q2 that its indices were judged by."""
    q2 = float(chosen["q2"].sel(output=output))
    return model(fit, space, q2=None if np.isnan(q2) else q2)


def _verdict(
    evidence: xr.Dataset, space: Space, at: Array, freeze_below: float, refused: str
) -> Verdict:
    """Decide on one parameter; evidence has dimension output."""
    name = str(evidence["parameter"].item())
    high = evidence["total_high"]
    worst = str(high["output"].values[np.argmax(high.values)])
    frozen = not refused and bool((high < freeze_below).all())
    j = space.names.index(name)
    sentence = _sentence(
        evidence.sel(output=worst), quantity(space[name], at[j]), freeze_below, frozen, refused
    )
    return Verdict(
        parameter=name,
        frozen=frozen,
        total=float(evidence["total"].max()),
        high=float(high.max()),
        worst_case=float(evidence["total_worst"].max(skipna=False)),
        one_at_a_time=float(evidence["one_at_a_time"].max()),
        kept_by_old_rule=bool(evidence["kept_by_old_rule"].any()),
        value=space[name].decode(at[j]).item() if frozen else None,
        sentence=sentence,
    )


def _sentence(row: xr.Dataset, value: str, freeze_below: float, frozen: bool, refused: str) -> str:
    """The decision on one parameter and its reason, from the output where it matters most."""
    name, output, index = (row[key].item() for key in ("parameter", "output", "index"))
    total, low, high = (float(row[key]) for key in ("total", "total_low", "total_high"))
    if refused:
        return f"{name}: keep, because its indices cannot be trusted."
    if frozen:
        return (
            f"{name}: freeze at {value}. Its {index} is at most {high:.2g} ({output}), "
            f"below {freeze_below:g}."
        )
    if low >= freeze_below:
        return f"{name}: keep. Its {index} is {total:.2g} and at least {low:.2g} ({output})."
    missed = 1.0 - float(row["q2"])
    cause = (
        f"the surrogate misses {missed:.1%} of the variance; a more accurate surrogate may decide"
        if missed > 0.5 * freeze_below
        else "more samples or more runs may decide"
    )
    return (
        f"{name}: keep, undecided. Its {index} is {total:.2g}, at most {high:.2g} ({output}), "
        f"and the limit is {freeze_below:g}: {cause}."
    )


def _known(values: dict[str, Any]) -> dict[str, Any]:
    """Numbers that are not known as None, for JSON."""
    return {
        key: None if isinstance(value, float) and np.isnan(value) else value
        for key, value in values.items()
    }
