"""Whoever does the runs, and whoever is killed at it: the same results, each run once."""

import importlib
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
WAYS = ("local", "dask", "surrogate work")


@pytest.mark.slow
def test_three_ways_with_a_kill_in_each_give_the_same_results(tmp_path, monkeypatch):
    """`surrogate run` here, on a dask cluster by its commands, three `surrogate work`."""
    pytest.importorskip("distributed")
    monkeypatch.syspath_prepend(BENCHMARKS)
    ways = importlib.import_module("ways")
    counts = {name: ways.WAYS[name](tmp_path / name, 24, 0.1) for name in WAYS}
    for count in counts.values():
        assert (count.runs, count.killed, count.lost, count.twice) == (24, 1, 0, 0)
        assert count.calls <= 25
        np.testing.assert_array_equal(count.values, counts["local"].values)
