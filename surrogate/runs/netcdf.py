"""Datasets as netCDF4 files in memory, through h5py.

A netCDF4 file is an HDF5 file whose dimensions are dimension scales (NetCDF-4 File Format
Specification, Unidata). `to_netcdf` writes the same through h5netcdf, which looks up every
scale again for each variable: seven times the time for a tree of small tables.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np
import xarray as xr

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable. {:9d}"
_COMPRESSED = {"compression": "gzip", "compression_opts": 6, "shuffle": True}


def encoded(found: xr.Dataset | xr.DataTree, *, compressed: bool = False) -> memoryview:
    """The file of a dataset, or of a tree of them: a group a node, with dimensions of its own.

    compressed: numbers are compressed without loss.
    """
    content = io.BytesIO()
    with h5py.File(content, "w", track_order=True) as file:
        if isinstance(found, xr.Dataset):
            _write(file, found, compressed)
        else:
            for node in found.subtree:
                whole = node.path == "/"
                group = file if whole else file.create_group(node.path, track_order=True)
                _write(group, node.to_dataset(), compressed)
    return content.getbuffer()


def _write(group: h5py.Group, found: xr.Dataset, compressed: bool) -> None:
    """Variables and attributes as the CF conventions have them, in a group."""
    plain, attributes = xr.conventions.encode_dataset_coordinates(found)
    variables = {
        str(name): xr.conventions.encode_cf_variable(variable, name=name)
        for name, variable in plain.items()
    }
    for name, size in found.sizes.items():
        if name not in variables:
            scale = group.create_dataset(name, shape=(size,), dtype=">f4", track_order=True)
            scale.make_scale(_NO_VARIABLE.format(size))
    made = {name: _created(group, name, one, compressed) for name, one in variables.items()}
    scales = {name: group[name] for name in found.sizes}
    for name, variable in variables.items():
        if variable.dims != (name,):
            for axis, dimension in enumerate(variable.dims):
                made[name].dims[axis].attach_scale(scales[dimension])
    _describe(group, attributes)


def _created(group: h5py.Group, name: str, variable: xr.Variable, compressed: bool) -> h5py.Dataset:
    """The variable with its attributes; a dimension scale when it is a dimension's own."""
    values, attributes = variable.values, dict(variable.attrs)
    how: dict[str, Any] = {"dtype": values.dtype, "track_order": True}
    if values.dtype.kind in "OU":
        values, how["dtype"] = values.astype(object), h5py.string_dtype()
    elif compressed and values.ndim:
        how |= _COMPRESSED
    if "_FillValue" in attributes:
        how["fillvalue"] = attributes["_FillValue"]
        attributes["_FillValue"] = np.array([attributes["_FillValue"]], dtype=values.dtype)
    made = group.create_dataset(name, data=values, **how)
    if variable.dims == (name,):
        made.make_scale(name)
    _describe(made, attributes)
    return made


def _describe(thing: h5py.Group | h5py.Dataset, attributes: Mapping[Any, Any]) -> None:
    for name, value in attributes.items():
        thing.attrs[str(name)] = value
