"""What a fabric remembers of its forces: the convolution of a Prony series, step by step.

With the elastic force N_e straight in time over a step of h,

    N(t + h) = g_inf N_e(t + h) + sum_i q_i(t + h)
    q_i(t + h) = exp(-h / tau_i) q_i(t) + g_i b_i [N_e(t + h) - N_e(t)]
    b_i = tau_i / h (1 - exp(-h / tau_i))

which is exact for such a history (Taylor, Pister, Goudreau 1970): a held stretch relaxes by g
whatever the step. In a step N = a N_e + carried, so that Newton sees an elastic fabric, softer
by a = g_inf + sum g_i b_i, under forces that do not change.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .relaxation import Relaxation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Memory:
    """The forces of a fabric until now.

    elastic  (3, ...) N1, N2, S that a fabric without memory would have, N/mm
    terms    (k, 3, ...) q_i of the series' terms
    share    a of the step that is being taken; carried (3, ...) its forces
    """

    series: Relaxation
    elastic: Array
    terms: Array
    share: float
    carried: Array
    decay: Array
    taken: Array

    @classmethod
    def of(cls, series: Relaxation, elastic: Array) -> Memory:
        """A fabric that has just been stretched, at once, and waits for a step of no time."""
        terms = _times(np.array(series.shares), elastic[None])
        return cls(series, elastic, terms, 1.0, elastic, np.empty(0), np.empty(0)).waiting(0.0)

    def waiting(self, minutes: float) -> Memory:
        """The memory at the start of a step of so many minutes; 0: a change at once."""
        shares, x = np.array(self.series.shares), minutes / np.array(self.series.times)
        decay = np.exp(-x)
        taken = shares * np.divide(-np.expm1(-x), x, where=x > 0, out=np.ones_like(x))
        carried = np.tensordot(decay, self.terms, 1) - taken.sum() * self.elastic
        share = 1 - shares.sum() + taken.sum()
        return replace(self, share=float(share), carried=carried, decay=decay, taken=taken)

    def part(self, elements: slice) -> Memory:
        """The same of some elements, for a step that has begun."""
        return replace(self, carried=self.carried[..., elements])

    def after(self, elastic: Array) -> Memory:
        """The memory at the end of the step, waiting for a change at once."""
        change = elastic - self.elastic
        terms = _times(self.decay, self.terms) + _times(self.taken, change[None])
        return replace(self, elastic=elastic, terms=terms).waiting(0.0)


def _times(factors: Array, fields: Array) -> Array:
    """Fields (k or 1, ...), each times its factor (k,)."""
    return np.asarray(factors.reshape(-1, *(1,) * (fields.ndim - 1)) * fields)
