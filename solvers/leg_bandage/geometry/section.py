"""Closed curves r(theta) about a centre, as Fourier series: the sections of a leg.

A section is the complex number w = x + i y along theta,

    w(theta) = x0 + i y0 + r(theta) e^(i theta),
    r(theta) = r0 + sum_m a_m cos(m theta) + b_m sin(m theta),   m = 1..5,

so that r e^(i theta) is itself a Fourier sum over orders -4..6, and every derivative
along theta multiplies the term of order k by i k. x is lateral, y anterior.
"""

from __future__ import annotations

import numpy as np

DEGREE = 5
ORDERS = np.arange(-DEGREE, DEGREE + 1)
"""Orders of r; the orders of w are one higher."""


def complex_series(coefficients: np.ndarray) -> np.ndarray:
    """Real series (..., 11) r0, a1..a5, b1..b5 to complex terms (..., 11) over ORDERS."""
    positive = (coefficients[..., 1:6] - 1j * coefficients[..., 6:11]) / 2
    return np.concatenate([positive[..., ::-1].conj(), coefficients[..., :1], positive], axis=-1)


def radius(coefficients: np.ndarray, theta: np.ndarray, derivative: int = 0) -> np.ndarray:
    """r, or a derivative of it along theta; shapes (..., 11) and (...) broadcast."""
    terms = complex_series(coefficients) * (1j * ORDERS) ** derivative
    return _sum(terms, ORDERS, theta).real


def curve(coefficients: np.ndarray, theta: np.ndarray, derivative: int = 0) -> np.ndarray:
    """w about the centre (x0 = y0 = 0), or a derivative of it along theta; complex."""
    orders = ORDERS + 1
    terms = complex_series(coefficients) * (1j * orders) ** derivative
    return _sum(terms, orders, theta)


def _sum(terms: np.ndarray, orders: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Sum of terms (..., 11) times e^(i order theta), by powers of one exponential."""
    turn = np.exp(1j * np.asarray(theta, float))
    total = terms[..., -1] + 0 * turn
    for k in range(len(orders) - 2, -1, -1):
        total = total * turn + terms[..., k]
    return total * np.exp(1j * orders[0] * np.asarray(theta, float))


def curvature(coefficients: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Curvature of the section, 1/mm, positive where it is convex: Im(w'* w'') / |w'|^3."""
    first, second = curve(coefficients, theta, 1), curve(coefficients, theta, 2)
    return (first.conj() * second).imag / np.abs(first) ** 3


def girth(coefficients: np.ndarray, angles: int = 96) -> np.ndarray:
    """Length of the section, mm, by the trapezoidal rule (exact to 1e-9 for legs)."""
    orders = ORDERS + 1
    phases = np.exp(2j * np.pi * np.outer(orders, np.arange(angles)) / angles)
    velocity = complex_series(coefficients) @ (1j * orders[:, None] * phases)
    return 2 * np.pi * np.abs(velocity).mean(axis=-1)


def fit_series(theta: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Least-squares series (..., 11) through values (..., angle) of a radius at theta (angle,)."""
    phase = np.outer(theta, np.arange(1, DEGREE + 1))
    columns = np.column_stack([np.ones_like(theta), np.cos(phase), np.sin(phase)])
    return values @ np.linalg.pinv(columns).T
