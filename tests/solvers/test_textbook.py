"""Textbook solvers: the contract, and mean and variance against exact figures."""

import json
from functools import reduce
from itertools import combinations
from pathlib import Path

import numpy as np
import pint
import pytest
from scipy.special import roots_legendre

from surrogate.solver import Solver
from surrogate_solvers import textbook
from surrogate_solvers.textbook import (
    Borehole,
    Cantilever,
    Ishigami,
    MorrisFunction,
    OTLCircuit,
    Piston,
    SobolG,
    WingWeight,
)

FACTS = json.loads(
    (Path(__file__).parents[1] / "reference" / "sobol_indices.json").read_text(encoding="utf-8")
)["sobol_indices"]
EVERY = [
    Ishigami(),
    SobolG(),
    Borehole(),
    Piston(),
    OTLCircuit(),
    WingWeight(),
    MorrisFunction(),
    Cantilever(),
]


def rule(given, order, panels=1):
    """Gauss-Legendre nodes and probability weights on an input's range, on equal panels."""
    x, w = roots_legendre(order)
    ends = np.linspace(*given.range, panels + 1)
    half = np.diff(ends)[:, None] / 2.0
    return (ends[:-1, None] + half * (x + 1.0)).ravel(), np.tile(w / 2.0 / panels, panels)


def mean_and_variance(solver, output, order, panels=1, **orders):
    """Tensor Gauss quadrature over all inputs, uniform; `orders` of single inputs differ."""
    rules = [rule(given, orders.get(name, order), panels) for name, given in solver.inputs.items()]
    grid = np.meshgrid(*(nodes for nodes, _ in rules), indexing="ij", sparse=True)
    values = solver(**dict(zip(solver.inputs, grid, strict=True)))[output]
    values = np.broadcast_to(values, [len(nodes) for nodes, _ in rules])
    weights = [w for _, w in rules]
    mean = reduce(lambda v, w: np.tensordot(v, w, (0, 0)), weights, values)
    second = reduce(lambda v, w: np.tensordot(v, w, (0, 0)), weights, (values - mean) ** 2)
    return float(mean), float(second)


@pytest.mark.parametrize("solver", EVERY, ids=lambda solver: type(solver).__name__)
def test_every_solver_keeps_the_contract(solver):
    """Units that pint knows, nominal values in range, sources, and the outputs it promises."""
    registry = pint.UnitRegistry()
    assert isinstance(solver, Solver) and solver.version and type(solver).__doc__
    for given in solver.inputs.values():
        registry.Unit(given.unit)
        assert given.range[0] <= given.nominal <= given.range[1]
        assert given.source and given.description
    answer = solver(**{name: given.nominal for name, given in solver.inputs.items()})
    assert set(answer) == set(solver.outputs)
    assert all(np.isfinite(value) and np.ndim(value) == 0 for value in answer.values())


@pytest.mark.parametrize(
    ("name", "solver", "orders", "tolerance"),
    [
        ("ishigami", Ishigami(), {"order": 20}, 1e-12),
        ("borehole", Borehole(), {"order": 4, "rw": 8, "r": 16}, 2e-6),
        ("piston", Piston(), {"order": 6}, 2e-6),
        ("sobol_g", SobolG(), {"order": 2, "panels": 2}, 1e-12),
    ],
)
def test_mean_and_variance_are_the_exact_ones(name, solver, orders, tolerance):
    """Quadrature against the stored figures, which claim 1.3e-6 for the borehole.

    The G function is linear on either half of each input.
    """
    mean, variance = mean_and_variance(solver, next(iter(solver.outputs)), **orders)
    assert mean == pytest.approx(FACTS[name]["mean"], rel=tolerance)
    assert variance == pytest.approx(FACTS[name]["variance"], rel=tolerance)


@pytest.mark.parametrize(("a", "b"), [(7.0, 0.1), (7.0, 0.05), (2.0, 1.0)])
def test_ishigami_options_follow_its_closed_form(a, b):
    """Mean a / 2; V = 1/2 + b pi^4 / 5 + b^2 pi^8 / 18 + a^2 / 8 (Ishigami and Homma 1990)."""
    mean, variance = mean_and_variance(Ishigami(a=a, b=b), "y", 24)
    assert mean == pytest.approx(a / 2.0, rel=1e-12)
    exact = 0.5 + b * np.pi**4 / 5.0 + b**2 * np.pi**8 / 18.0 + a**2 / 8.0
    assert variance == pytest.approx(exact, rel=1e-12)


def test_sobol_g_takes_any_number_of_inputs():
    """V = prod (1 + 1 / (3 (1 + a_i)^2)) - 1 (Saltelli and Sobol' 1995)."""
    solver = SobolG(a=(0.5, 3.0))
    assert list(solver.inputs) == ["x1", "x2"]
    mean, variance = mean_and_variance(solver, "y", 3, 2)
    exact = np.prod([1.0 + 1.0 / (3.0 * (1.0 + a) ** 2) for a in solver.a]) - 1.0
    assert (mean, variance) == pytest.approx((1.0, exact), rel=1e-12)


def test_otl_circuit_at_a_point_computed_by_hand():
    """Rb1 = Rb2 = 60: Vb1 = 6; beta = 100, Rc2 = 1: gain 1000; Rf = 2, Rc1 = 2.

    (6.74 * 1000 + 11.35 * 2 + 0.74 * 2 * 1000 / 2) / 1002 = 7502.7 / 1002.
    """
    answer = OTLCircuit()(Rb1=60.0, Rb2=60.0, Rf=2.0, Rc1=2.0, Rc2=1.0, beta=100.0)
    assert answer["voltage"] == pytest.approx(7502.7 / 1002.0, rel=1e-14)


def test_wing_weight_mean_factors_into_single_integrals():
    """Without paint the weight is a product of functions of one input each."""
    solver = WingWeight()
    nominal = {name: given.nominal for name, given in solver.inputs.items()} | {"Wp": 0.0}
    at_nominal = solver(**nominal)["weight"]
    mean = at_nominal
    for name, given in solver.inputs.items():
        if name != "Wp":
            nodes, weights = rule(given, 12)
            mean *= weights @ solver(**{**nominal, name: nodes})["weight"] / at_nominal
    mean += solver.inputs["Sw"].nominal * solver.inputs["Wp"].nominal
    drawn = np.random.default_rng(0).random((200_000, 10))
    points = {
        name: given.range[0] + drawn[:, j] * np.diff(given.range)
        for j, (name, given) in enumerate(solver.inputs.items())
    }
    sample = solver(**points)["weight"]
    assert abs(sample.mean() - mean) < 4.0 * sample.std() / np.sqrt(len(sample))


@pytest.mark.parametrize(
    ("solver", "at_quarter", "at_three_quarters"),
    [
        (OTLCircuit(), 5.202493584049977, 5.390762339807683),
        (WingWeight(), 209.59317550318315, 333.69705129273933),
        (Piston(), 0.4801153548050284, 0.4484102559434381),
    ],
)
def test_values_agree_with_another_program(solver, at_quarter, at_three_quarters):
    """UQTestFuns 0.7.0 at 1/4 and 3/4 of every range."""
    for part, expected in ((0.25, at_quarter), (0.75, at_three_quarters)):
        point = {
            name: given.range[0] + part * (given.range[1] - given.range[0])
            for name, given in solver.inputs.items()
        }
        assert next(iter(solver(**point).values())) == pytest.approx(expected, rel=1e-13)


def test_morris_function_is_its_sum_over_all_subsets():
    """The definition, term by term, at random points (Morris 1991, section 4)."""
    for x in np.random.default_rng(1).random((5, 20)):
        w = 2.0 * (x - 0.5)
        w[[2, 4, 6]] = 2.0 * (1.1 * x[[2, 4, 6]] / (x[[2, 4, 6]] + 0.1) - 0.5)
        expected = sum((20.0 if i < 10 else (-1.0) ** (i + 1)) * w[i] for i in range(20))
        expected += sum(
            (-15.0 if j < 6 else (-1.0) ** (i + j)) * w[i] * w[j]
            for i, j in combinations(range(20), 2)
        )
        expected -= 10.0 * sum(np.prod(w[list(s)]) for s in combinations(range(5), 3))
        expected += 5.0 * np.prod(w[:4])
        answer = MorrisFunction()(**{f"x{i + 1}": value for i, value in enumerate(x)})["y"]
        assert answer == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("output", "powers", "scale"),
    [
        ("deflection", {"load": 1, "length": 3, "modulus": -1, "width": -1, "height": -3}, 4e6),
        ("stress", {"load": 1, "length": 1, "modulus": 0, "width": -1, "height": -2}, 6e3),
    ],
)
def test_cantilever_has_the_moments_of_a_product_of_powers(output, powers, scale):
    """E prod x_j^p_j = prod E x_j^p_j: 4 F L^3 / (E b h^3) and 6 F L / (b h^2)."""

    def moment(power):
        total = scale**power
        for name, p in powers.items():
            (low, high), q = Cantilever.inputs[name].range, p * power + 1
            integral = np.log(high / low) if q == 0 else (high**q - low**q) / q
            total *= integral / (high - low)
        return total

    mean, variance = mean_and_variance(Cantilever(), output, 9)
    assert mean == pytest.approx(moment(1), rel=1e-11)
    assert variance == pytest.approx(moment(2) - moment(1) ** 2, rel=1e-9)


def test_sources_name_their_papers():
    """Every source but the beam carries a DOI."""
    sources = [value for name, value in vars(textbook).items() if name.isupper()]
    assert sum("doi 10." in source for source in sources) == len(sources) - 1
