"""What changed in surrogates, coefficients and sensitivity indices, by summary.json."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from surrogate.differences.folder import ResultsFolder
from surrogate.differences.part import SIDES, Ends, Part, Row, overlap, side_by_side

Key = tuple[str, ...]
LEFT_OUT = ("_low", "_high", "_sampling", "_surrogate")


def surrogates_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Q2 and RMSE of each surrogate and output, on held-out runs where there are some."""
    of_a, of_b = dict(_accuracies(a.figures)), dict(_accuracies(b.figures))
    rows = [
        {
            "surrogate": surrogate,
            "output": output,
            **{
                f"{score}_{side}": (accuracy or {}).get(score)
                for score in ("q2", "rmse")
                for side, accuracy in both.items()
            },
        }
        for (surrogate, output), both in side_by_side(of_a, of_b)
    ]
    columns = {
        "surrogate": "surrogate",
        "output": "output",
        "q2_a": "Q2 in A",
        "q2_b": "Q2 in B",
        "rmse_a": "RMSE in A",
        "rmse_b": "RMSE in B",
    }
    said = tuple(_bests(a.figures, b.figures)) or ("The best surrogates are the same.",)
    return Part("surrogates", "Surrogates", said if rows else (), columns, rows)


def _accuracies(figures: Mapping[str, Any]) -> Iterator[tuple[Key, Row]]:
    table = figures.get("comparison")
    if not table:
        return
    for i, surrogate in enumerate(table["surrogate"]["values"]):
        for j, output in enumerate(table["output"]["values"]):
            test = table["q2_test"]["values"][i][j]
            how = "cv" if test is None else "test"
            row = {score: table[f"{score}_{how}"]["values"][i][j] for score in ("q2", "rmse")}
            yield (surrogate, output), row


def _bests(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    of_a, of_b = _best(a), _best(b)
    for output in of_a:
        if output in of_b and of_a[output] != of_b[output]:
            yield f"The best surrogate of {output} was {of_a[output]}, and is {of_b[output]}."


def _best(figures: Mapping[str, Any]) -> dict[str, str]:
    table = figures.get("comparison")
    if not table:
        return {}
    return dict(zip(table["output"]["values"], table["best"]["values"], strict=True))


def coefficients_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Coefficients of the regression tables with their intervals."""
    part = _intervals(
        "coefficients", "Coefficients", ("surrogate", "output", "term"), _coefficients, a, b
    )
    ranges = [(one.words or {}).get("parameters") for one in (a, b)]
    if not part.rows or ranges[0] == ranges[1]:
        return part
    said = "They are in coded units, and the parameters of the two studies differ."
    return replace(part, sentences=(*part.sentences, said))


def _coefficients(figures: Mapping[str, Any]) -> Iterator[tuple[Key, Ends]]:
    for surrogate, by_output in (figures.get("regression") or {}).items():
        for output, table in by_output.items():
            columns = [table[name]["values"] for name in ("term", "coefficient", "low", "high")]
            for term, value, low, high in zip(*columns, strict=True):
                yield (surrogate, output, term), (value, low, high)


def indices_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Sensitivity indices of single parameters with their intervals."""
    return _intervals(
        "sensitivity", "Sensitivity indices", ("output", "parameter", "index"), _indices, a, b
    )


def _indices(figures: Mapping[str, Any]) -> Iterator[tuple[Key, Ends]]:
    table = figures.get("sensitivity") or {}
    for name, figure in table.items():
        if name.endswith(LEFT_OUT) or f"{name}_low" not in table:
            continue
        if figure["dimensions"] != ["output", "parameter"]:
            continue
        ends = [table[name + end]["values"] for end in ("", "_low", "_high")]
        for i, output in enumerate(table["output"]["values"]):
            for j, parameter in enumerate(table["parameter"]["values"]):
                low, middle, high = ends[1][i][j], ends[0][i][j], ends[2][i][j]
                yield (output, parameter, name.replace("_", " ")), (middle, low, high)


def _intervals(
    key: str,
    title: str,
    names: Sequence[str],
    found: Callable[[Mapping[str, Any]], Iterator[tuple[Key, Ends]]],
    a: ResultsFolder,
    b: ResultsFolder,
) -> Part:
    """Values with intervals side by side; the terminal shows those that do not overlap."""
    of_a, of_b = dict(found(a.figures)), dict(found(b.figures))
    rows = [
        {**dict(zip(names, key, strict=True)), **both, "overlap": overlap(both["a"], both["b"])}
        for key, both in side_by_side(of_a, of_b)
    ]
    if not rows:
        return Part(key, title)
    apart = [row for row in rows if row["overlap"] is False]
    alone = [row for row in rows if row["a"] is None or row["b"] is None]
    judged = sum(row["overlap"] is not None for row in rows)
    said = [f"{len(apart)} of {judged} pairs of intervals do not overlap."]
    if alone:
        said.append(f"{len(alone)} are on one side only.")
    columns = {**{name: name for name in names}, **SIDES, "overlap": "overlap"}
    return Part(key, title, tuple(said), columns, rows, apart)
