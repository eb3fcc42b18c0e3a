"""Tissue and bandage against known answers, and what their assembly and solution cost.

Run: python benchmarks/verification_material.py [--fine]

Without options about 20 s. `--fine` adds the finer meshes (about a minute more). The timings
are those of the machine that runs it; set OMP_NUM_THREADS to say on how many cores.
"""

from __future__ import annotations

import argparse
import importlib.util
from time import perf_counter

import numpy as np

from surrogate_solvers.leg_bandage.algebra.system import System
from surrogate_solvers.leg_bandage.bandage.fabric import Fabric
from surrogate_solvers.leg_bandage.bandage.products import NOMINAL
from surrogate_solvers.leg_bandage.bandage.shell import Shell
from surrogate_solvers.leg_bandage.surfaces.strip import Strip
from surrogate_solvers.leg_bandage.tissue.mesh import cylindrical_surface, leg_mesh
from surrogate_solvers.leg_bandage.tissue.neo_hooke import Tissue
from surrogate_solvers.leg_bandage.verification.plates import (
    cantilever,
    laid,
    off_axis_modulus,
    pinched_cylinder,
)
from surrogate_solvers.leg_bandage.verification.thick_cylinder import (
    hooped,
    hooped_exactly,
    pressed,
    pressed_exactly,
)

MMHG = 1.33322e-4


def main() -> None:
    """Print the table of checks, then the timings."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fine", action="store_true", help="finer meshes as well")
    fine = parser.parse_args().fine
    print(f"{'check':58} {'answer':>12} {'ours':>12} {'off by':>9}")
    for check, answer, ours in checks(fine):
        print(f"{check:58} {answer:12.6g} {ours:12.6g} {ours / answer - 1:+9.3%}")
    print()
    timings()


def checks(fine: bool):
    """Yield (what, answer, ours) for each check."""
    yield from thick_cylinder(fine)
    yield from hoop_bands()
    yield from shells(fine)


def thick_cylinder(fine: bool):
    """Pressed from outside in plane strain: hole free (meshes refined), then pinned."""
    for kilopascal in (1, 4, 8):
        exact = pressed_exactly(1e-3 * kilopascal, 5e-3)
        for n in (16, 32, 64, 128) if fine else (16, 32, 64):
            found = pressed(1e-3 * kilopascal, 5e-3, n_theta=n, n_depth=n // 4)
            mesh = f"{n} x {n // 4}, {len(found.corrections)} iterations"
            yield f"V1 {kilopascal} kPa, u_out mm, {mesh}", exact.outer, found.outer
            yield f"V1 {kilopascal} kPa, u_in mm, {mesh}", exact.inner, found.inner
    for c10 in (2, 5, 8):
        exact = pressed_exactly(4e-3, 1e-3 * c10, pinned=True)
        found = pressed(4e-3, 1e-3 * c10, pinned=True)
        yield f"V1b 4 kPa, c10 = {c10} kPa, u_out mm, 64 x 16", exact.outer, found.outer


def hoop_bands():
    """Band around the annulus; kappa a hundredfold, since the answer is incompressible."""
    for K1, layers in ((0.326667, 2), (0.196667, 1), (0.456667, 2)):
        exact = hooped_exactly(K1, layers, 47 / 1.3, 5e-3)
        found = hooped(K1, layers, 47 / 1.3, 5e-3, kappa=1430.0)
        case = f"V3 K1 = {K1}, {layers} layers, 48 x 12"
        yield f"{case}, radius mm", exact.radius, found.radius
        yield f"{case}, stretch", exact.stretch, found.stretch
        yield f"{case}, mmHg", exact.pressure / MMHG, found.pressure / MMHG


def shells(fine: bool):
    """Pinched cylinder, cantilever, off-axis membrane."""
    for n in (16, 32, 64, 128) if fine else (16, 32, 64):
        yield f"V10 pinched cylinder, E t / P w, {n} x {n}", 164.24, pinched_cylinder(n)
    for n in (16, 32, 64):
        u = cantilever(n)
        yield f"V10 cantilever, alpha = 4, -U mm, {n} elements", 3.286, -u[0]
        yield f"V10 cantilever, alpha = 4, W mm, {n} elements", 6.698, u[2]
    fabric = Fabric(K1=0.33, K2=0.1, nu12=0.3, G=0.05, F1=0.01, F2=0.01, tau12=0.01)
    for degrees in (0, 30, 60, 90):
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        answer = 1 / (c**4 / 0.33 + s**4 / 0.1 + c**2 * s**2 * (1 / 0.05 - 2 * 0.3 / 0.33))
        found = off_axis_modulus(fabric, np.radians(degrees))
        yield f"V10 off-axis membrane, {degrees} degrees, N/mm", answer, found


def timings() -> None:
    """Assembly per 10 000 unknowns, and factorisation of the leg alone."""
    leg = leg_mesh(
        cylindrical_surface(47.0), cylindrical_surface(15.0), np.linspace(0, 290, 29), 48, 5, 2.0
    )
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    strip, size = Strip(260, 20), (1300.0, 100.0)
    start = laid(strip, size) * [1.3, 1, 1]
    shell = Shell(strip, size, NOMINAL, start)
    for name, part in (("tissue", tissue), ("shell", shell)):
        u = np.zeros(part.n_dofs)
        best = shortest(lambda part=part, u=u: part.linearise(u)[1]())
        print(
            f"{name}: {part.n_dofs} unknowns, residual and tangent {1e3 * best:.0f} ms, "
            f"{1e7 * best / part.n_dofs:.0f} ms per 10 000 unknowns"
        )
    engines = ["superlu"] + ["pardiso"] * (importlib.util.find_spec("pypardiso") is not None)
    for engine in engines:
        begin = perf_counter()
        system = System([tissue], tissue.n_dofs, leg.fixed_dofs(), engine)
        setup = perf_counter() - begin
        packed = system.pack(system.linearise(np.zeros(tissue.n_dofs))[1]())
        direct = system.factors.direct
        direct.factorise(packed)
        whole = shortest(lambda s=system: s.pack(s.linearise(np.zeros(tissue.n_dofs))[1]()))
        again = shortest(lambda d=direct, p=packed: d.factorise(p))
        ones = np.ones(len(system.free))
        solve = shortest(lambda d=direct, b=ones: d.solve(b))
        print(
            f"leg, {engine}: pattern {setup:.2f} s, assembled {whole:.3f} s, "
            f"factorised {again:.2f} s, solved {solve:.3f} s"
        )


def shortest(action, repeats: int = 5) -> float:
    """Least time of a few calls, s."""
    times = []
    for _ in range(repeats):
        begin = perf_counter()
        action()
        times.append(perf_counter() - begin)
    return min(times)


if __name__ == "__main__":
    main()
