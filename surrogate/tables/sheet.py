"""A sheet of cells as a file has it: CSV, TSV, Excel, Parquet, netCDF; nothing is understood yet.

Text files may use any of ``, ; tab |`` between cells, a byte order mark, UTF-8, UTF-16 or
Windows-1252, and lines that begin with ``#``.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import mode
from typing import TYPE_CHECKING, Any

from surrogate.errors import Mistake, StudyError, nearest

if TYPE_CHECKING:
    import xarray as xr

#: Characters that stand between cells, in the order in which ties are decided.
DELIMITERS = (",", ";", "\t", "|")
#: Largest file that is read, bytes.
LARGEST = 2 * 2**30


@dataclass(frozen=True)
class Sheet:
    """Cells of a table, as text or as the file's own types; None where a cell is empty.

    header  the names in the first row, as written
    rows    the further rows, each as long as the header
    lines   where each row stands in the file, as a spreadsheet or an editor counts
    notes   what a reader should know about the file
    outputs headers of the columns that the file itself says are outputs
    """

    header: list[str]
    rows: list[list[Any]]
    lines: list[int]
    notes: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()


def read_sheet(path: Path, sheet: str | None = None) -> Sheet:
    """The cells of a file; raises `StudyError` when it cannot be read or holds no table.

    sheet: of an Excel file; default its first.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise StudyError(
            f"{path.name}: files of kind '{path.suffix}' are not read; use {', '.join(READERS)}"
        )
    try:
        if path.stat().st_size > LARGEST:
            raise StudyError(f"{path.name} is larger than {LARGEST // 2**30} GiB")
        found = reader(path, sheet)
    except OSError as error:
        raise StudyError(
            f"{path} cannot be read ({error.strerror or error}); "
            "a path in a study is relative to the study file"
        ) from None
    return _sheet(path.name, found)


Grid = list[tuple[int, list[Any]]]


@dataclass(frozen=True)
class Cells:
    """What a file holds: numbered rows of cells, and what `Sheet` tells besides."""

    grid: Grid
    notes: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()


def _sheet(name: str, found: Cells) -> Sheet:
    """The first row apart from the others, empty rows and columns left out."""
    notes = found.notes
    grid = [(line, cells) for line, cells in found.grid if any(cell is not None for cell in cells)]
    if not grid:
        raise StudyError(f"{name} is empty")
    (first, titles), body = grid[0], grid[1:]
    width = max((len(cells) for _, cells in body), default=0)
    mistakes = [
        f"{name}:{line}: {len(cells)} cells where the first row names {len(titles)}"
        for line, cells in body
        if any(cell is not None for cell in cells[len(titles) :])
    ]
    if mistakes:
        raise StudyError(*mistakes[:10])
    rows = [[*cells, *[None] * (len(titles) - len(cells))][: len(titles)] for _, cells in body]
    full = [j for j in range(len(titles)) if any(row[j] is not None for row in rows)]
    nameless = [j for j in full if titles[j] is None]
    if nameless:
        raise StudyError(
            f"{name}:{first}: column {nameless[0] + 1} has values but no name in the first row"
        )
    if width < len(titles) or len(full) < len(titles):
        empty = [str(titles[j]) for j in range(len(titles)) if j not in full and titles[j]]
        if empty and rows:
            notes = (*notes, f"{name}: empty columns are left out: {', '.join(empty)}")
    kept = full if rows else [j for j in range(len(titles)) if titles[j] is not None]
    return Sheet(
        [str(titles[j]).strip() for j in kept],
        [[row[j] for j in kept] for row in rows],
        [line for line, _ in body],
        notes,
        found.outputs,
    )


def _text(path: Path, sheet: str | None) -> Cells:
    text, notes = _decoded(path)
    lines = [
        (number, line)
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if any('"' in line for _, line in lines):
        return Cells(_quoted(text), notes)
    delimiter = delimiter_of([line for _, line in lines[:200]], path.suffix.lower())
    return Cells([(number, _cells(line.split(delimiter))) for number, line in lines], notes)


def _quoted(text: str) -> Grid:
    """Rows of a text in which quotes may hold delimiters and ends of lines."""
    plain = [line for line in text.split("\n") if line.strip()][:200]
    delimiter = delimiter_of(plain, "")
    reader = csv.reader(io.StringIO(text), delimiter=delimiter, skipinitialspace=True)
    grid, line = [], 1
    for cells in reader:
        if not (cells and cells[0].lstrip().startswith("#")):
            grid.append((line, _cells(cells)))
        line = reader.line_num + 1
    return grid


def _cells(texts: list[str]) -> list[Any]:
    return [text.strip().strip("\u00a0") or None for text in texts]


def _decoded(path: Path) -> tuple[str, tuple[str, ...]]:
    content = path.read_bytes()
    notes: tuple[str, ...] = ()
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = content.decode("utf-16", errors="replace")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("cp1252", errors="replace")
            notes = (f"{path.name} is not in UTF-8; it is read as Windows-1252",)
    if "\0" in text:
        raise StudyError(f"{path.name} is not a text file; save the table as CSV UTF-8")
    return text.replace("\r\n", "\n").replace("\r", "\n"), notes


def delimiter_of(lines: list[str], suffix: str) -> str:
    """What stands between cells: what splits the most lines into the same number, above one."""
    if suffix == ".tsv":
        return "\t"

    def evenness(delimiter: str) -> tuple[float, int]:
        counts = [len(next(csv.reader([line], delimiter=delimiter), [])) for line in lines]
        usual = mode(counts) if counts else 1
        return (counts.count(usual) / len(counts) if usual > 1 else 0.0, usual)

    # In 1,5;2,5 both marks split evenly; a semicolon, tab or bar is then never a decimal mark.
    best = max(DELIMITERS, key=evenness)
    others = [d for d in DELIMITERS[1:] if evenness(d)[0] >= 0.9 and evenness(d)[1] > 1]
    return others[0] if best == "," and others else best


def _excel(path: Path, sheet: str | None) -> Cells:
    try:
        from openpyxl import load_workbook
        from openpyxl.utils.exceptions import InvalidFileException
    except ImportError:
        raise StudyError(
            f"{path.name}: Excel files need openpyxl: pip install 'surrogate-studies[data]'"
        ) from None
    from zipfile import BadZipFile

    try:
        book = load_workbook(path, read_only=True, data_only=True)
    except (InvalidFileException, BadZipFile, KeyError, ValueError):
        raise StudyError(f"{path.name} is no Excel workbook that can be read") from None
    if sheet is not None and sheet not in book.sheetnames:
        said = f"{path.name} has no sheet '{sheet}'; {nearest(sheet, book.sheetnames)}"
        raise StudyError(Mistake(("sheet",), said))
    chosen = book[sheet or book.sheetnames[0]]
    grid = [
        (line, [_excel_cell(cell) for cell in cells])
        for line, cells in enumerate(chosen.iter_rows(values_only=True), 1)
    ]
    many = len(book.sheetnames) > 1 and sheet is None
    note = f"{path.name}: sheet '{chosen.title}' is read, of {len(book.sheetnames)}"
    return Cells(grid, (note,) if many else ())


def _excel_cell(cell: Any) -> Any:
    return cell.strip() or None if isinstance(cell, str) else cell


def _parquet(path: Path, sheet: str | None) -> Cells:
    try:
        from pyarrow import parquet
        from pyarrow.lib import ArrowException
    except ImportError:
        raise StudyError(
            f"{path.name}: Parquet files need pyarrow: pip install 'surrogate-studies[data]'"
        ) from None
    try:
        table = parquet.read_table(path)
    except ArrowException as error:
        raise StudyError(f"{path.name} is no Parquet file that can be read: {error}") from None
    columns = [column.to_pylist() for column in table.columns]
    body = [(line, list(cells)) for line, cells in enumerate(zip(*columns, strict=True), 2)]
    return Cells([(1, list(table.column_names)), *body])


def _netcdf(path: Path, sheet: str | None) -> Cells:
    """Variables of the first dimension of a netCDF file; units go into the header.

    A dataset of runs (`surrogate.runs.dataset`) gives its parameters, its outputs and `design`.
    """
    import xarray as xr

    try:
        data = xr.load_dataset(path, decode_timedelta=False)
    except (OSError, ValueError) as error:
        if isinstance(error, FileNotFoundError):
            raise
        raise StudyError(f"{path.name} is no netCDF file that can be read") from None
    parameters = _parameters(data)
    if parameters:
        data = _as_table(data)
    flat = {str(n): v for n, v in data.variables.items() if v.ndim == 1 and str(n) != "parameter"}
    if not flat:
        raise StudyError(f"{path.name} has no variable of one dimension")
    dim = mode(v.dims[0] for v in flat.values())
    chosen = {name: v for name, v in flat.items() if v.dims[0] == dim}
    titles: list[Any] = [
        f"{name} [{v.attrs['units']}]" if v.attrs.get("units") else name
        for name, v in chosen.items()
    ]
    columns = [v.values.tolist() for v in chosen.values()]
    body = [(line, list(cells)) for line, cells in enumerate(zip(*columns, strict=True), 2)]
    outputs = [
        title
        for title, name in zip(titles, chosen, strict=True)
        if parameters and name not in (*parameters, "design")
    ]
    left = sorted(str(name) for name in data.variables if str(name) not in chosen)
    note = f"{path.name}: variables of other dimensions are left out: {', '.join(left)}"
    return Cells([(1, titles), *body], (note,) if left else (), tuple(outputs))


#: Variables of a dataset of runs that are neither inputs nor outputs.
_HISTORY = ("coded", "status", "message", "seconds", "attempts", "finished", "origin")


def _parameters(data: xr.Dataset) -> list[str]:
    """Names of the parameters of a dataset of runs; none for other datasets."""
    if "identity" not in data.attrs or "parameter" not in data.variables or "design" not in data:
        return []
    return [str(name) for name in data["parameter"].values]


def _as_table(data: xr.Dataset) -> xr.Dataset:
    """The runs that were made; `design` says train or test, where there is a test."""
    data = data.isel(run=(data["status"].values.astype(str) != "missing").nonzero()[0])
    design = data["design"].values.astype(str)
    said = ["test" if name == "test" else "train" for name in design]
    data = data.drop_vars([name for name in (*_HISTORY, "design") if name in data])
    return data.assign(design=("run", said)) if "test" in said else data


READERS: Mapping[str, Callable[[Path, str | None], Cells]] = {
    ".csv": _text,
    ".tsv": _text,
    ".txt": _text,
    ".xlsx": _excel,
    ".parquet": _parquet,
    ".nc": _netcdf,
}
