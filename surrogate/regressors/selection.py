"""Polynomials of the few terms that the runs ask for.

Both choose among the terms of a polynomial and then fit by least squares. Tests and
intervals of a least squares fit do not know that its terms were chosen, so these offer
no standard deviation, and whoever judges them must choose anew without each fold.
"""

from __future__ import annotations

import warnings
from itertools import chain
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import linalg
from sklearn.exceptions import ConvergenceWarning
from sklearn.linear_model import LassoLarsCV
from sklearn.model_selection import KFold

from surrogate.errors import nearest
from surrogate.regressors.columns import Term
from surrogate.regressors.polynomial import (
    TermRegressor,
    design_matrix,
    interaction_terms,
    linear_terms,
    quadratic_terms,
)
from surrogate.space.space import Space

CANDIDATES = {
    "linear": linear_terms,
    "interactions": interaction_terms,
    "quadratic": quadratic_terms,
}
SELECTED = (
    "The terms were selected with these runs: standard errors, p-values and Q2 of this "
    "table do not know that and are too kind."
)

#: Terms that enter or leave together are those of the same parameters and powers.
Group = tuple[tuple[int, int], ...]
Terms = dict[Group, list[Term]]
Order = Literal["linear", "interactions", "quadratic"]
Chosen = frozenset[Group]

Array = NDArray[np.float64]


class SelectedPolynomial(TermRegressor):
    """A polynomial whose terms `select` takes of those of `order`."""

    def __init__(self, order: str = "quadratic", space: Space | None = None) -> None:
        self.order = order
        self.space = space

    def candidates(self) -> list[Term]:
        """All terms of the order, the constant first; raises ValueError for an unknown one."""
        if self.order not in CANDIDATES:
            raise ValueError(f"order '{self.order}': {nearest(self.order, CANDIDATES)}")
        return CANDIDATES[self.order](self.columns_)

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: five, to choose at all."""
        return 5

    def regression_table(
        self, *, confidence: float = 0.95, deterministic: bool = False
    ) -> xr.Dataset:
        """Table of the selected terms, with a note on what selection does to it."""
        table = super().regression_table(confidence=confidence, deterministic=deterministic)
        table.attrs["notes"] = "\n".join(filter(None, (SELECTED, table.attrs["notes"])))
        return table


class Stepwise(SelectedPolynomial):
    """Forward and backward selection by the corrected Akaike criterion (Hurvich, Tsai 1989).

    order     candidates: "linear", "interactions" or "quadratic"
    heredity  an interaction or square enters only with its main effects (Chipman 1996)
    space     as for `Polynomial`

    Columns of one categorical parameter enter and leave together.
    """

    def __init__(
        self, order: str = "quadratic", heredity: bool = True, space: Space | None = None
    ) -> None:
        super().__init__(order, space)
        self.heredity = heredity

    def select(self, values: Array, y: Array) -> list[Term]:
        """Terms at which no single addition or removal lowers the criterion."""
        groups = self._groups()
        columns = {group: design_matrix(terms, values) for group, terms in groups.items()}
        chosen: frozenset[Group] = frozenset({()})
        best = _criterion(columns, chosen, y)
        while True:
            scores = {
                near: _criterion(columns, near, y) for near in self._neighbours(groups, chosen)
            }
            least = min(scores.values(), default=np.inf)
            if not least < best - 1e-9 * abs(best):
                return _terms(groups, chosen)
            # Aliased terms tie but for rounding, which must not choose: the first one does.
            chosen = next(
                near
                for near, score in scores.items()
                if score <= least + 1e-9 * max(1.0, abs(least))
            )
            best = scores[chosen]

    def _groups(self) -> Terms:
        groups: Terms = {}
        for term in self.candidates():
            key = tuple((self.columns_[j].parameter, power) for j, power in term)
            groups.setdefault(key, []).append(term)
        return groups

    def _neighbours(self, groups: Terms, chosen: Chosen) -> list[Chosen]:
        """Sets one addition or removal away; the constant always stays.

        With heredity an addition brings its missing main effects along.
        """
        more = [
            chosen | {group} | (_parents(group) if self.heredity else set())
            for group in groups
            if group not in chosen
        ]
        fewer = [chosen - {group} for group in chosen if group]
        return more + [each for each in fewer if not self.heredity or _hereditary(each)]


def _parents(group: Group) -> set[Group]:
    """Main effects of the parameters of a group."""
    return {((parameter, 1),) for parameter, _ in group}


def _hereditary(chosen: Chosen) -> bool:
    return all(_parents(group) <= chosen for group in chosen)


def _terms(groups: Terms, chosen: Chosen) -> list[Term]:
    return list(chain.from_iterable(terms for group, terms in groups.items() if group in chosen))


def _criterion(columns: dict[Group, Array], chosen: Chosen, y: Array) -> float:
    """AICc of a set of groups; infinite without a residual degree of freedom to spare.

    A fit exact to rounding counts as such, so that only fewer terms can improve on it.
    """
    matrix = np.hstack([own for group, own in columns.items() if group in chosen])
    n, k = len(y), matrix.shape[1] + 1
    if n - k - 1 <= 0:
        return np.inf
    # By pivoted QR: it takes dependent columns as the default does, in a fraction of the time.
    solution = linalg.lstsq(matrix, y, lapack_driver="gelsy", check_finite=False)[0]
    residual = y - matrix @ solution
    sse = max(float(residual @ residual), 1e-26 * float(y @ y), 1e-300)
    return float(n * np.log(sse / n) + 2.0 * k * n / (n - k - 1))


class Lasso(SelectedPolynomial):
    """The terms that the lasso keeps, fitted by least squares (Efron et al. 2004, section 7).

    order  candidates: "linear", "interactions" or "quadratic"
    seed   of the five folds that choose the penalty
    space  as for `Polynomial`
    """

    def __init__(self, order: str = "quadratic", seed: int = 0, space: Space | None = None) -> None:
        super().__init__(order, space)
        self.seed = seed

    def select(self, values: Array, y: Array) -> list[Term]:
        """The constant and the terms with a coefficient at the penalty of least error."""
        terms = self.candidates()
        matrix = design_matrix(terms[1:], values)
        spread = matrix.std(axis=0)
        varying = spread > 1e-12
        if len(y) < 5 or y.std() <= 1e-14 * np.abs(y).max() or not varying.any():
            return terms[:1]
        scaled = (matrix - matrix.mean(axis=0)) / np.where(varying, spread, 1.0)
        kept = np.abs(self._penalised(scaled, (y - y.mean()) / y.std())) > 0.0
        return [terms[0], *(term for term, keep in zip(terms[1:], kept, strict=True) if keep)]

    def _penalised(self, matrix: Array, y: Array) -> Array:
        """Coefficients (p,) of the cross-validated lasso."""
        model = LassoLarsCV(cv=KFold(5, shuffle=True, random_state=self.seed), max_iter=300)
        with warnings.catch_warnings():
            # The path may stop at terms that the runs cannot tell apart: no more are wanted.
            warnings.simplefilter("ignore", ConvergenceWarning)
            return np.asarray(model.fit(matrix, y).coef_)
