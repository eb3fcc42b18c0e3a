"""The bandage's contact against exact answers: `python benchmarks/verification_contact.py`.

Prints checks V2 to V9 and V16 (README.md of `solvers/leg_bandage`); a minute and a half. V1 and
V10 are printed by `verification_material.py`, V12 by `convergence.py`, V13 by `smoothness.py`.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from surrogate_solvers.leg_bandage.outputs.pressure_map import MMHG
from surrogate_solvers.leg_bandage.verification.bands import (
    band_on_cylinder,
    band_on_padding,
    band_on_soft_tube,
    bands_on_soft_tube,
    capstan,
    slide_down_cone,
    spiral_exactly,
    spiral_on_cylinder,
    stretches_on_cone,
    string_on_ellipse,
    two_bandages_on_cylinder,
)
from surrogate_solvers.leg_bandage.verification.flat_patch import press, settlement_exactly
from surrogate_solvers.leg_bandage.verification.thick_cylinder import banded_exactly, hooped_exactly


def main() -> None:
    """Print the numbers that have an exact one, then those that are bounds."""
    print(f"{'check':62} {'answer':>10} {'ours':>10} {'off by':>9}")
    for check, answer, ours in numbers():
        print(f"{check:62} {answer:10.5g} {ours:10.5g} {ours / answer - 1:+9.3%}", flush=True)
    print()
    for line in bounds():
        print(line, flush=True)


def numbers():
    """Yield (what, answer, ours)."""
    for tension in (0.059, 0.098, 0.137):
        found = band_on_cylinder(tension)
        yield (
            f"V2 band on a rigid cylinder, T = {tension} N/mm, mmHg (scatter {found.scatter:.2%})",
            tension / 45 / MMHG,
            found.mean,
        )
    two, exact = spiral_exactly()
    ours = spiral_on_cylinder()
    yield "V2, V4 spiral, 2.03 layers, mean over a turn, mmHg", exact, ours
    yield "V2, V4 the same for exactly two layers, mmHg", two, ours * two / exact
    for layers in (3, 4, 5):
        _, exact = spiral_exactly(layers)
        ours = spiral_on_cylinder(28, layers)
        yield f"V2 spiral of {layers} layers, mean over a turn, mmHg", exact, ours
    ours, exact = two_bandages_on_cylinder()
    yield "V2 two bandages that cross, mean over a turn, mmHg", exact, ours
    for laid_under in (0.098 / 45, 4e-3, 5e-4):
        found, exact = band_on_padding(laid_under)
        case = f"V16 band over padding laid under {laid_under / MMHG:.1f} mmHg,"
        yield f"{case} thickness mm", exact.thickness, found.thickness
        yield f"{case} mmHg", exact.pressure, found.pressure
    for several in ((0.196667,) * 3, (0.196667, 0.456667)):
        exactly = banded_exactly([(K1, 47 / 1.3) for K1 in several], 0.005)
        for number, (exact, found) in enumerate(
            zip(exactly, bands_on_soft_tube(*several), strict=True), start=1
        ):
            case = f"V3 band {number} of {len(several)} on a soft tube, K1 = {several[number - 1]}"
            yield f"{case}, radius mm", exact.radius, found.radius
            yield f"{case}, mmHg", exact.pressure / MMHG, found.pressure
    for K1 in (0.098 / 0.3, 0.196667):
        exact, found = hooped_exactly(K1, 1, 47 / 1.3, 0.005), band_on_soft_tube(K1)
        case = f"V3, V8 band in contact with a soft tube, K1 = {K1:.4f} N/mm,"
        yield f"{case} radius mm", exact.radius, found.radius
        yield f"{case} stretch", exact.stretch, found.stretch
        yield f"{case} mmHg (scatter {found.scatter:.2%})", exact.pressure / MMHG, found.pressure
    for mu in (0.1, 0.2, 0.3):
        yield f"V6 capstan over half a turn, mu = {mu}", np.exp(np.pi * mu), capstan(mu)
    for place, found, exact in zip(
        ("lower edge", "midline", "upper edge"), *stretches_on_cone(), strict=True
    ):
        yield f"V7 hoop on a cone, stretch of the {place}", exact, found


def bounds():
    """Yield a line for each check whose answer is a property."""
    for a, b in ((50, 44), (55, 40)):
        found = string_on_ellipse(a, b)
        yield (
            f"V5 string without friction on an ellipse {a} x {b}: tension within "
            f"{found.tension:.2%}, |p / (T kappa) - 1| {found.mean:.2%} in the mean, "
            f"{found.worst:.2%} at most"
        )
    for alpha, (tension, radius) in product((0.08, 0.12), ((0.098, 45.0), (0.137, 35.0))):
        below, above = (slide_down_cone(alpha, share, tension, radius) for share in (0.9, 1.1))
        yield (
            f"V7 hoop on a cone, alpha {alpha} rad, T {tension} N/mm, r {radius:g} mm: moved by "
            f"{below:.2f} mm in eight steps at mu = 0.9 tan(alpha), {above:.3f} at 1.1"
        )
    for elements, cells, turned in PATCHES:
        yield flat_patch(elements, cells, turned)


PATCHES = [
    ((11, 9), (8, 8, 3), 0),
    ((11, 9), (8, 8, 3), 29),
    ((9, 10), (6, 7, 3), 0),
    ((9, 10), (6, 7, 3), 29),
    ((21, 19), (16, 16, 4), 0),
    ((21, 19), (16, 16, 4), 29),
    ((11, 9), (16, 16, 4), 0),
]
"""Strip, block, degrees between their lines. The last: a skin finer than the strip, whose nodes
bulge between the strip's points; the model lays as many rows as the skin has cells."""


def flat_patch(elements, cells, turned: float) -> str:
    """The line of one flat patch."""
    load = 30 * MMHG
    found = press(load, cells, elements, np.radians(turned))
    off = found.pressure / load - 1
    sunk = found.settlement / settlement_exactly(load) - 1
    return (
        f"V8 flat patch, {elements[0]} x {elements[1]} elements on {cells[0]} x {cells[1]} "
        f"cells turned by {turned} degrees: pressure uniform to {off.std():.2%} rms, "
        f"{np.abs(off).max():.2%} at most; settlement {sunk.mean():+.1%}, its scatter "
        f"{sunk.std():.1%}"
    )


if __name__ == "__main__":
    main()
