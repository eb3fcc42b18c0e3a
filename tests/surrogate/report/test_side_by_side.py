"""Coefficients of several polynomials in one table."""

from dataclasses import replace

import numpy as np
import xarray as xr

from surrogate.report.sections.side_by_side import MOVED, table


def regression(values, half, runs):
    """A regression table of these coefficients, each with the same half interval."""
    columns = {"coefficient": np.array(list(values.values()))}
    columns |= {"low": columns["coefficient"] - half, "high": columns["coefficient"] + half}
    return xr.Dataset(
        {
            **{key: ("term", column) for key, column in columns.items()},
            "residual": ("run", np.zeros(runs)),
        },
        coords={"term": list(values)},
    )


def test_a_coefficient_that_left_its_first_interval_is_marked(study):
    """mu_skin goes from 2 +- 1 to 4, tension 12 +- 1 to 11.5; the interaction is not shared."""
    content = replace(
        study(surrogates=("linear",)),
        regression={
            "many": {
                "pressure_b1": regression(
                    {"1": 30.0, "mu_skin": 4.0, "tension": 11.5, "mu_skin:tension": 1.0}, 0.1, 50
                )
            },
            "few": {
                "pressure_b1": regression({"1": 30.5, "mu_skin": 2.0, "tension": 12.0}, 1.0, 9)
            },
        },
    )
    found = table(content, "pressure_b1")
    assert [head.words.partition(",")[0] for head in found.heads[1:3]] == ["few", "many"]
    rows = {row[0].words: row for row in found.rows}
    assert list(rows) == ["constant", "mu_skin", "tension"]
    assert [name for name, row in rows.items() if row[-1].words == MOVED] == ["mu_skin"]
    assert [row[1].tone for row in rows.values()] == ["", "bad", ""]
