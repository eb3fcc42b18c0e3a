"""Indices of an event are told as such, not as shares of the output's variance."""

import numpy as np
import pytest
import xarray as xr

from surrogate.report.sections.measures import method_of, variance_of


@pytest.fixture
def table():
    """What `target` gives of one output."""
    return xr.Dataset(
        {"probability": ((), 0.28612), "total": ("parameter", np.array([0.4, 0.7]))},
        coords={"parameter": ["a", "b"]},
        attrs={"method": "target", "surrogate": "gp", "computed": "sampling", "event": "above 5"},
    )


def test_the_event_and_its_probability_are_told(table):
    """In the sentence on the method."""
    said = method_of(table)
    assert said == (
        "Method: Sobol' indices of whether it is above 5 (probability 0.286) of surrogate gp by "
        "sampling."
    )


def test_shares_are_of_the_variance_of_the_event(table):
    """Of an output's indices they are of its own."""
    assert variance_of(table) == "the variance of whether it is above 5"
    del table.attrs["event"]
    assert variance_of(table) == "its variance"
