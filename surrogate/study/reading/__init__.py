"""From the words of a study to the objects they name; every mistake at once."""

from surrogate.study.reading.designs import designs_of
from surrogate.study.reading.methods import (
    check_screening,
    sensitivity_of,
    surrogates_of,
)
from surrogate.study.reading.mistakes import Reading, sentences
from surrogate.study.reading.runs import stored_of
from surrogate.study.reading.solver import constants_of, outputs_of, solver_of, space_of
from surrogate.study.reading.validation import cases_at, check_cases, validation_of

__all__ = [
    "Reading",
    "cases_at",
    "check_cases",
    "check_screening",
    "constants_of",
    "designs_of",
    "outputs_of",
    "sensitivity_of",
    "sentences",
    "solver_of",
    "space_of",
    "stored_of",
    "surrogates_of",
    "validation_of",
]
