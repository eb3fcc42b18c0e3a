"""Conference matrices: C'C = (m - 1) I, zeros on the diagonal, -1 and 1 elsewhere.

Paley's (1933): the quadratic character of a field with q = m - 1 elements, bordered by ones;
q is an odd prime, its square or cube. Symmetric for q = 1 modulo 4, skew for q = 3. A skew one
doubles (Goethals and Seidel 1967, doi 10.4153/CJM-1967-091-8).
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Whole = NDArray[np.int_]


def conference(least: int) -> Array:
    """The smallest conference matrix made here of an even order of at least `least`."""
    order = max(2, least + least % 2)
    while not _constructible(order):
        order += 2
    return _matrix(order)


def _constructible(order: int) -> bool:
    return order == 2 or _prime_power(order - 1) is not None or _doubles(order)


def _doubles(order: int) -> bool:
    """Whether a skew matrix of half the order is there."""
    half = order // 2
    return order % 8 == 0 and (_prime_power(half - 1) is not None or _doubles(half))


@cache
def _matrix(order: int) -> Array:
    if order == 2:
        return np.array([[0.0, 1.0], [-1.0, 0.0]])
    if _prime_power(order - 1) is None:
        c, one = _matrix(order // 2), np.eye(order // 2)
        return np.block([[c, c + one], [c - one, -c]])
    differences, character = _field(order - 1)
    found = np.ones((order, order))
    found[0, 0] = 0.0
    found[1:, 1:] = character[differences]
    if order % 4 == 0:
        found[1:, 0] = -1.0
    return found


def _prime_power(q: int) -> tuple[int, int] | None:
    """(p, n) with q = p^n, n <= 3 and p an odd prime; None when q is no such power."""
    p = next((d for d in range(3, q + 1, 2) if q % d == 0), 0) if q % 2 else 0
    n = 0
    while p and q % p == 0:
        q, n = q // p, n + 1
    return (p, n) if p and q == 1 and n <= 3 else None


@cache
def _field(q: int) -> tuple[NDArray[np.intp], Array]:
    """Of the field with q elements: numbers of all differences (q, q), and the character (q,).

    Elements are polynomials over the integers modulo p, of a degree below n, by their
    coefficients; they multiply modulo an irreducible polynomial.
    """
    p, n = _prime_power(q) or (q, 1)
    elements = np.array(list(product(range(p), repeat=n)))
    place = p ** np.arange(n - 1, -1, -1)
    differences = ((elements[:, None] - elements[None]) % p) @ place
    modulus = _irreducible(p, n)
    squares = {int(_product(a, a, modulus, p) @ place) for a in elements[1:]}
    character = np.array([0.0, *(1.0 if k in squares else -1.0 for k in range(1, q))])
    return differences, character


def _product(a: NDArray[np.int_], b: NDArray[np.int_], modulus: NDArray[np.int_], p: int) -> Whole:
    """Product of two polynomials, highest power first, modulo a monic one and p."""
    found = np.convolve(a, b)
    n = len(modulus) - 1
    for k in range(len(found) - n):
        found[k : k + n + 1] -= found[k] * modulus
    return np.asarray(found[-n:] % p)


def _irreducible(p: int, n: int) -> Whole:
    """A monic polynomial of degree n <= 3 without a root modulo p: then it has no factor."""
    tails = product(range(p), repeat=n) if n > 1 else [(0,)]
    monic = ((1, *tail) for tail in tails)
    return np.array(next(c for c in monic if n == 1 or (np.polyval(c, range(p)) % p).all()))
