"""All runs; the failed ones in a table of their own."""

from __future__ import annotations

import json
from collections.abc import Sequence
from textwrap import shorten

import numpy as np

from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Fold, Head, Points, Section, Table, Text
from surrogate.report.content import Content

#: Longer tables start folded.
LONG = 25
#: Letters of a message in the table of all runs; the table of failed runs has all of it.
LONGEST = 120


def section(content: Content) -> Section:
    """The failed runs with their messages, and the table of all runs."""
    blocks: list[Block] = [Text(_count(content))]
    if content.notes:
        blocks.append(Points(tuple(f"{note}." for note in content.notes), "note"))
    blocks += [Text(_scatter(content, name)) for name in content.replicates]
    if content.failures is not None:
        words = f"{content.failing} A classification tree tells failed runs "
        words += f"from good ones there, better than chance (p = {content.failures.p:.2g})."
        blocks.append(Text(words, "warning"))
    if content.failed.any():
        blocks.append(_failures(content))
    count = len(content.ok)
    table = _table(content)
    title = f"All {digits.quantity(count, 'run')}"
    if not content.shown.all():
        title = f"{content.shown.sum()} of {digits.quantity(count, 'run')}; runs.nc has all"
    blocks.append(Fold(title, (table,), open=count <= LONG))
    return Section("runs", "Runs", tuple(blocks))


def _count(content: Content) -> str:
    count, failed, missing = (
        int(which.sum()) for which in (np.ones_like(content.ok), content.failed, content.missing)
    )
    said = [f"{failed} failed"] * bool(failed) + [f"{missing} not done yet"] * bool(missing)
    words = f"{digits.quantity(count, 'run')}, {digits.listing(said) or 'all finished'}."
    for name, stored in json.loads(content.runs.attrs.get("stored", "{}")).items():
        words += (
            f" {stored} of them {'was' if stored == 1 else 'were'} read from {name}, not run here."
        )
    if np.isfinite(content.seconds).any():
        again = content.repeated
        seconds = content.seconds[~again]
        words += (
            f" They took {digits.duration(np.nansum(seconds))} of solver time, "
            f"{digits.duration(np.nanmedian(seconds))} a run (median)"
        )
        words += (
            f"; {digits.quantity(int(again.sum()), 'run')} that designs share "
            f"{'is' if again.sum() == 1 else 'are'} counted once."
            if again.any()
            else "."
        )
    return words


def _scatter(content: Content, output: str) -> str:
    """What the replicates say of the noise."""
    scatter = content.replicates[output]
    std = digits.with_unit(digits.figure(scatter.std, 2), content.unit(output))
    return (
        f"{digits.quantity(scatter.points, 'point')} with replicates "
        f"({digits.quantity(scatter.runs, 'run')}): the pure error of {output} has a standard "
        f"deviation of {std} ({scatter.freedom} degrees of freedom). Replicates are left out "
        "together in cross-validation."
    )


def _failures(content: Content) -> Table:
    rows, which = [], np.flatnonzero(content.failed & content.shown)
    physical = _physical(content, which)
    design, status, message = map(content.words, ("design", "status", "message"))
    for place, k in enumerate(which):
        values = "; ".join(
            f"{name} {digits.with_unit(physical[name][place], content.unit(name))}"
            for name in content.space.names
        )
        rows.append(
            (
                Cell(str(content.numbers[k]), float(k)),
                Cell(design[k]),
                _status(status[k]),
                Cell(message[k] or "no message"),
                Cell(values),
            )
        )
    words = ("run", "design", "status", "message", "at")
    return Table(
        "Failed runs. They are not used for training.",
        tuple(Head(word, numeric=False) for word in words),
        tuple(rows),
    )


def _table(content: Content) -> Table:
    rows = np.flatnonzero(content.shown)
    physical = _physical(content, rows)

    def words(variable: str) -> np.ndarray:
        return content.words(variable)[rows]

    columns: list[tuple[Head, list[Cell]]] = [
        (Head("run"), [Cell(str(content.numbers[k]), float(k)) for k in rows]),
        (Head("design", numeric=False), [Cell(word) for word in words("design")]),
        (Head("status", numeric=False), [_status(word) for word in words("status")]),
    ]
    for name in content.space.names:
        head = digits.labelled(name, content.unit(name))
        columns.append(
            (
                Head(head, numeric=not content.space[name].categorical),
                _column(content.runs[name].values[rows], physical[name]),
            )
        )
    for output in content.outputs:
        values = content.values(output)[rows]
        mean = values.reshape(len(values), -1).mean(axis=1)
        what = f"mean {output}" if content.is_field(output) else output
        columns.append(
            (
                Head(digits.labelled(what, content.unit(output))),
                _column(mean, digits.column(mean, 4)),
            )
        )
    if (words("origin") != "").any():
        cells = [Cell(word) for word in words("origin")]
        columns.append((Head("origin", numeric=False), cells))
    spent = content.seconds[rows]
    if np.isfinite(spent).any() or not content.recorded:
        columns.append((Head("time (s)"), _column(spent, [digits.figure(s) for s in spent])))
    if (words("message") != "").any():
        columns.append(
            (
                Head("message", numeric=False),
                [Cell(shorten(word, LONGEST, placeholder=" …")) for word in words("message")],
            )
        )
    listed = tuple(zip(*(cells for _, cells in columns), strict=True))
    return Table(
        "Every run with its inputs and outputs. Click a column head to sort.",
        tuple(head for head, _ in columns),
        listed,
        sortable=True,
        wide=len(columns) > 9,
    )


def _status(word: str) -> Cell:
    return Cell(word.replace("_", " "), tone="" if word == "ok" else "bad")


def _column(values: np.ndarray, words: Sequence[str]) -> list[Cell]:
    values = np.asarray(values)
    if not np.issubdtype(values.dtype, np.number):
        return [Cell(str(word)) for word in words]
    return [
        Cell(word, float(v) if np.isfinite(v) else None)
        for word, v in zip(words, values, strict=True)
    ]


def _physical(content: Content, rows: np.ndarray) -> dict[str, list[str]]:
    """Parameter values of some runs as printed."""
    printed = {}
    for parameter in content.space.parameters:
        values = content.runs[parameter.name].values[rows]
        printed[parameter.name] = (
            [str(v) for v in values] if parameter.categorical else digits.column(values, 4)
        )
    return printed


def for_pointing(content: Content) -> dict[str, str]:
    """Run number -> the lines shown when its mark is pointed at."""
    rows = np.flatnonzero(content.shown)
    physical = _physical(content, rows)
    lines = {}
    design, status = content.words("design"), content.words("status")
    for place, k in enumerate(rows):
        number = content.numbers[k]
        inputs = [
            f"{name} {digits.with_unit(physical[name][place], content.unit(name))}"
            for name in content.space.names
        ]
        title = f"run {number} ({design[k]})"
        if status[k] != "ok":
            title += f" {status[k].replace('_', ' ')}"
        lines[str(number)] = "\n".join([title, *inputs])
    return lines
