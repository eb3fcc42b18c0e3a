"""`surrogate export`: a surrogate of one output as a file for other programs."""

from __future__ import annotations

from pathlib import Path

from surrogate.cli.page import Page, say
from surrogate.errors import FitError, StudyError, nearest
from surrogate.estimator import is_portable
from surrogate.export.description import chosen_output, describe
from surrogate.export.formats import FORMATS
from surrogate.runs.files import write_bytes
from surrogate.study.prediction import fits_at_hand
from surrogate.study.study import Study

#: Bytes of a file whose size is said before it is written.
LARGE = 50_000_000


def export(
    study: Study,
    results: Path,
    surrogate: str | None,
    output: str | None,
    kind: str,
    to: Path,
    name: str | None,
) -> Page:
    """Write the surrogate of an output into the file `to`; the page tells what it holds.

    surrogate: its name; None for the best. output: None for the only one. name: of the function;
    None for the output's. Raises `StudyError` for what is not there, `FitError` for a surrogate
    without a portable form.
    """
    if kind not in FORMATS:
        raise StudyError(f"format '{kind}' is unknown; {nearest(kind, FORMATS)}")
    chosen = chosen_output(output, study.outputs)
    if surrogate is not None and surrogate in study.surrogates:
        _check_portable(study, surrogate)
    fits, notes = fits_at_hand(study, results, surrogate)
    if chosen not in fits:
        raise FitError("\n".join(notes) or f"no surrogate could be fitted to '{chosen}'")
    best, fit = fits[chosen]
    _check_portable(study, best)
    described = describe(
        fit,
        study.offered[chosen],
        name=name or chosen,
        study=study.name,
        nominal=study.nominal,
        constants=study.constants,
    )
    content = FORMATS[kind].written(described)
    if len(content) > LARGE:
        say(f"{to} will have {len(content) / 1e6:.0f} MB, most of it of {len(fit.values)} runs")
    write_bytes(to, content)
    data = {
        "file": str(to),
        "format": kind,
        "name": described.name,
        "surrogate": fit.surrogate,
        "output": chosen,
        "bytes": len(content),
        "inputs": [one.name for one in described.inputs],
    }
    done = f"{to} is written: {chosen} by {fit.surrogate}, {FORMATS[kind].about}"
    return Page(data, [*notes, done])


def _check_portable(study: Study, name: str) -> None:
    """Raise `StudyError` for a surrogate that no format holds, with those that all hold."""
    others = [one for one, entry in study.surrogates.items() if is_portable(entry.estimator)]
    if name not in others:
        cure = f"add --surrogate {' or '.join(others)}" if others else "add gp: gaussian_process"
        raise StudyError(
            f"surrogate '{name}' has no portable form, which polynomials, polynomial chaos and "
            f"Gaussian processes have; {cure}"
        )
