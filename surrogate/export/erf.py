"""erf of float64 tensors, for runtimes that know it of float32 only.

Rational approximations of Cody 1969, Mathematics of Computation 23, 631: up to 0.46875 directly,
beyond through erfc(x) = exp(-x^2) R(x) up to 4, and above.
"""

from __future__ import annotations

from surrogate.export.graph import Tensor, horner

A = (
    1.85777706184603153e-1,
    3.16112374387056560,
    1.13864154151050156e2,
    3.77485237685302021e2,
    3.20937758913846947e3,
)
B = (
    1.0,
    2.36012909523441209e1,
    2.44024637934444173e2,
    1.28261652607737228e3,
    2.84423683343917062e3,
)
C = (
    2.15311535474403846e-8,
    5.64188496988670089e-1,
    8.88314979438837594,
    6.61191906371416295e1,
    2.98635138197400131e2,
    8.81952221241769090e2,
    1.71204761263407058e3,
    2.05107837782607147e3,
    1.23033935479799725e3,
)
D = (
    1.0,
    1.57449261107098347e1,
    1.17693950891312499e2,
    5.37181101862009858e2,
    1.62138957456669019e3,
    3.29079923573345963e3,
    4.36261909014324716e3,
    3.43936767414372164e3,
    1.23033935480374942e3,
)
NEAR, FAR = 0.46875, 4.0


def erf(x: Tensor) -> Tensor:
    """erf(x), to 4e-16; beyond 6 it is 1 to rounding, and erfc(4 to 6) is below 2e-8."""
    size = x.op("Abs").op("Min", 6.0)
    inner = size.op("Min", NEAR)
    square = inner * inner
    near = inner * horner(A, square) / horner(B, square)
    outer = size.op("Max", NEAR)
    beyond = -(outer * outer)
    far = -(beyond.op("Exp") * horner(C, outer) / horner(D, outer)) + 1.0
    return x.op("Sign") * size.op("Less", NEAR).where(near, far)
