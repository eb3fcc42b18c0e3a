"""`surrogate check` tells what designs will tell about polynomials."""

import pytest

from surrogate import Study
from surrogate.cli import standing
from surrogate.cli.table import Table
from surrogate.errors import DesignError, StudyError


def study(**changes):
    return Study.from_mapping(
        {
            "study": "foreseen",
            "solver": "ishigami",
            "parameters": {name: [-1, 1] for name in ("X1", "X2", "X3")},
            "designs": {"train": {"method": "full_factorial", "levels": 3}},
            "surrogates": {"q": {"method": "quadratic"}, "gp": {"method": "gaussian_process"}},
            **changes,
        }
    )


def test_polynomials_on_their_training_designs(tmp_path):
    """The 3^3 factorial: errors sigma / sqrt(18) and sigma / sqrt(6), nothing inflated."""
    page = standing.check(study(), tmp_path)
    assert list(page.data["precision"]) == ["quadratic from train"]
    found = page.data["precision"]["quadratic from train"]
    error = dict(zip(found["terms"], found["standard_error"], strict=True))
    assert error["X1"] == pytest.approx(18**-0.5)
    assert error["X1:X2"] == pytest.approx(12**-0.5)
    assert error["X1^2"] == pytest.approx(6**-0.5)
    assert found["vif"][1:] == pytest.approx([1.0] * 9)
    assert (found["runs"], found["degrees_of_freedom"]) == (27, 17)
    titles = [part.title for part in page.parts if isinstance(part, Table)]
    assert "quadratic from train: 27 runs, 17 degrees of freedom for the error" in titles


def test_any_model_on_any_design(tmp_path):
    """A list of terms, on a Latin hypercube whose points are then found."""
    one = study(designs={"train": {"method": "latin_hypercube", "runs": 20}})
    assert standing.check(one, tmp_path).data["precision"] == {}
    found = standing.check(one, tmp_path, "X1, X2, X1:X2", 1.0).data["precision"]
    assert found["X1, X2, X1:X2 from train"]["terms"] == ["1", "X1", "X2", "X1:X2"]


def test_a_larger_effect_is_found_more_surely(tmp_path):
    """Power grows with the effect; without an error there is none."""
    powers = [
        standing.check(study(), tmp_path, None, effect).data["precision"]["quadratic from train"]
        for effect in (0.5, 1.0, 2.0)
    ]
    assert powers[0]["power"][1] < powers[1]["power"][1] < powers[2]["power"][1]
    saturated = study(designs={"train": {"method": "d_optimal", "runs": 4}}, surrogates={})
    page = standing.check(saturated, tmp_path, "linear")
    assert page.data["precision"]["linear from train"]["power"] == [None] * 4
    assert any("no error to test with" in str(part) for part in page.parts)


def test_what_cannot_be_told_apart_is_said(tmp_path):
    """Squares on two levels."""
    one = study(designs={"train": {"method": "full_factorial"}}, surrogates={})
    page = standing.check(one, tmp_path, "quadratic")
    assert "cannot be told apart: X1^2 = 1; X2^2 = 1; X3^2 = 1" in page.parts


@pytest.mark.parametrize(
    "model, effect, said", [("X1, Z", 2.0, "'Z' in term 'Z'"), (None, 0.0, "--effect: 0")]
)
def test_mistakes(tmp_path, model, effect, said):
    """An unknown name, an effect that is none."""
    with pytest.raises((DesignError, StudyError), match=said):
        standing.check(study(), tmp_path, model, effect)


def test_of_levels_of_fidelity_the_truth_counts(tmp_path):
    """Polynomials learn from its runs alone: 6 of 20 + 6 rows."""
    levels = {"cheap": {}, "dear": {"solver": "ishigami"}}
    one = study(
        levels=levels,
        designs={"train": {"method": "nested", "runs": {"cheap": 20, "dear": 6}}},
        surrogates={"l": {"method": "linear"}},
    )
    found = standing.check(one, tmp_path, "linear").data["precision"]["linear from train"]
    assert (found["runs"], found["degrees_of_freedom"]) == (6, 2)
