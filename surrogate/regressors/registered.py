"""Fields whose pattern moves: aligned along one dimension, learnt, and moved back.

Edges, fronts and pulses that move with the inputs need many modes, whose amplitudes are hard
to learn. So the field f_i of run i is read where its pattern stands,

    a_i(r) = f_i(g(r + u_i(r); x_i)),

g being a shift and stretch that is linear in the inputs (`drift`), u_i a smooth displacement
(`warps`). Aligned fields a and displacements u are each learnt by modes (`field`); a prediction
is a(r; x) at the r that lies beneath a place. The template of a run is what the surrogate predicts
for it from the other runs, in turns with the alignment: Procrustes fitting (Ramsay and
Silverman, Functional Data Analysis, 2nd ed. 2005, section 7.6), with a prediction in place of the
mean, so that only what the inputs explain counts as a move. Reduced models of registered fields:
Taddei 2020, A registration method for model order reduction, SIAM J. Sci. Comput. 42,
A997-A1024, doi 10.1137/19M1271270.
"""

from __future__ import annotations

import math
from typing import Any, Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone
from sklearn.utils.validation import check_is_fitted

from surrogate.counting import counted
from surrogate.errors import FitError
from surrogate.estimator import Array
from surrogate.regressors.drift import Drift, drift
from surrogate.regressors.field import Field
from surrogate.regressors.warps import Basis, Rows, origins, register

#: Turns of predicting templates and aligning with them.
TURNS = 2
#: Most places of the aligned fields, as a multiple of those of a field.
FINEST = 2.0
#: Fewest places of a dimension along which a pattern can be seen to move.
FEWEST = 8


class Registered(Field):
    """A field that is aligned along one dimension before its modes are found.

    estimator  a regressor of scalars that has `leave_one_out`
    explained  as of `Field`

    Fitted: all of `Field`, of the fields as they are, which its indices and draws belong to;
    `axis_`, the dimension whose `drift_` lowers the fields' rank most (its places count as even),
    `grid_` (g,) of the aligned fields, `aligned_` and `moved_`, the `Field` of aligned fields
    (rows, g) and of displacements.
    """

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and fields y (n, ...)."""
        self.coded_, fields = np.asarray(X, dtype=float), np.asarray(y, dtype=float)
        super().fit(self.coded_, fields)
        drifts = [self._drift(fields, axis) for axis in range(fields.ndim - 1)]
        self.axis_ = int(np.argmin([lowered for _, lowered in drifts]))
        self.drift_ = drifts[self.axis_][0]
        rows = _rows(fields, self.axis_)
        self.places_ = _places(rows)
        reached = self.drift_.back(self.coded_, self.places_)
        finest = float(np.diff(reached, axis=1).min())
        low, high = float(reached.min()), float(reached.max())
        count = min((high - low) / finest, FINEST * len(self.places_))
        self.grid_ = np.linspace(low, high, math.ceil(count) + 1)
        self._align(Rows.through(self.places_, rows), self._others)
        return self

    def _drift(self, fields: Array, axis: int) -> tuple[Drift, float]:
        rows = _rows(fields, axis)
        if rows.shape[-1] < FEWEST:
            return Drift(0.5, *np.zeros((2, self.coded_.shape[1]))), 1.0
        return drift(self.coded_, rows, _places(rows))

    @property
    def _others(self) -> tuple[int, ...]:
        """Sizes of the dimensions that the pattern does not move along."""
        return (*self.shape_[: self.axis_], *self.shape_[self.axis_ + 1 :])

    def _align(self, rows: Rows, others: tuple[int, ...]) -> None:
        """Displacements and aligned fields of the runs, and the fields that predict them."""
        basis = Basis.of(others, len(self.grid_))
        still = self.drift_.forth(self.coded_, self.grid_)[:, None]
        straight = Rows.through(self.grid_, rows.at(still + np.zeros((len(basis.across), 1)))[0])
        n = len(self.coded_)
        coefficients = np.zeros((n, basis.across.shape[1], basis.along.shape[1]))
        self.straight_ = straight.at(self.grid_ + basis.displacements(coefficients))[0]
        for _ in counted("alignment", range(TURNS)):
            near = Field.refitted(self, self.coded_, self.straight_)
            if not near.estimators_:  # fields that do not vary have no pattern that moves
                break
            coefficients = register(straight, _left_out(near), basis, coefficients)
            self.straight_ = straight.at(self.grid_ + basis.displacements(coefficients))[0]
        self.aligned_ = self._learnt(self.straight_)
        self.shifts_ = basis.displacements(coefficients)
        self.moved_ = self._learnt(self.shifts_)

    def _learnt(self, values: Array) -> Field:
        return Field(clone(self.estimator), self.explained).fit(self.coded_, values)

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Array: ...
    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...
    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Fields (m, ...) at coded X (m, d).

        With `return_std` their standard deviations: those of the aligned field and, where it has
        a slope, of the displacement, taken as independent.
        """
        check_is_fitted(self)
        points = np.asarray(X, dtype=float)
        if not return_std:
            return self._moved_back(
                self.aligned_.predict(points), self.moved_.predict(points), points
            )[0]
        straight, own = self.aligned_.predict(points, return_std=True)
        shifts, of_shifts = self.moved_.predict(points, return_std=True)
        values, slopes, at = self._moved_back(straight, shifts, points)
        along = slopes * self._shaped(Rows.through(self.grid_, of_shifts).at(at)[0])
        return values, np.hypot(self._shaped(Rows.through(self.grid_, own).at(at)[0]), along)

    def _moved_back(self, straight: Array, shifts: Array, X: Array) -> tuple[Array, Array, Array]:
        """Fields (m, ...) of aligned ones (m, rows, g) at coded X, their slopes, and where read."""
        beneath = self.drift_.back(X, self.places_)
        at = origins(self.grid_, shifts, beneath[:, None])
        values, slopes = Rows.through(self.grid_, straight).at(at)
        return self._shaped(values), self._shaped(slopes), at

    def _shaped(self, rows: Array) -> Array:
        """Fields (m, ...) of rows (m, rows, places)."""
        return np.moveaxis(rows.reshape(len(rows), *self._others, -1), -1, 1 + self.axis_)

    def leave_out(self, folds: NDArray[np.intp]) -> Array:
        """Predictions (n, ...) of each run without its fold (n,).

        Modes and regressors are found anew without the fold; drift and the other runs'
        displacements are kept.
        """
        found = np.full((len(folds), *self.shape_), np.nan)
        for fold in counted("fold", np.unique(folds).tolist()):
            rest = folds != fold
            known, new = self.coded_[rest], self.coded_[~rest]
            try:
                aligned = self.aligned_.refitted(known, self.straight_[rest])
                moved = self.moved_.refitted(known, self.shifts_[rest])
            except (ValueError, np.linalg.LinAlgError):
                continue  # too few runs are left: stays NaN
            found[~rest] = self._moved_back(aligned.predict(new), moved.predict(new), new)[0]
        return found

    def portable(self) -> dict[str, Any]:
        """Raises `FitError`: documents have no words for fields that move."""
        raise FitError(
            "a registered field has no portable form: take `registration` out of the surrogate's "
            "options, and its field is exported by modes alone"
        )


def _rows(fields: Array, axis: int) -> Array:
    """Fields (n, rows, m), the dimension `axis` last."""
    turned = np.moveaxis(fields, 1 + axis, -1)
    return np.ascontiguousarray(turned.reshape(len(fields), -1, turned.shape[-1]))


def _places(rows: Array) -> Array:
    """Even places (m,) from 0 to 1 of fields (n, rows, m)."""
    return np.linspace(0.0, 1.0, rows.shape[-1])


def _left_out(field: Field) -> Array:
    """Predictions (n, ...) of a field's runs, each without itself; modes are kept."""
    models: Any = field.estimators_
    amplitudes = np.column_stack([model.leave_one_out() for model in models])
    return np.asarray(field.mean_ + amplitudes @ field.modes_).reshape(-1, *field.shape_)
