"""`surrogate serve`: a study's surrogates, or its solver, for other programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from surrogate.errors import StudyError
from surrogate.execution.places import Places
from surrogate.runs.identity import run_inputs
from surrogate.serving.models import SolverModel, SurrogateModel
from surrogate.serving.protocol import Model
from surrogate.serving.server import LOOPBACK, Server
from surrogate.study.prediction import fits_at_hand
from surrogate.study.study import Study


@contextmanager
def server(
    study: Study,
    results: Path,
    *,
    surrogate: str | None = None,
    solver: bool = False,
    port: int = 4242,
    host: str = LOOPBACK,
    workers: int | None = None,
) -> Iterator[Server]:
    """A server that is ready to serve one model, named after the study.

    surrogate: its name; None for the best of each output. solver: the solver instead, in
    `workers` processes. Raises `StudyError` when both are asked for.
    """
    if solver and surrogate is not None:
        raise StudyError("give either --surrogate or --solver, not both")
    if not solver:
        model = surrogate_model(study, results, surrogate)
        with Server({model.name: model}, port, host) as made:
            yield made
        return
    wanted = study.spec.wanted(study.outputs)
    places = workers or study.workers
    with Places(study.spec, wanted, places, study.execution.timeout) as solve:
        model = SolverModel(study.name, study.space, wanted, partial(_solved, study, solve))
        with Server({model.name: model}, port, host, parallel=places) as made:
            yield made


def surrogate_model(study: Study, results: Path, surrogate: str | None) -> Model:
    """The surrogates of all outputs that have one."""
    fits, _ = fits_at_hand(study, results, surrogate)
    return SurrogateModel(
        study.name, study.space, {output: fit for output, (_, fit) in fits.items()}
    )


def _solved(study: Study, solve: Places, point: Mapping[str, Any]) -> dict[str, Any]:
    """The solver's outputs at one point, with the study's constants and nominal values."""
    columns = {name: np.array([value]) for name, value in point.items()}
    (call,) = run_inputs(study.spec, columns, study.constants)
    return solve(call)
