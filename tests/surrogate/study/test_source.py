"""YAML with positions, by the rules of YAML 1.2."""

import pytest

from surrogate.errors import StudyError
from surrogate.study.source import read_text


def test_numbers_and_words_follow_yaml_1_2():
    """YAML 1.2.2, section 10.3: 1e-3 is a number; on, no, 1:30 are words; 010 is ten."""
    data = read_text("[1e-3, on, no, 1:30, 010, .5, -2.5E+3, true, 2026-01-02]", "s").data
    assert data == [1e-3, "on", "no", "1:30", 10, 0.5, -2500.0, True, "2026-01-02"]


def test_positions_of_keys_and_values():
    """Lines and columns count from one."""
    source = read_text("study: x\nparameters:\n  a: [1, oops]\n", "s.yaml")
    assert source.sentence(("parameters", "a", 1), "no") == "s.yaml:3:10: no"
    assert source.sentence(("parameters", "a"), "no", key=True) == "s.yaml:3:3: no"
    assert source.sentence(("parameters", "a", 1, "deeper"), "no") == "s.yaml:3:10: no"


@pytest.mark.parametrize(
    "text, words",
    [
        ("a: 1\na: 2", "2:1: 'a' stands twice"),
        ("a: [1, 2", "this is not YAML"),
        ("a:\n\t- 1", "indent with spaces"),
        ("a: &a [*a]", "s.yaml: this is not YAML: an alias"),
        ("a: !!int x", "this is not YAML: .*'x'"),
        ("a: !!python/object:os.system {}", "not YAML"),
    ],
)
def test_bad_yaml_is_a_sentence_with_its_place(text, words):
    """Syntax errors, doubled keys and tabs."""
    with pytest.raises(StudyError, match=words):
        read_text(text, "s.yaml")


BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 10)
)
MERGES = "a0: &a0 {x: 1}\n" + "".join(
    f"a{k}: &a{k} {{<<: [{', '.join([f'*a{k - 1}'] * 9)}]}}\n" for k in range(1, 10)
)


@pytest.mark.parametrize(
    "text, words",
    [
        (BOMB, r"^bomb:1:\d+: the study has more than 100000 values"),
        (MERGES, "more than 100000 values"),
        ("a: " + "[" * 200 + "]" * 200, "nested too deep"),
        ("a: " + "[" * 20000 + "]" * 20000, "nested too deep"),
        ("a: " + "9" * 5000, "not YAML"),
        ("# " + "x" * 2_000_000, "at most 2000000"),
    ],
    ids=["aliases", "merges", "deep", "deeper", "digits", "long"],
)
def test_a_study_that_would_grow_without_end_is_a_sentence(text, words):
    """Aliases of aliases: 9^10 values from 400 characters. Refused before they are made."""
    with pytest.raises(StudyError, match=words) as caught:
        read_text(text, "bomb")
    assert len(str(caught.value)) < 6000


def test_aliases_that_save_writing_are_read():
    source = read_text("a: &a {x: 1}\nb: {<<: *a, y: 2}\nc: [*a, *a]\n", "s")
    assert source.data == {"a": {"x": 1}, "b": {"x": 1, "y": 2}, "c": [{"x": 1}, {"x": 1}]}
