"""Leg shapes in a few numbers: proper orthogonal decomposition of a cohort.

The method of Chassagne et al. 2018: a leg is its 1 300 section numbers divided by
its length; the snapshots are decomposed by SVD without taking out their mean, so
that the first mode is close to the mean leg and every leg is sum of alpha_k phi_k.

The paper does not state its norm. Here <u, v> = 0.1 sum(u v): with this factor the
first coordinate of the shipped cohort has the size that the paper prints. The
factor cancels wherever alphas are coded to [-1, 1].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from .cohort import Cohort, load_cohort, sections_of

INNER = 0.1
"""<u, v> = INNER * sum(u v)."""


@dataclass(frozen=True)
class Basis:
    """Orthonormal shape modes and where the legs they were learnt from lie.

    modes      (1300, K), <mode_i, mode_j> = delta_ij
    training   (leg, K) coordinates of the training legs
    singular   (min(1300, leg),) singular values of all modes, kept and dropped, in this norm
    """

    modes: np.ndarray
    training: np.ndarray
    singular: np.ndarray

    @property
    def ranges(self) -> np.ndarray:
        """(K, 2): smallest and largest coordinate among the training legs."""
        return np.column_stack([self.training.min(axis=0), self.training.max(axis=0)])

    @property
    def mean(self) -> np.ndarray:
        """(K,): coordinates of the mean training leg."""
        return self.training.mean(axis=0)

    def project(self, snapshots: np.ndarray) -> np.ndarray:
        """Coordinates (..., K) of snapshots (..., 1300)."""
        return INNER * snapshots @ self.modes

    def reconstruct(self, alphas: np.ndarray) -> np.ndarray:
        """Snapshots (..., 1300) of coordinates (..., K); fewer than K coordinates are allowed."""
        alphas = np.asarray(alphas, float)
        return alphas @ self.modes[:, : alphas.shape[-1]].T


def fit_basis(snapshots: np.ndarray, n_modes: int) -> Basis:
    """Basis of the n_modes largest modes of snapshots (1300, leg).

    Signs: alpha1 is negative, as in the paper; for every other mode the coordinate
    of largest magnitude among the training legs is positive.
    """
    left, singular, right = np.linalg.svd(snapshots, full_matrices=False)
    training = np.sqrt(INNER) * (singular[:n_modes, None] * right[:n_modes]).T
    extreme = training[np.abs(training).argmax(axis=0), np.arange(n_modes)]
    sign = np.sign(extreme)
    sign[0] = -np.sign(training[:, 0].sum())
    return Basis(
        left[:, :n_modes] * sign / np.sqrt(INNER), training * sign, np.sqrt(INNER) * singular
    )


@cache
def shipped_basis(n_modes: int = 4) -> Basis:
    """Basis of the 35 shipped training legs; the paper keeps 4 modes."""
    return fit_basis(load_cohort("train").snapshots(), n_modes)


def reconstruction_errors(
    basis: Basis, cohort: Cohort, angles: int = 100
) -> tuple[np.ndarray, np.ndarray]:
    """What the basis loses of each leg, mm, at (leg, section, angle).

    Returns the error of the radius about the section's own centre, |dr|, and the
    distance between the points of the same angle, which sees the centre line too.
    """
    theta = 2 * np.pi * np.arange(angles) / angles
    order = np.arange(1, 6)
    harmonics = np.concatenate(
        [np.ones((1, angles)), np.cos(np.outer(order, theta)), np.sin(np.outer(order, theta))]
    )
    original = cohort.snapshots().T
    lost = basis.reconstruct(basis.project(original)) - original
    coefficients, centre = sections_of(lost, cohort.length)
    radius = coefficients @ harmonics
    points = radius[..., None] * np.column_stack([np.cos(theta), np.sin(theta)])
    return np.abs(radius), np.linalg.norm(points + centre[:, :, None, :], axis=-1)
