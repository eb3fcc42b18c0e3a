"""The runs dataset on the disk, in place of the journal that it was made from.

Reading 100 000 records takes seconds, reading the dataset tenths of one. It counts only for
the journal whose digest it names, and for the very points and outputs that are asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from surrogate.runs.dataset import LEVEL, LEVELS, output_names
from surrogate.runs.names import storable
from surrogate.solver import Output

#: The attribute that names the journal.
JOURNAL = "journal"
#: What is known of a run when it has ended, besides its outputs.
_ANSWERS = ("status", "message", "seconds", "attempts", "finished")
#: Attributes that say what was run.
_SAME = (JOURNAL, "identity", "constants", "fixed_inputs", "deterministic", LEVELS)


def compacted(
    path: Path, asked: xr.Dataset, wanted: Mapping[str, Output], *, values: bool = True
) -> xr.Dataset | None:
    """The dataset in `path` with the attributes of `asked`; None when it is of other runs.

    asked   as `assembly.assemble` makes it without outputs and without a record
    values  False: without the outputs
    """
    try:
        with xr.open_dataset(path, engine="h5netcdf", decode_timedelta=False) as file:
            if not _is_of(file, asked, wanted):
                return None
            found = file[[*_ANSWERS, *wanted] if values else list(_ANSWERS)].load()
    except Exception:  # missing or damaged: HDF5 fails in many ways, and the journal is there
        return None
    whole = asked.assign(found.data_vars).assign_coords(found.coords)
    damaged = {"damaged": found.attrs["damaged"]}
    return whole[[name for name in file.data_vars if name in whole]].assign_attrs(damaged)


def _is_of(file: xr.Dataset, asked: xr.Dataset, wanted: Mapping[str, Output]) -> bool:
    levels = (LEVEL,) if LEVELS in asked.attrs else ()
    return (
        all(file.attrs.get(name) == asked.attrs.get(name) for name in _SAME)
        and output_names(file) == list(wanted)
        and all(_is_output(file[name], output) for name, output in wanted.items())
        and all(file[name].identical(asked[name]) for name in ("coded", "design", *levels))
        and all(file[name].identical(asked[name]) for name in asked["parameter"].values)
    )


def _is_output(found: xr.DataArray, output: Output) -> bool:
    return (
        found.dims == ("run", *output.dims)
        and found.shape[1:] == output.shape
        and found.attrs.get("units") == output.unit
        and found.attrs.get("long_name") == storable(output.description or str(found.name))
        and all((found[dim].values == output.coordinates[dim]).all() for dim in output.dims)
    )
