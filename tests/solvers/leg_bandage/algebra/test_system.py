"""Triplets to one sparse system, and its direct solution."""

import importlib
import sys

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.algebra import direct
from surrogate_solvers.leg_bandage.algebra.direct import DirectSolver
from surrogate_solvers.leg_bandage.algebra.reused_factors import SHARE, ReusedFactors, gmres
from surrogate_solvers.leg_bandage.algebra.system import System, compress
from surrogate_solvers.leg_bandage.bandage.products import NOMINAL
from surrogate_solvers.leg_bandage.bandage.shell import Shell
from surrogate_solvers.leg_bandage.surfaces.strip import Strip
from surrogate_solvers.leg_bandage.tissue.mesh import cylindrical_surface, leg_mesh
from surrogate_solvers.leg_bandage.tissue.neo_hooke import Tissue
from surrogate_solvers.leg_bandage.verification.plates import laid

ENGINES = ["superlu"] + (["pardiso"] if direct.engine_class("auto") is direct.Pardiso else [])


class Random:
    """Part with a random pattern and values that change at each call."""

    def __init__(self, n, nnz, seed):
        self.rng = np.random.default_rng(seed)
        diagonal = np.arange(n)
        self.rows = np.concatenate([diagonal, self.rng.integers(0, n, nnz)])
        self.cols = np.concatenate([diagonal, self.rng.integers(0, n, nnz)])
        self.n = n

    def linearise(self, u):
        values = self.rng.normal(size=len(self.rows))
        values[: self.n] += 20.0
        self.dense = np.zeros((self.n, self.n))
        np.add.at(self.dense, (self.rows, self.cols), values)
        return self.dense @ u, lambda: values


def test_compressed_columns_equal_the_dense_sum():
    """Every triplet lands once, duplicates add up, indices are sorted in each column."""
    rng = np.random.default_rng(0)
    rows, cols = rng.integers(-1, 30, (2, 2000))
    values = rng.normal(size=2000)
    pattern, slots = compress(rows, cols, 30)
    kept = (rows >= 0) & (cols >= 0)
    dense = np.zeros((30, 30))
    np.add.at(dense, (rows[kept], cols[kept]), values[kept])
    pattern.data = np.bincount(slots, values, minlength=pattern.nnz + 1)[:-1]
    np.testing.assert_allclose(pattern.toarray(), dense, atol=1e-13)
    assert pattern.has_sorted_indices
    assert np.all(slots[~kept] == pattern.nnz)


@pytest.mark.parametrize("engine", ENGINES)
def test_solution_equals_dense_elimination_for_changing_values(engine):
    """Three factorisations on one pattern, unsymmetric, with fixed dofs, against LAPACK."""
    n, fixed = 60, np.array([3, 17, 59])
    parts = [Random(n, 400, 1), Random(n, 100, 2)]
    system = System(parts, n, fixed, engine)
    free = np.setdiff1d(np.arange(n), fixed)
    rng = np.random.default_rng(3)
    for _ in range(3):
        u, rhs = rng.normal(size=(2, n))
        residual, tangent = system.linearise(u)
        dense = parts[0].dense + parts[1].dense
        np.testing.assert_allclose(residual, dense @ u, rtol=1e-12)
        expected = np.linalg.solve(dense[np.ix_(free, free)], rhs[free])
        found = system.solve(system.pack(tangent()), rhs)
        left = dense[np.ix_(free, free)] @ (found[free] - expected)
        assert np.linalg.norm(left) <= SHARE * np.linalg.norm(rhs[free])
        assert np.all(found[fixed] == 0)


def with_condition(condition, n=40):
    """A symmetric matrix (n, n) with eigenvalues from 1 down to 1 / condition."""
    vectors = np.linalg.qr(np.random.default_rng(7).normal(size=(n, n)))[0]
    return vectors * np.geomspace(1, 1 / condition, n) @ vectors.T


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("condition", [1e2, 1e4, 1e6, 1e9, 1e13])
def test_single_precision_factors_give_double_precision_answers(engine, condition):
    """Wilkinson 1963: refinement converges while condition times 2^-24 is below 1.

    There 1e-12 of the right-hand side is left, and the error is the condition times that;
    beyond, double-precision factors take over and leave no more than 1e-9.
    """
    dense = with_condition(condition)
    n = len(dense)
    rows, cols = (axis.ravel() for axis in np.meshgrid(np.arange(n), np.arange(n)))
    pattern, slots = compress(rows, cols, n)
    solver = DirectSolver(engine, pattern)
    expected = np.random.default_rng(8).normal(size=n)
    rhs = dense @ expected
    for _ in range(2):
        solver.factorise(np.bincount(slots, dense[rows, cols]))
        found = solver.solve(rhs)
        left = np.abs(dense @ found - rhs).max() / np.abs(rhs).max()
        if condition < 1e6:
            assert left < 2e-12
            assert np.abs(found - expected).max() < 1e-11 * condition
        assert left < 1e-9


@pytest.mark.parametrize("engine", ENGINES)
def test_factors_are_kept_while_they_serve(engine):
    """A matrix that drifts is solved to SHARE with one factorisation; another one needs new ones.

    With A = B + E of rank one GMRES preconditioned by B ends in two iterations (the
    preconditioned matrix has two distinct eigenvalues; Saad and Schultz 1986, proposition 2).
    """
    rng = np.random.default_rng(11)
    n = 60
    rows, cols = (axis.ravel() for axis in np.indices((n, n)))
    pattern, slots = compress(rows, cols, n)
    solver = ReusedFactors(engine, pattern)
    first = np.eye(n) * 4 + rng.normal(size=(n, n)) / n
    near = first + np.outer(rng.normal(size=n), rng.normal(size=n)) / 4
    far = rng.normal(size=(n, n))
    for dense, factorisations in ((first, 1), (near, 1), (1.001 * near, 1), (far, 2)):
        rhs = rng.normal(size=n)
        found = solver.solve(np.bincount(slots, dense[rows, cols]), rhs)
        assert np.linalg.norm(dense @ found - rhs) <= 1.001 * SHARE * np.linalg.norm(rhs)
        assert solver.factorisations == factorisations
    inverse = np.linalg.inv(first)
    assert gmres(near, rng.normal(size=n), lambda r: inverse @ r)[1] == 2


@pytest.mark.parametrize("engine", ENGINES)
def test_the_same_system_gives_the_same_digits(engine):
    """Two engines of a kind on one matrix: not one bit differs."""
    answers = []
    for _ in range(2):
        part = Random(200, 2000, 5)
        system = System([part], 200, solver=engine)
        packed = (system.pack(system.linearise(np.zeros(200))[1]()) for _ in range(2))
        answers += [system.solve(one, np.arange(200.0)) for one in packed]
    assert np.array_equal(answers[0], answers[2]) and np.array_equal(answers[1], answers[3])


@pytest.mark.parametrize("engine", ENGINES)
def test_digits_do_not_depend_on_the_number_of_threads(engine):
    """A leg and a bandage, 10 000 unknowns, assembled and solved on one thread and on two."""
    leg = leg_mesh(
        cylindrical_surface(47.0), cylindrical_surface(15.0), np.linspace(0, 200, 21), 36, 2
    )
    strip, size = Strip(60, 10, offset=leg.mesh.nvertices), (300.0, 100.0)
    start = np.vstack([leg.mesh.p.T, laid(strip, size) * [1.3, 1, 1]])
    parts = [
        Tissue(leg.mesh, 5e-3, 14.3, start.size),
        Shell(strip, size, NOMINAL, start),
        Diagonal(start.size),
    ]
    u = np.random.default_rng(0).normal(0, 0.01, start.size)
    answers = []
    for threads in (1, 2):
        with threadpool_limits(limits=threads):
            system = System(parts, start.size, leg.fixed_dofs(), engine)
            residual, tangent = system.linearise(u)
            packed = system.pack(tangent())
            answers.append(
                (
                    residual,
                    packed,
                    system.solve(packed, residual),
                    system.solve(1.01 * packed, residual),
                )
            )
    for one, two in zip(*answers, strict=True):
        assert np.array_equal(one, two)


class Diagonal:
    """Part with a small spring on each dof."""

    def __init__(self, n):
        self.rows = self.cols = np.arange(n)

    def linearise(self, u):
        return 1e-3 * u, lambda: np.full(u.size, 1e-3)


def test_a_loose_body_is_reported_as_singular():
    """A matrix of zeros: SuperLU says so in a sentence, not a traceback."""
    pattern, _ = compress(np.arange(4), np.arange(4), 4)
    with pytest.raises(SolverError, match="singular"):
        DirectSolver("superlu", pattern).factorise(np.zeros(4))


def test_unknown_engine_is_named():
    """The sentence offers the nearest spelling."""
    pattern, _ = compress(np.arange(2), np.arange(2), 2)
    with pytest.raises(SolverError, match="did you mean 'pardiso'"):
        DirectSolver("paradiso", pattern)


@pytest.fixture
def no_library(monkeypatch):
    """pypardiso is there, MKL's library is not."""

    def fails(name):
        raise ImportError("Shared library mkl_rt not found.")

    monkeypatch.setattr(importlib, "import_module", fails)
    monkeypatch.setattr(direct, "mkl_library", lambda: None)
    direct.pypardiso.cache_clear()
    yield
    direct.pypardiso.cache_clear()


def test_without_the_library_of_mkl_auto_is_superlu(no_library):
    """`auto` solves all the same; `pardiso` by its name is refused with the cure."""
    pattern, _ = compress(np.arange(2), np.arange(2), 2)
    solver = DirectSolver("auto", pattern)
    solver.factorise(np.array([2.0, 4.0]))
    np.testing.assert_allclose(solver.solve(np.array([1.0, 1.0])), [0.5, 0.25])
    assert direct.engine_class("auto") is direct.SuperLU
    with pytest.raises(SolverError, match="mkl_rt not found.*pip install.*PYPARDISO_MKL_RT"):
        DirectSolver("pardiso", pattern)


@pytest.mark.parametrize("name", ["libmkl_rt.so.2", "libmkl_rt.so.3", "mkl_rt.2.dll"])
def test_the_library_of_mkl_is_found_by_its_package(tmp_path, monkeypatch, name):
    """Beside the site-packages that holds the package `mkl`, whatever the number in its name."""
    site = tmp_path / "lib" / "python3" / "site-packages"
    (site / "mkl-1.dist-info").mkdir(parents=True)
    (site / "mkl-1.dist-info" / "METADATA").write_text("Name: mkl\nVersion: 1\n")
    (site / "mkl-1.dist-info" / "RECORD").write_text(f"../../{name},,\n../../libmkl_core.so.2,,\n")
    (tmp_path / "lib" / name).touch()
    monkeypatch.setattr(sys, "path", [str(site)])
    assert direct.mkl_library().resolve() == (tmp_path / "lib" / name).resolve()
    (tmp_path / "lib" / name).unlink()
    assert direct.mkl_library() is None
