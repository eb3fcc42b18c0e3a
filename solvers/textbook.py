"""Textbook functions as solver plug-ins: fast, with known mean, variance and indices.

They show a study at work in a second and give the tests something exact to meet.
Inputs are uniform on their range in the sources' studies; the nominal value is the
middle. Every `__call__` takes floats or NumPy arrays of one shape.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from surrogate.solver import Input, Output

ISHIGAMI = "Ishigami and Homma 1990, doi 10.1109/ISUMA.1990.151285"
SALTELLI_SOBOL = "Saltelli and Sobol' 1995, doi 10.1016/0951-8320(95)00099-2"
HARPER_GUPTA = (
    "Harper and Gupta 1983, report BMI/ONWI-516; "
    "ranges as Morris, Mitchell and Ylvisaker 1993, "
    "doi 10.1080/00401706.1993.10485320"
)
BEN_ARI_STEINBERG = "Ben-Ari and Steinberg 2007, doi 10.1080/08982110701580930"
KENETT_ZACKS = f"Kenett and Zacks 1998, Modern Industrial Statistics; {BEN_ARI_STEINBERG}"
FORRESTER = "Forrester, Sobester and Keane 2008, section 1.4, doi 10.1002/9780470770801"
MORRIS = "Morris 1991, section 4, doi 10.1080/00401706.1991.10484804"
BEAM = "Euler-Bernoulli beam theory (Timoshenko 1955); ranges are this project's, slender beams"


def _inputs(source: str, **rows: tuple) -> dict[str, Input]:
    """Inputs from rows name=(lowest, highest, unit, description)."""
    return {
        name: Input(
            unit=unit,
            nominal=0.5 * (lowest + highest),
            range=(lowest, highest),
            description=description,
            source=source,
        )
        for name, (lowest, highest, unit, description) in rows.items()
    }


@dataclass(frozen=True)
class Ishigami:
    """y = sin X1 + a sin^2 X2 + b X3^4 sin X1; X3 acts through its interaction only.

    a  size of the second term
    b  size of the interaction of X1 and X3
    """

    a: float = 7.0
    b: float = 0.1

    version: ClassVar[str] = "1"
    inputs: ClassVar[dict[str, Input]] = _inputs(
        ISHIGAMI, **{name: (-np.pi, np.pi, "", f"angle {name}") for name in ("X1", "X2", "X3")}
    )
    outputs: ClassVar[dict[str, Output]] = {"y": Output(description="Ishigami's function")}

    def __call__(self, X1, X2, X3):
        return {"y": np.sin(X1) + self.a * np.sin(X2) ** 2 + self.b * X3**4 * np.sin(X1)}


@dataclass(frozen=True)
class SobolG:
    """y = prod_i (|4 x_i - 2| + a_i) / (1 + a_i); the smaller a_i, the more x_i matters.

    a  a number for each input
    """

    a: tuple[float, ...] = (0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0)

    version: ClassVar[str] = "1"
    outputs: ClassVar[dict[str, Output]] = {"y": Output(description="Sobol' G function")}

    @property
    def inputs(self) -> dict[str, Input]:
        """x1 .. xd, one for each number in `a`."""
        return _inputs(
            SALTELLI_SOBOL,
            **{
                f"x{i}": (0.0, 1.0, "", f"factor with a = {a:g}")
                for i, a in enumerate(self.a, start=1)
            },
        )

    def __call__(self, **x):
        factors = [
            (abs(4.0 * x[f"x{i}"] - 2.0) + a) / (1.0 + a) for i, a in enumerate(self.a, start=1)
        ]
        return {"y": math.prod(factors)}


class Borehole:
    """Flow of water through a borehole that joins two aquifers."""

    version = "1"
    inputs = _inputs(
        HARPER_GUPTA,
        rw=(0.05, 0.15, "m", "radius of the borehole"),
        r=(100.0, 50000.0, "m", "radius of influence"),
        Tu=(63070.0, 115600.0, "m^2/year", "transmissivity of the upper aquifer"),
        Hu=(990.0, 1110.0, "m", "potentiometric head of the upper aquifer"),
        Tl=(63.1, 116.0, "m^2/year", "transmissivity of the lower aquifer"),
        Hl=(700.0, 820.0, "m", "potentiometric head of the lower aquifer"),
        L=(1120.0, 1680.0, "m", "length of the borehole"),
        Kw=(9855.0, 12045.0, "m/year", "hydraulic conductivity of the borehole"),
    )
    outputs = {"flow": Output(unit="m^3/year", description="water flow rate")}

    def __call__(self, rw, r, Tu, Hu, Tl, Hl, L, Kw):
        log_ratio = np.log(r / rw)
        resistance = 1.0 + 2.0 * L * Tu / (log_ratio * rw**2 * Kw) + Tu / Tl
        return {"flow": 2.0 * np.pi * Tu * (Hu - Hl) / (log_ratio * resistance)}


class Piston:
    """Time of one cycle of a piston in a cylinder with gas and a spring."""

    version = "1"
    inputs = _inputs(
        KENETT_ZACKS,
        M=(30.0, 60.0, "kg", "piston weight"),
        S=(0.005, 0.020, "m^2", "piston surface"),
        V0=(0.002, 0.010, "m^3", "initial gas volume"),
        k=(1000.0, 5000.0, "N/m", "spring coefficient"),
        P0=(90000.0, 110000.0, "Pa", "atmospheric pressure"),
        Ta=(290.0, 296.0, "K", "ambient temperature"),
        T0=(340.0, 360.0, "K", "temperature of the filling gas"),
    )
    outputs = {"cycle_time": Output(unit="s", description="time of one cycle")}

    def __call__(self, M, S, V0, k, P0, Ta, T0):
        A = P0 * S + 19.62 * M - k * V0 / S
        V = S / (2.0 * k) * (np.sqrt(A**2 + 4.0 * k * P0 * V0 * Ta / T0) - A)
        stiffness = k + S**2 * P0 * V0 * Ta / (T0 * V**2)
        return {"cycle_time": 2.0 * np.pi * np.sqrt(M / stiffness)}


class OTLCircuit:
    """Mid-point voltage of an output transformerless push-pull circuit."""

    version = "1"
    inputs = _inputs(
        BEN_ARI_STEINBERG,
        Rb1=(50.0, 150.0, "kohm", "resistance b1"),
        Rb2=(25.0, 70.0, "kohm", "resistance b2"),
        Rf=(0.5, 3.0, "kohm", "resistance f"),
        Rc1=(1.2, 2.5, "kohm", "resistance c1"),
        Rc2=(0.25, 1.2, "kohm", "resistance c2"),
        beta=(50.0, 300.0, "", "current gain"),
    )
    outputs = {"voltage": Output(unit="V", description="mid-point voltage")}

    def __call__(self, Rb1, Rb2, Rf, Rc1, Rc2, beta):
        Vb1 = 12.0 * Rb2 / (Rb1 + Rb2)
        gain = beta * (Rc2 + 9.0)
        return {
            "voltage": ((Vb1 + 0.74) * gain + 11.35 * Rf + 0.74 * Rf * gain / Rc1) / (gain + Rf)
        }


class WingWeight:
    """Weight of the wing of a light aircraft, by Raymer's conceptual formula."""

    version = "1"
    inputs = _inputs(
        FORRESTER,
        Sw=(150.0, 200.0, "ft^2", "wing area"),
        Wfw=(220.0, 300.0, "lb", "weight of fuel in the wing"),
        A=(6.0, 10.0, "", "aspect ratio"),
        sweep=(-10.0, 10.0, "degree", "quarter-chord sweep"),
        q=(16.0, 45.0, "lb/ft^2", "dynamic pressure at cruise"),
        taper=(0.5, 1.0, "", "taper ratio"),
        tc=(0.08, 0.18, "", "aerofoil thickness over chord"),
        Nz=(2.5, 6.0, "", "ultimate load factor"),
        Wdg=(1700.0, 2500.0, "lb", "flight design gross weight"),
        Wp=(0.025, 0.08, "lb/ft^2", "paint weight"),
    )
    outputs = {"weight": Output(unit="lb", description="weight of the wing")}

    def __call__(self, Sw, Wfw, A, sweep, q, taper, tc, Nz, Wdg, Wp):
        cosine = np.cos(np.deg2rad(sweep))
        bare = (
            0.036
            * Sw**0.758
            * Wfw**0.0035
            * (A / cosine**2) ** 0.6
            * q**0.006
            * taper**0.04
            * (100.0 * tc / cosine) ** -0.3
            * (Nz * Wdg) ** 0.49
        )
        return {"weight": bare + Sw * Wp}


class MorrisFunction:
    """Morris's polynomial in 20 inputs: ten matter, of which six interact.

    beta_i = 20 (i <= 10), beta_ij = -15 (i, j <= 6), beta_ijl = -10 (<= 5),
    beta_ijls = 5 (<= 4). The rest, which Morris drew at random, are fixed here at
    (-1)^i for beta_i and (-1)^(i + j) for beta_ij, and 0.
    """

    version = "1"
    inputs = _inputs(MORRIS, **{f"x{i}": (0.0, 1.0, "", f"factor {i}") for i in range(1, 21)})
    outputs = {"y": Output(description="Morris's function")}

    def __call__(self, **x):
        w = [2.0 * (x[f"x{i}"] - 0.5) for i in range(1, 21)]
        for i in (2, 4, 6):
            z = x[f"x{i + 1}"]
            w[i] = 2.0 * (1.1 * z / (z + 0.1) - 0.5)
        signed = [wi if i % 2 else -wi for i, wi in enumerate(w)]
        y = 20.0 * _products(w[:10], 1) + _products(signed[10:], 1)
        y = y - 15.0 * _products(w[:6], 2) + _products(signed, 2) - _products(signed[:6], 2)
        return {"y": y - 10.0 * _products(w[:5], 3) + 5.0 * _products(w[:4], 4)}


def _products(w, order: int):
    """Sum of the products of `order` different entries of w: elementary symmetric polynomial."""
    sums = [1.0] + [0.0] * order
    for wi in w:
        for k in range(order, 0, -1):
            sums[k] = sums[k] + wi * sums[k - 1]
    return sums[order]


class Cantilever:
    """Tip deflection 4 F L^3 / (E b h^3) of a slender beam clamped at its other end.

    A product of powers: its mean, variance and every Sobol' index have closed forms.
    """

    version = "1"
    inputs = _inputs(
        BEAM,
        load=(80.0, 120.0, "N", "force at the tip, across the beam"),
        length=(0.9, 1.1, "m", "length of the beam"),
        width=(18.0, 22.0, "mm", "width of the cross-section"),
        height=(27.0, 33.0, "mm", "height of the cross-section, along the force"),
        modulus=(180.0, 220.0, "GPa", "Young's modulus"),
    )
    outputs = {
        "deflection": Output(unit="mm", description="deflection of the tip"),
        "stress": Output(unit="MPa", description="largest bending stress, at the clamp"),
    }

    def __call__(self, load, length, width, height, modulus):
        span = 1000.0 * length
        return {
            "deflection": 4.0 * load * span**3 / (1000.0 * modulus * width * height**3),
            "stress": 6.0 * load * span / (width * height**2),
        }
