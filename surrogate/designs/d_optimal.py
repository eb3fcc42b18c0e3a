"""D-optimal: the points from which a named polynomial is estimated best.

Maximises det(F'F), F the model matrix of the runs, by coordinate exchange (Meyer and
Nachtsheim 1995): the coordinates of each run in turn take their best values, from several
random starts. With constraints whole runs are exchanged for feasible candidates
(Fedorov 1972). For odd run counts, irregular models, or many-level categorical parameters.
"""

from __future__ import annotations

import itertools

import numpy as np

from surrogate.designs.design import searching
from surrogate.designs.requirements import affordable, bounded, choice, whole
from surrogate.designs.vertices import feasible_candidates
from surrogate.errors import DesignError
from surrogate.space.space import Parameter, Space

MODELS = ("linear", "interactions", "quadratic")
#: Singular starts are lifted by this much of the identity (Meyer and Nachtsheim 1995, 3.2);
#: by less, rounding of their gains would exceed `TIE`.
RIDGE = 1e-4
#: Gains that differ by less than this share are equal: symmetric designs tie but for rounding,
#: and the first of them must be taken for the same seed to give the same runs on every processor.
TIE = 1e-5
#: Passes over all coordinates, after which a start is taken as converged.
PASSES = 60
#: Of more allowed values than this, so many are candidates, evenly spaced.
MOST = 25


def checked(
    space: Space, *, runs: int, model: str = "linear", starts: int = 20, **_: object
) -> int:
    """Number of points that these options of `d_optimal` give; raises `DesignError`."""
    bounded(space, "d_optimal")
    runs = whole("runs", runs, 1)
    whole("starts", starts, 1)
    terms = Model(space, choice("model", model, MODELS))
    affordable(runs * terms.size, "d_optimal", "lower runs, or use fractional_factorial")
    if runs < terms.size:
        raise DesignError(
            f"runs: {runs} cannot estimate the {terms.size} terms of a {model} model "
            f"in {space.size} parameters; give at least {terms.size}"
        )
    return runs


@searching(checked)
def d_optimal(
    space: Space, *, runs: int, model: str = "linear", starts: int = 20, seed: int | None = None
) -> np.ndarray:
    """`runs` points, coded (run, parameter), for `model`: linear, interactions or quadratic.

    Continuous parameters take -1 and 1, and in a quadratic model also -0.5, 0, 0.5; integers
    and listed values take their allowed values; levels of categorical ones enter as
    effect-coded columns. The best of `starts` searches. Raises `DesignError` when
    there are fewer runs than terms.
    """
    runs = checked(space, runs=runs, model=model, starts=starts)
    terms = Model(space, model)
    rng = np.random.default_rng(seed)
    found = [_search(terms, runs, rng) for _ in range(starts)]
    logs = np.array([log_determinant(terms.matrix(design)) for design in found])
    return found[int(np.argmax(logs >= logs.max() - TIE))]


class Model:
    """Terms of a polynomial in coded values and the values its parameters may take.

    values  candidate coded values of each parameter
    candidates  points (candidate, parameter) to choose from where there are constraints
    size    number of terms
    """

    def __init__(self, space: Space, name: str):
        self.parameters = space.parameters
        self.name = name
        self.values = [_candidates(p, 5 if name == "quadratic" else 2) for p in space.parameters]
        self.candidates, self.basis = None, None
        if space.region is not None:
            self.candidates = feasible_candidates(space, self.values)
            self.basis = _estimable(self.matrix(self.candidates))
        self.size = self.matrix(np.zeros((1, space.size))).shape[1]

    def matrix(self, coded: np.ndarray) -> np.ndarray:
        """Model matrix (run, term): 1, main effects, interactions, squares."""
        mains = [_main_effects(p, coded[:, j]) for j, p in enumerate(self.parameters)]
        blocks = [np.ones((len(coded), 1)), *mains]
        if self.name != "linear":
            blocks += [
                (a[:, :, None] * b[:, None, :]).reshape(len(coded), -1)
                for a, b in itertools.combinations(mains, 2)
            ]
        if self.name == "quadratic":
            blocks += [
                main**2
                for values, p, main in zip(self.values, self.parameters, mains, strict=True)
                if not p.categorical and len(values) > 2
            ]
        full = np.hstack(blocks)
        return full if self.basis is None else full @ self.basis

    def start(self, runs: int, rng: np.random.Generator) -> np.ndarray:
        """A random design (run, parameter)."""
        if self.candidates is not None:
            return np.asarray(rng.choice(self.candidates, size=runs))
        return np.column_stack([rng.choice(values, size=runs) for values in self.values])

    def neighbours(self, point: np.ndarray) -> np.ndarray:
        """What a point may be exchanged for, (candidate, parameter)."""
        return _neighbours(point, self.values) if self.candidates is None else self.candidates


def _estimable(matrix: np.ndarray) -> np.ndarray:
    """Orthonormal combinations (term, rank) of the terms that candidates can tell apart.

    Equalities make terms depend on each other, as the components of a mixture and the constant
    do; the combinations span the same polynomials as Scheffe's (1958), with the same optimum.
    """
    _, singular, rows = np.linalg.svd(matrix, full_matrices=False)
    kept: np.ndarray = rows[singular > 1e-8 * singular[0]].T
    return kept


def _candidates(parameter: Parameter, count: int) -> np.ndarray:
    """Coded values that a parameter may take: levels, allowed values, or `count` even ones."""
    if parameter.categorical:
        return parameter.coded_levels
    allowed = parameter.allowed
    if allowed is None:
        return np.linspace(-1.0, 1.0, count)
    return allowed if len(allowed) <= MOST else np.unique(parameter.snap(np.linspace(-1, 1, MOST)))


def _main_effects(parameter: Parameter, column: np.ndarray) -> np.ndarray:
    """The column itself, or for k levels k - 1 effect-coded columns (the last level is -1)."""
    if not parameter.categorical:
        return column[:, None]
    level = np.argmin(np.abs(column[:, None] - parameter.coded_levels), axis=1)
    k = len(parameter.levels)
    coded: np.ndarray = np.vstack([np.eye(k - 1), -np.ones(k - 1)])[level]
    return coded


def log_determinant(matrix: np.ndarray) -> float:
    """log det(F'F) of a model matrix (run, term); -inf when a term cannot be estimated."""
    singular = np.linalg.svd(matrix, compute_uv=False)
    return float(2.0 * np.log(singular).sum()) if singular[-1] > 1e-9 else -np.inf


def _search(model: Model, runs: int, rng: np.random.Generator) -> np.ndarray:
    """Coordinate exchange from a random start, until a pass over the runs changes nothing."""
    design = model.start(runs, rng)
    matrix = model.matrix(design)
    for _ in range(PASSES):
        if not any([_improve(model, design, matrix, run) for run in range(runs)]):
            break
    return design


def _improve(model: Model, design: np.ndarray, matrix: np.ndarray, run: int) -> bool:
    """Change coordinates of one run, best first, while det(F'F) grows; True when any changed.

    Changes `design` and its model matrix in place. Replacing a row f by g multiplies
    det(F'F) by (1 + g'Vg)(1 - f'Vf) + (f'Vg)^2 with V = (F'F)^-1 (Fedorov 1972, 3.2).
    """
    for changes in range(2 * len(model.values)):
        rows = model.neighbours(design[run])
        new = model.matrix(rows)
        # Not updated from step to step: rounding would build up.
        inverse = np.linalg.inv(matrix.T @ matrix + RIDGE * np.eye(model.size))
        across = new @ inverse
        gains = (1.0 + (across * new).sum(axis=1)) * (1.0 - matrix[run] @ inverse @ matrix[run]) + (
            across @ matrix[run]
        ) ** 2
        best = int(np.argmax(gains >= gains.max() * (1.0 - TIE)))
        if gains[best] <= 1.0 + 1e-6:
            return changes > 0
        design[run], matrix[run] = rows[best], new[best]
    return True


def _neighbours(point: np.ndarray, values: list[np.ndarray]) -> np.ndarray:
    """The points that differ from `point` in one coordinate at most; (candidate, parameter)."""
    rows = np.repeat(point[None, :], sum(map(len, values)), axis=0)
    columns = np.repeat(np.arange(len(values)), [len(v) for v in values])
    rows[np.arange(len(rows)), columns] = np.concatenate(values)
    return rows
