"""Laws of parameters in the words of a study, with units."""

import pytest

from surrogate.study.study import Study


@pytest.mark.parametrize(
    "words",
    [
        {"distribution": "loguniform", "range": [5.0, 15.0], "unit": "cm"},
        {"distribution": "loguniform", "a": 5.0, "b": 15.0, "unit": "cm"},
        {"distribution": "loguniform", "a": 0.05, "b": 0.15},
        {"distribution": "loguniform", "range": [0.05, 0.15]},
    ],
)
def test_one_law_written_in_four_ways(words):
    """The ends by a range or by shape words, in the solver's unit or another."""
    study = Study.from_mapping(
        {
            "study": "laws",
            "solver": "borehole",
            "parameters": {"rw": words},
            "designs": {"train": {"method": "sobol", "runs": 4}},
        }
    )
    law = study.space["rw"].law
    assert law.support == pytest.approx((0.05, 0.15), rel=1e-12)
    assert float(law.ppf(0.5)) == pytest.approx((0.05 * 0.15) ** 0.5, rel=1e-9)
