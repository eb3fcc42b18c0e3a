"""The reduced model: surrogates of the finite element model, fitted to stored runs.

A stored study is a study file of the solver `leg_bandage` with its runs beside it. It
varies any of mu_skin, tension, stretch, leg_length and alpha1, alpha2 ...; inputs that it
does not vary have the value that its runs had. It names two surrogates: `at_b1`, of the
output pressure_b1, and `field`, of pressure_field (theta, height).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

import surrogate
from surrogate.errors import ResultsError, StudyError, nearest

from .bandage_choice import BandageChoice

SHIPPED = Path(__file__).parents[1] / "data" / "pressure.yaml"
AT_B1, FIELD = "at_b1", "field"
OUTPUTS = {AT_B1: "pressure_b1", FIELD: "pressure_field"}


@dataclass(frozen=True, eq=False)
class Reduced:
    """A stored study and what is fitted to it, each surrogate when it is first asked for.

    path   of the study file
    study  the surrogate.Study in it
    runs   its runs
    """

    path: Path
    study: Any
    runs: xr.Dataset

    @classmethod
    def read(cls, path: str | Path | None = None) -> Reduced:
        """The stored study in a file, the one that ships for None.

        Raises StudyError or ResultsError for one that cannot predict the pressure on a leg.
        """
        path = Path(str(SHIPPED if path is None else path))
        if not path.is_file():
            raise StudyError(
                f"{path}: there is no such stored study; give --study the study file of one"
            )
        study = surrogate.Study.from_yaml(path)
        for name in (AT_B1, FIELD):
            if name not in study.surrogates:
                raise StudyError(
                    f"{path}: a stored study of legs needs a surrogate named "
                    f"'{name}'; {nearest(name, study.surrogates)}"
                )
        if "cohort" in study.spec.plain_options:
            raise StudyError(
                f"{path}: its legs are those of a cohort of its own; the pressure on "
                "a scan is predicted in the shape modes that ship"
            )
        if "pressure_b1" not in study.outputs or "leg_length" not in study.space.names:
            raise StudyError(
                f"{path}: a stored study of legs varies leg_length and has the output "
                "pressure_b1; is this the right file?"
            )
        runs = study.stored()
        if not (runs["status"] == "ok").any():
            raise ResultsError(
                f"{path}: none of its runs is stored: "
                + ("; ".join(study.unused) or "do `surrogate run` first")
            )
        return cls(path, study, runs)

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that the study varies."""
        return self.study.space.names

    @property
    def count(self) -> int:
        """Runs that the pressure at B1 is learnt from."""
        return len(self.at_b1.values)

    @cached_property
    def at_b1(self):
        """Fit of the pressure at B1."""
        return self._fit(AT_B1)

    @cached_property
    def field(self):
        """Fit of the pressure all over the skin."""
        return self._fit(FIELD)

    def _fit(self, name: str):
        output = OUTPUTS[name]
        study = replace(self.study.with_surrogates([name]), outputs=(output,))
        with threadpool_limits(1):  # matrices of some hundred rows: threads wait for each other
            fits = study.fit(self.runs)
        if output not in fits[name]:
            raise ResultsError(
                f"{self.path}: its runs do not support the surrogate '{name}' of "
                f"{output}; run more of the study"
            )
        return fits[name][output]

    def inputs(self, leg: Mapping[str, float], choice: BandageChoice) -> dict[str, Any]:
        """Values of the study's parameters for a leg (leg_length, alpha1 ...) under a bandage.

        A study that does not vary the stretch was run at 1.3: another stretch reaches it as
        the tension that it gives. Raises StudyError for a parameter that a scan does not tell.
        """
        varies_stretch = "stretch" in self.names
        known = {
            **leg,
            "mu_skin": choice.mu_skin,
            "stretch": choice.stretch,
            "tension": choice.tension if varies_stretch else choice.effective_tension,
        }
        solver = self.study.spec.solver.inputs
        values = {name: known.get(name, solver[name].nominal) for name in self.names}
        silent = [name for name, value in values.items() if value is None]
        if silent:
            raise StudyError(
                f"{self.path}: it varies {', '.join(silent)}, which a scan does not "
                "tell and which has no nominal value"
            )
        return values

    def coded(self, inputs: Mapping[str, Any]) -> np.ndarray:
        """Coded points (m, d) of columns of inputs; numbers are repeated."""
        size = max(np.size(value) for value in inputs.values())
        return self.study.space.encode(
            {name: np.broadcast_to(np.asarray(value), (size,)) for name, value in inputs.items()}
        )

    def outside(self, inputs: Mapping[str, float]) -> dict[str, tuple[float, float, float]]:
        """Value, low and high of each input beyond what the study ran."""
        found = {}
        for name in (name for name in self.names if not self.study.space[name].categorical):
            low, high = self.study.space[name].distribution.support
            margin = 1e-9 * (high - low)
            if not low - margin <= inputs[name] <= high + margin:
                found[name] = (inputs[name], float(low), float(high))
        return found

    def skin_pressure(
        self, inputs: Mapping[str, float]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Angles (degrees), heights over length, and pressures (theta, height), mmHg."""
        field = self.runs["pressure_field"]
        values = self.field.predict(self.coded(inputs))[0]
        return (field["theta"].to_numpy(), field["height"].to_numpy(), np.maximum(values, 0.0))
