"""Legs with sections of their own as cases of a validation: pressure, coordinates, error."""

from dataclasses import replace

import numpy as np
import pytest

from surrogate.conformance import check_solver
from surrogate.errors import SolverError, StudyError
from surrogate_solvers.laplace import Laplace, laplace_b1
from surrogate_solvers.leg_bandage.geometry.basis import reconstruction_errors, shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort, write_cohort
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.patient_solver import LegBandagePatient
from surrogate_solvers.leg_bandage.plugin import LegBandage


def leg_of(cohort, number):
    return Leg.from_sections(
        cohort.length[number - 1], cohort.coefficients[number - 1], cohort.centre[number - 1]
    )


def few_legs(path, number=6):
    """A file with the first of the validation legs."""
    legs = load_cohort("val")
    few = replace(
        legs,
        coefficients=legs.coefficients[:number],
        centre=legs.centre[:number],
        length=legs.length[:number],
        facts={},
    )
    write_cohort(path, few)
    return few


def test_the_shipped_legs_are_levels():
    """38 validation legs and the two named bandages, by name."""
    solver = LegBandagePatient()
    check_solver(solver, runs=0)
    assert solver.inputs["leg"].levels[:2] == ("patient_01", "patient_02")
    assert len(solver.inputs["leg"].levels) == 38
    assert solver.inputs["bandage"].levels == ("biflex_16", "biflex_17")
    with pytest.raises(SolverError, match="leg: 'patient_7' is unknown: did you mean"):
        solver(leg="patient_7")


def test_a_patient_is_a_run_on_its_own_sections(rough, solved_once):
    """The pressure is `LegBandage.run(leg)`'s; what is told of the leg is the basis's word.

    Told: equation 10, T = K1 (stretch - 1); coordinates by projection; the error over the
    points of the skin; Laplace's law on the leg's own sections.
    """
    legs, basis = load_cohort("val"), shipped_basis()
    told = LegBandagePatient(mesh="rough")(leg="patient_03", bandage="biflex_17", stretch=1.2)
    leg = leg_of(legs, 3)
    solved = LegBandage(mesh="rough", fabric="biflex_17")
    own = solved.run(leg, stretch=1.2).values
    assert told["pressure_b1"] == own["pressure_b1"]
    assert np.array_equal(told["pressure_field"], own["pressure_field"])
    assert told["tension"] == pytest.approx(0.1175 * 0.2 / 0.3, rel=1e-12)
    alphas = basis.project(legs.snapshots().T)[2]
    assert [told[f"alpha{k}"] for k in (1, 2, 3, 4)] == pytest.approx(alphas, rel=1e-12)
    assert told["leg_length"] == legs.length[2]
    away = reconstruction_errors(basis, legs)[1][2]
    assert told["shape_error"] == pytest.approx(np.sqrt(np.mean(away**2)), rel=1e-9)
    assert told["pressure_laplace"] == laplace_b1(leg, told["tension"])[0]


def test_legs_of_ones_own(tmp_path):
    """A file of legs gives the levels, another the basis; identity follows the legs."""
    few = few_legs(tmp_path / "mine.npz")
    solver = LegBandagePatient(legs="mine.npz", folder=tmp_path)
    assert solver.inputs["leg"].levels == tuple(f"patient_{i:02d}" for i in range(1, 7))
    assert solver.inputs["leg"].source == "mine.npz"
    assert np.array_equal(solver.basis.modes, shipped_basis().modes)
    based = LegBandagePatient(legs="mine.npz", cohort="mine.npz", folder=tmp_path)
    assert not np.array_equal(based.basis.modes, shipped_basis().modes)
    identities = [s.identity_options for s in (LegBandagePatient(), solver, based)]
    assert identities[0] != identities[1] != identities[2]
    assert identities[1]["legs"] == few.identity == identities[2]["cohort"]
    with pytest.raises(StudyError, match="legs: .*none.npz is not a file of legs"):
        LegBandagePatient(legs="none.npz", folder=tmp_path)


def test_laplace_on_a_basis_of_ones_own(tmp_path):
    """Coordinates are read in the basis of the file's legs: six legs in four modes are near.

    Laplace's pressure on the leg of four modes is within 5 % of that on its own sections.
    """
    few = few_legs(tmp_path / "mine.npz")
    solver = Laplace(cohort="mine.npz", folder=tmp_path)
    for number in (1, 2, 3):
        told = solver(0.2, 0.1, few.length[number - 1], *solver.basis.training[number - 1])
        own, _, _ = laplace_b1(leg_of(few, number), 0.1)
        assert told["pressure_b1"] == pytest.approx(own, rel=0.05)
    assert solver.inputs["alpha1"].nominal == pytest.approx(solver.basis.mean[0], abs=5e-5)
    assert solver.identity_options["cohort"] == few.identity
