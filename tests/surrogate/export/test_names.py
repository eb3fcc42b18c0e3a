"""Names that a language does not take end in a sentence with a name that it takes."""

import re

import pytest

from surrogate.errors import StudyError
from surrogate.export import names

LANGUAGES = {
    "C": names.C_WORDS,
    "Python": names.PYTHON_WORDS,
    "JavaScript": names.JAVASCRIPT_WORDS,
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", ["pressure at B1", "2nd", "µ", "a-b", "return", "_x", ""])
def test_the_cure_is_a_name(language, name):
    """Spaces, digits in front, other alphabets, words of the language."""
    taken = LANGUAGES[language]
    with pytest.raises(StudyError, match=f"cannot be a function of {language}") as told:
        names.check(name, language, taken)
    cure = re.search(r"add --name (\w+)$", str(told.value))[1]
    names.check(cure, language, taken)


@pytest.mark.parametrize(
    ("name", "language"),
    [("gamma", "C"), ("exp", "C"), ("lambda", "Python"), ("np", "Python"), ("new", "JavaScript")],
)
def test_words_of_a_language(name, language):
    """And names that a header or the file itself has."""
    with pytest.raises(StudyError, match="the word is taken"):
        names.check(name, language, LANGUAGES[language])


def test_others_pass():
    """In all languages."""
    for language, taken in LANGUAGES.items():
        for name in ("pressure_b1", "Q2", "lambda_1", "mean"):
            names.check(name, language, taken)
