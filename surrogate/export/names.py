"""Names that a language takes for a function, and what to do about others."""

from __future__ import annotations

import keyword
import re
from collections.abc import Set

from surrogate.errors import StudyError

#: C99, 6.4.1 and what <math.h> declares (7.12), with the C library's Bessel functions and gamma.
C_WORDS = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while _Bool _Complex _Imaginary main
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1
    fabs fdim floor fma fmax fmin fmod fpclassify frexp hypot ilogb isfinite isgreater
    isgreaterequal isinf isless islessequal islessgreater isnan isnormal isunordered ldexp lgamma
    llrint llround log log10 log1p log2 logb lrint lround modf nan nearbyint nextafter nexttoward
    pow remainder remquo rint round scalbln scalbn signbit sin sinh sqrt tan tanh tgamma trunc
    gamma j0 j1 jn y0 y1 yn float_t double_t""".split()
)
#: ECMAScript, section 12.7.2, in modules, and the globals that no module may declare or shadow.
JAVASCRIPT_WORDS = frozenset(
    """arguments await break case catch class const continue debugger default delete do else enum
    eval export extends false finally for function if implements import in instanceof interface
    let new null package private protected public return static super switch this throw true try
    typeof var void while with yield undefined NaN Infinity Math Array Object Float64Array Number
    String Error TypeError RangeError Uint8Array Map WeakMap JSON ArrayBuffer atob INPUTS
    COORDINATES""".split()
)
#: Words of Python, and names that an exported file uses itself.
PYTHON_WORDS = frozenset(
    [*keyword.kwlist, "np", "math", "cache", "INPUTS", "LEVELS", "COORDINATES"]
)

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def check(name: str, language: str, taken: Set[str]) -> None:
    """Raise `StudyError` for a name that the language does not take for a function."""
    if not _IDENTIFIER.fullmatch(name):
        why = "letters, digits and _ make a name, and a letter its beginning"
    elif name in taken:
        why = f"the word is taken in {language}"
    else:
        return
    cure = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "output"
    if not cure[0].isalpha():
        cure = f"of_{cure}"
    cure = f"{cure}_value" if cure in taken else cure
    raise StudyError(f"'{name}' cannot be a function of {language}: {why}; add --name {cure}")
