"""Tissue that swells: its forces, its volume, and which of it is muscle."""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.equilibrium.model import ABOVE, BELOW, Mesh, mesh_leg
from surrogate_solvers.leg_bandage.geometry.bone import bone_envelope
from surrogate_solvers.leg_bandage.tissue.neo_hooke import Tissue
from surrogate_solvers.leg_bandage.tissue.posture import muscle_share
from surrogate_solvers.leg_bandage.verification.legs import validation_leg
from surrogate_solvers.leg_bandage.verification.newton import held, newton
from surrogate_solvers.leg_bandage.verification.thick_cylinder import INNER, OUTER, annulus


def test_forces_of_grown_tissue_are_those_of_its_energy():
    """dE/du by differences, with growth and stiffness that change from element to element."""
    leg = annulus(6, 2)
    rng = np.random.default_rng(1)
    tissue = Tissue(leg.mesh, 5e-3, 0.5)
    tissue.grow(1 + 0.1 * rng.random(len(tissue.volumes)), 1 + rng.random(len(tissue.volumes)))
    u = rng.normal(0, 0.1, leg.n_dofs)
    force, _ = tissue.linearise(u)
    for dof in (3, 40, 77):
        h = 1e-5 * np.eye(leg.n_dofs)[dof]
        slope = (tissue.energy(u + h) - tissue.energy(u - h)) / 2e-5
        assert force[dof] == pytest.approx(slope, rel=1e-5, abs=1e-9)


def test_a_pinned_tube_grows_by_its_volume():
    """b^2 = A^2 + J (B^2 - A^2) when the hole is held, whatever the stiffness: 0.02 %."""
    leg = annulus(64, 12)
    tissue = Tissue(leg.mesh, 5e-3, 1430.0)
    tissue.grow(1.055, 2.0)
    u, _ = newton([tissue], held(leg.n_dofs, leg.fixed_dofs("no_axial")))
    places = (leg.mesh.p.T + u.reshape(-1, 3))[leg.skin.ravel()]
    exact = np.sqrt(INNER**2 + 1.055 * (OUTER**2 - INNER**2))
    assert np.hypot(*places[:, :2].T).mean() - OUTER == pytest.approx(exact - OUTER, rel=3e-3)


def test_growing_back_leaves_the_first_tissue():
    """Volumes and stiffness come back to the last digit."""
    tissue = Tissue(annulus(6, 2).mesh, 5e-3, 14.3)
    volumes, c10 = tissue.volumes, tissue.c10
    tissue.grow(1.05, 3.0)
    tissue.grow(1.0)
    assert np.array_equal(tissue.volumes, volumes) and np.array_equal(tissue.c10, c10)


def test_the_muscles_of_the_back_are_behind():
    """Nearly all of an element right behind the axis, none in front, half of the leg in all."""
    leg = validation_leg(0).extended(BELOW, ABOVE)
    mesh = mesh_leg(leg, bone_envelope(leg), Mesh(24, 2, 12, 6))
    share = muscle_share(mesh)
    centres = mesh.mesh.p[:, mesh.mesh.t].mean(axis=1)
    assert np.all(share[centres[1] < np.quantile(centres[1], 0.1)] > 0.9)
    assert np.all(share[centres[1] > np.quantile(centres[1], 0.9)] < 0.1)
    volumes = Tissue(mesh.mesh, 5e-3, 14.3).volumes
    assert 0.45 < volumes @ share / volumes.sum() < 0.75
