"""What is asked: measurements, inputs that are free, and how far the model is trusted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.fitting.best import BEST
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.distributions import Distribution
from surrogate.space.space import Space

Array = NDArray[np.float64]
Law = Distribution | DiscreteLaw

#: Posterior draws that are kept, unless the study says otherwise.
DRAWS = 4000


@dataclass(frozen=True, eq=False)
class Measured:
    """What was measured of one output.

    values  (case,), NaN where nothing was measured
    errors  (case,) standard deviations of measurement in `unit`; NaN: to be estimated
    """

    output: str
    unit: str
    values: Array
    errors: Array

    @property
    def known(self) -> NDArray[np.bool_]:
        """(case,) where there is a measurement."""
        return np.isfinite(self.values)

    @property
    def estimated(self) -> bool:
        """True when the error of some measurement is not given."""
        return bool(np.isnan(self.errors[self.known]).any())


@dataclass(frozen=True, eq=False)
class Problem:
    """Inputs to be learnt from measurements.

    priors          law of each free input, in its unit
    coded           (case, parameter) coded inputs of the cases; columns of free inputs are 0
    labels          what each case is called
    measured        outputs with their measurements
    discrepancy     whether reality may differ from the solver
    surrogate       which predicts: a name, or best
    draws           posterior draws to keep
    emulator_error  whether the surrogate's own error is part of the likelihood; False shows
                    what goes wrong without it
    cases           the file of the measurements, as the study writes it
    notes           sentences about the cases that a reader should know
    """

    space: Space
    priors: Mapping[str, Law]
    coded: Array
    labels: tuple[str, ...]
    measured: tuple[Measured, ...]
    discrepancy: bool = False
    surrogate: str = BEST
    draws: int = DRAWS
    seed: int = 0
    emulator_error: bool = True
    cases: str = ""
    notes: tuple[str, ...] = ()

    @property
    def free(self) -> tuple[str, ...]:
        """The free inputs, in the order of the space."""
        return tuple(name for name in self.space.names if name in self.priors)

    @property
    def known(self) -> tuple[str, ...]:
        """The parameters that the cases give."""
        return tuple(name for name in self.space.names if name not in self.priors)

    @property
    def known_coded(self) -> Array:
        """(case, known) coded values of the parameters that the cases give."""
        return self.coded[:, [name not in self.priors for name in self.space.names]]
