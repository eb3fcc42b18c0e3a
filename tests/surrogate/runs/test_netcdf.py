"""Datasets as netCDF4 in memory, read back by a library that did not write them."""

import io

import h5py
import numpy as np
import pytest
import xarray as xr

from surrogate.runs.netcdf import encoded

DATES = np.array(["2024-05-17T10:00:00.25", "NaT"], dtype="datetime64[ns]")
ALL_KINDS = xr.Dataset(
    {
        "coded": (("run", "parameter"), [[0.1, np.nan], [1.0 / 3.0, -0.0]], {"units": "1"}),
        "field": (("run", "place"), np.arange(6, dtype=np.float32).reshape(2, 3)),
        "square": (("place", "place_2"), np.eye(3)),
        "message": ("run", ["", "è broken, twice\nas long"], {"levels": ["a", "bé"]}),
        "good": ("run", [True, False]),
        "finished": ("run", DATES),
        "count": ("run", [2, 3], {"long_name": "attempts", "of": 3, "share": 0.5}),
        "whole": ((), 4.5),
        "nothing": (("run", "none"), np.zeros((2, 0))),
    },
    coords={"parameter": ["x", "tension"], "place": [0.5, 1.5, 2.5], "design": ("run", ["a", "b"])},
    attrs={"study": "a: b\n", "size": 2},
)


def read(content, **options):
    return xr.load_dataset(io.BytesIO(content), engine="h5netcdf", **options)


@pytest.mark.parametrize("compressed", [False, True])
def test_every_kind_comes_back_as_through_the_library(compressed):
    """Bit by bit what xarray's own writer gives back: values, types, attributes, order."""
    found = read(encoded(ALL_KINDS, compressed=compressed))
    theirs = read(ALL_KINDS.to_netcdf(engine="h5netcdf"))
    xr.testing.assert_identical(found, theirs)
    xr.testing.assert_identical(found, ALL_KINDS)
    assert list(found.variables) == list(theirs.variables)
    assert [str(one.dtype) for one in found.variables.values()] == [
        str(one.dtype) for one in theirs.variables.values()
    ]


def test_a_tree_has_a_group_a_node():
    tree = xr.DataTree.from_dict({"/a": ALL_KINDS, "/b/c": ALL_KINDS[["whole", "count"]]})
    found = xr.open_datatree(io.BytesIO(encoded(tree)), engine="h5netcdf").load()
    xr.testing.assert_identical(found, tree)


def test_numbers_are_compressed_when_asked_for():
    with h5py.File(io.BytesIO(encoded(ALL_KINDS, compressed=True))) as file:
        ways = {name: file[name].compression for name in ("coded", "count", "message", "whole")}
    assert ways == {"coded": "gzip", "count": "gzip", "message": None, "whole": None}


def test_what_was_read_can_be_written_again():
    """Words of an earlier file (fill values, units of dates) are used again."""
    once = read(encoded(ALL_KINDS))
    xr.testing.assert_identical(read(encoded(once)), once)


def test_dimensions_are_scales_of_hdf5():
    """Every axis names its dimension, as the netCDF-4 format wants it."""
    with h5py.File(io.BytesIO(encoded(ALL_KINDS))) as file:
        assert file["coded"].dims[0][0] == file["run"] and file["run"].is_scale
        assert file["coded"].dims[1][0] == file["parameter"] and file["parameter"].is_scale
        fill = file["coded"].attrs["_FillValue"]
    assert fill.shape == (1,) and np.isnan(fill[0])
