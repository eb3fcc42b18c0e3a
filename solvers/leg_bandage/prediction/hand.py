"""The bandager's hand: how the pressure scatters with stretch and overlap as laid.

The same two-layer bandage put again and again on one leg model gave 34.65 +- 4.84 mmHg
(Wounds 2020;32(12):353-363): a coefficient of variation of 14 %, with the leg left out. An
experienced bandager on one leg stayed below 7 mmHg of standard deviation for six bandages
(Lee et al. 2006, doi 10.1016/j.ejvs.2005.10.023), and one on ten legs had 10.6 to 18.2 % at
B1, legs included (Ehmann et al. 2023, doi 10.25270/wmp.2023.2.22072).

How much of it is stretch and how much overlap is not in print. Half of the variance each is
assumed, which gives, at stretch 1.3 and half overlap, SDs of 0.030 and 0.049 (5 mm of 100 mm).
Pressure goes with the tension, K1 (stretch - 1), and with the layers, 1 / (1 - overlap).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from ..bandage.products import STRETCH

MEASURED = 4.84 / 34.65
"""Coefficient of variation of the pressure, one leg model, many applications."""
OVERLAP = 0.5
"""Two layers: what the stored runs are laid with."""
LEAST_STRETCH, OVERLAPS = 1.01, (0.05, 0.9)
"""No hand lays a bandage slacker, or nearly without or wholly on the turn before."""
DRAWS = 1024


@dataclass(frozen=True)
class Hand:
    """Standard deviations of stretch and overlap about what was meant, normal."""

    stretch_sd: float = MEASURED / np.sqrt(2) * (STRETCH - 1)
    overlap_sd: float = MEASURED / np.sqrt(2) * (1 - OVERLAP)

    def factors(self, stretch: float, overlap: float = OVERLAP) -> np.ndarray:
        """(DRAWS,) by which the pressure differs from that of what was meant.

        A scrambled Sobol' sequence of one seed: the same digits for the same hand.
        """
        return self.spread(normals(2), stretch, overlap)

    def spread(self, draws: np.ndarray, stretch: float, overlap: float) -> np.ndarray:
        """The same for standard normal draws (n, 2) of stretch and overlap."""
        laid = np.maximum(stretch + self.stretch_sd * draws[:, 0], LEAST_STRETCH)
        over = np.clip(overlap + self.overlap_sd * draws[:, 1], *OVERLAPS)
        return (laid - 1) / (stretch - 1) * (1 - overlap) / (1 - over)

    def interval(self, stretch: float, confidence: float) -> tuple[float, float]:
        """Lowest and highest factor, less one, of the middle `confidence` of the draws."""
        tail = (1 - confidence) / 2
        low, high = np.quantile(self.factors(stretch), [tail, 1 - tail])
        return min(float(low) - 1, 0.0), max(float(high) - 1, 0.0)


PUBLISHED = Hand()


def normals(columns: int, seed: int = 1) -> np.ndarray:
    """(DRAWS, columns) standard normal numbers of a Sobol' sequence."""
    return ndtri(uniforms(columns, seed))


def uniforms(columns: int, seed: int = 1) -> np.ndarray:
    """(DRAWS, columns) numbers between 0 and 1 of a scrambled Sobol' sequence."""
    return qmc.Sobol(columns, rng=np.random.default_rng(seed)).random(DRAWS)
