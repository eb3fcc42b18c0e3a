"""From the words of a study to its designs."""

from __future__ import annotations

import hashlib
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.design import Design
from surrogate.designs.requirements import uncut
from surrogate.errors import DesignError, KeyPath, Mistake, PluginError
from surrogate.runs.identity import canonical
from surrogate.solver import Solver
from surrogate.space.space import Space
from surrogate.stages.plugin import call, parameters_of
from surrogate.study import plugins
from surrogate.study.kinds import check_kind
from surrogate.study.options import option_mistakes
from surrogate.study.parts.adaptive import AdaptivePart
from surrogate.study.parts.methods import AugmentPart, DesignPart
from surrogate.study.reading.mistakes import Reading

#: Parameters of design methods that the framework fills in; they are not options.
GIVEN_TO_DESIGNS = ("space", "coded", "folder")


def designs_of(reading: Reading, space: Space | None) -> dict[str, Design]:
    """Every design; those that are no search with their points, augmentations included.

    An adaptive design has its initial points. Of a search the options are checked and the
    points counted. Without a space, methods and options are checked all the same.
    """
    designs = {}
    for name, part in reading.part.designs.items():
        if isinstance(part, AdaptivePart):
            design = _design(reading, space, name, part.initial, "initial")
            design = design and replace(design, method=part.method)
        else:
            design = _design(reading, space, name, part)
        if design is not None:
            designs[name] = design
    needed = not reading.part.designs and reading.part.data is None
    if needed and not any(path[0] == "designs" for path in reading.broken):
        reading.wrong("name at least one design, such as train", "designs")
    return designs


def replicated(
    reading: Reading, designs: Mapping[str, Design], solver: Solver
) -> dict[str, Design]:
    """The designs with every point as often as the study says."""
    times = reading.part.replicates
    if times > 1 and getattr(solver, "deterministic", True):
        reading.wrong(
            "replicates of a deterministic solver are all the same; leave them out, or declare "
            "deterministic = False in the solver",
            "replicates",
        )
    elif times > 1 and getattr(solver, "recorded", False):
        reading.wrong("the replicates of a table are its rows; leave this out", "replicates")
    return {n: one.repeated(times) if times > 1 else one for n, one in designs.items()}


def searched(designs: Iterable[Design]) -> list[Mistake]:
    """Searches for the points of the designs; why those that cannot be had cannot."""
    mistakes = []
    for design in designs:
        try:
            _ = design.coded
        except (DesignError, PluginError) as error:
            mistakes.append(Mistake(("designs", design.name), str(error)))
    return mistakes


def _design(
    reading: Reading, space: Space | None, name: str, part: DesignPart, *below: str
) -> Design | None:
    """The design called `name`; below: where its part stands within the entry of this name."""
    path = ("designs", name, *below)
    first = _method(reading, plugins.DESIGNS, part, path)
    more = [
        _method(reading, plugins.AUGMENTATIONS, addition, (*path, "augment", index))
        for index, addition in enumerate(part.augment)
    ]
    methods = [method for method in (first, *more) if method is not None]
    if space is None or len(methods) <= len(part.augment):
        return None
    names = [part.method, *(addition.method for addition in part.augment)]
    options = {key: value for key, value in methods[0].keywords.items() if key != "folder"}
    with reading.mistakes_at(*path):
        searched = any(hasattr(method.func, "rows") for method in methods)
        parts = _tried(space, names, methods) if searched else _parts(space, names, methods)
        coded = np.vstack(parts)
        added = tuple(zip(names[1:], map(len, parts[1:]), strict=True))
        if not searched:
            found = partial(np.asarray, coded)
            return Design(name, part.method, options, len(coded), found, added)
        return Design(
            name,
            part.method,
            options,
            len(coded),
            partial(_all_points, space, names, methods),
            added,
            searched=True,
            spread=all(getattr(method.func, "spread", False) for method in methods),
            identity=_identity(
                space, names, [options, *(method.keywords for method in methods[1:])]
            ),
        )
    return None


def _identity(space: Space, names: Sequence[str], options: Sequence[Mapping[str, Any]]) -> str:
    """Equal for designs of equal methods, options and laws of the parameters in their order."""
    laws = [[p.name, p.distribution and p.distribution.words, p.levels] for p in space.parameters]
    joined = [[one.text for one in space.constraints], space.fixed] if space.constraints else []
    said = canonical([list(zip(names, options, strict=True)), laws, space.correlation, *joined])
    return hashlib.sha256(said.encode()).hexdigest()[:32]


def _all_points(
    space: Space, names: Sequence[str], methods: Sequence[Callable[..., Any]]
) -> NDArray[np.float64]:
    """Points of a design and its augmentations."""
    return np.vstack(_parts(space, names, methods))


def _parts(
    space: Space, names: Sequence[str], methods: Sequence[Callable[..., Any]]
) -> list[NDArray[np.float64]]:
    """Points of a design, then those that each augmentation adds to all before it."""
    parts = [_points(names[0], space, methods[0], space)]
    for name, method in zip(names[1:], methods[1:], strict=True):
        parts.append(_points(name, space, method, space, np.vstack(parts)))
    return parts


def _tried(
    space: Space, names: Sequence[str], methods: Sequence[partial[Any]]
) -> list[NDArray[np.float64]]:
    """As many points as `_parts` gives, but others for those that are searched for.

    The options of a search are checked, and augmentations that are none are tried.
    """
    parts: list[NDArray[np.float64]] = []
    for name, method in zip(names, methods, strict=True):
        given = (space, np.vstack(parts)) if parts else (space,)
        if hasattr(method.func, "rows"):
            options = {key: value for key, value in method.keywords.items() if key != "folder"}
            parts.append(space.sample(method.func.rows(*given, **options), seed=0))
        else:
            parts.append(_points(name, space, method, *given))
    return parts


def _points(
    name: str, space: Space, method: Callable[..., Any], *given: Any
) -> NDArray[np.float64]:
    """Coded points (run, parameter) that a method gives, whoever wrote it."""
    coded: NDArray[np.float64] = call(
        f"'{name}' fails", lambda: np.asarray(method(*given), dtype=float)
    )
    if coded.ndim != 2 or coded.shape[1] != space.size or not np.isfinite(coded).all():
        raise PluginError(
            f"'{name}' gave an array of shape {coded.shape}; it must give coded "
            f"points (run, {space.size}), one column a parameter, all finite"
        )
    return uncut(space, space.snap(coded), name)


def _method(
    reading: Reading, group: str, part: DesignPart | AugmentPart, path: KeyPath
) -> partial[Any] | None:
    """The plug-in of a design with its options filled in; None when they are wrong.

    A seed that the study leaves open follows from the design's name, so that train and
    test are not the same points.
    """
    with reading.mistakes_at(*path, "method"):
        function = plugins.load(group, part.method, reading.folder)
        check_kind(group, part.method, function)
        mistakes = option_mistakes(function, part.options, GIVEN_TO_DESIGNS)
        reading.add(mistakes, *path)
        if mistakes:
            return None
        if not callable(function):
            raise PluginError(f"'{part.method}' is not a method: it cannot be called")
        taken = parameters_of(function)
        given = {"folder": reading.folder} if "folder" in taken else {}
        if "seed" in taken:
            given["seed"] = part.options.get("seed", zlib.crc32(str(path[1]).encode()))
        return partial(function, **{**part.options, **given})
    return None
