"""From the words of a study to the objects they name; every mistake at once.

Start from `whole.fields_of`.
"""

from surrogate.study.reading.designs import searched
from surrogate.study.reading.execution import starter
from surrogate.study.reading.methods import too_small
from surrogate.study.reading.mistakes import sentences
from surrogate.study.reading.validation import cases_at, check_cases
from surrogate.study.reading.whole import fields_of

__all__ = [
    "cases_at",
    "check_cases",
    "fields_of",
    "searched",
    "sentences",
    "starter",
    "too_small",
]
