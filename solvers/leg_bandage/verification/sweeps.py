"""Many runs of the bandage model, side by side, that outlive an interruption.

Rows are appended to a table as they come; a run that the table already holds is not repeated,
so that a sweep of hours can be stopped and taken up. Runs of other code are other runs.
A run that fails is a row with the sentence that it failed with.
"""

from __future__ import annotations

import ast
import csv
import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import astuple, dataclass, field
from functools import cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from surrogate.errors import SolverError

from ..equilibrium.model import MESHES, Mesh
from ..plugin import LegBandage
from .legs import validation_leg

READ = (
    "pressure_b1",
    "pressure_ankle",
    "pressure_calf",
    "stretch_midline",
    "slip_max",
    "steps",
    "iterations",
    "residual",
)
KEYS = ("code", "mesh", "case", "leg", "inputs")
COLUMNS = (*KEYS, *READ, "cut_backs", "unknowns", "seconds", "message")


@dataclass(frozen=True)
class Case:
    """One run: a name to print, inputs, and the number of a validation leg, or none."""

    name: str
    inputs: Mapping[str, float] = field(default_factory=dict)
    leg: int | None = None


def family(k: float) -> Mesh:
    """The mesh that is k times as fine as `coarse` in all directions; k in halves."""
    return Mesh(*(round(k * size) for size in astuple(MESHES["coarse"])))


@cache
def code() -> str:
    """Digest of the package's statements; comments and docstrings do not count."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(getattr(node, "body", None), list):
                node.body = [one for one in node.body if not _is_text(one)]
        digest.update(path.name.encode() + ast.dump(tree).encode())
    return digest.hexdigest()[:12]


def _is_text(statement):
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


@cache
def solver_on(mesh: str) -> LegBandage:
    """The solver on a named mesh, or on `family` of a number."""
    if mesh in MESHES:
        return LegBandage(mesh=mesh)
    solver = LegBandage(mesh="coarse")
    solver.mesh = family(float(mesh))
    return solver


def solve(mesh: str, case: Case) -> dict[str, str | float]:
    """One run as a row of the table; whatever goes wrong is told in `message`."""
    row: dict[str, str | float] = {**key_of(mesh, case), **dict.fromkeys(READ, np.nan)}
    row |= {"cut_backs": np.nan, "unknowns": np.nan, "seconds": np.nan, "message": ""}
    try:
        leg = None if case.leg is None else validation_leg(case.leg)
        result = solver_on(mesh).run(leg, **case.inputs)
    except SolverError as error:
        return row | {"message": str(error)}
    except Exception as error:  # a sweep of hours tells it and goes on
        return row | {"message": f"{type(error).__name__}: {error}"}
    problem = result.model.problem
    return row | {
        **{name: float(result.values[name]) for name in READ},
        "cut_backs": problem.cost.cut_backs,
        "seconds": round(result.seconds, 2),
        "unknowns": problem.ndof - len(np.unique(problem.fixed)),
    }


def key_of(mesh: str, case: Case) -> dict[str, str]:
    """What makes a run that run, as text; a mesh by its sizes, since names may change theirs."""
    sizes = "x".join(map(str, astuple(solver_on(mesh).mesh)))
    return {
        "code": code(),
        "mesh": sizes,
        "case": case.name,
        "leg": "" if case.leg is None else str(case.leg),
        "inputs": json.dumps(dict(case.inputs)),
    }


def solve_all(
    cases: Iterable[Case], mesh: str, workers: int = 1, table: Path | None = None
) -> Iterator[dict[str, str | float]]:
    """Rows of all cases, as they are done; those that `table` holds come first."""
    stored, todo = _stored(table), []
    for case in cases:
        key = tuple(key_of(mesh, case).values())
        if key in stored:
            yield stored[key]
        else:
            todo.append(case)
    # Threads of BLAS and of the linear solver are set before their libraries load.
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, str(max(1, (os.cpu_count() or 1) // workers)))
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(solve, mesh, case) for case in todo]):
            _append(table, done.result())
            yield done.result()


def _stored(table):
    if table is None or not table.exists():
        return {}
    with table.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    numbers = [name for name in COLUMNS if name not in (*KEYS, "message")]
    return {
        tuple(row[name] for name in KEYS): row | {name: float(row[name]) for name in numbers}
        for row in rows
    }


def _append(table, row):
    if table is None:
        return
    new = not table.exists() or table.stat().st_size == 0
    with table.open("a", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS)
        if new:
            writer.writeheader()
        writer.writerow(row)
