"""From the words of a study to its designs."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from surrogate.designs.design import Design
from surrogate.errors import KeyPath, PluginError
from surrogate.space.space import Space
from surrogate.study import plugins
from surrogate.study.options import option_mistakes
from surrogate.study.parts import DesignPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.solver_factory import parameters_of

#: Parameters of design methods that the framework fills in; they are not options.
GIVEN_TO_DESIGNS = ("space", "coded", "folder")


def designs_of(reading: Reading, space: Space | None) -> dict[str, Design]:
    """Coded points of every design, augmentations included.

    Without a space, methods and options are checked all the same.
    """
    designs = {}
    for name, part in reading.part.designs.items():
        design = _design(reading, space, name, part)
        if design is not None:
            designs[name] = design
    if not reading.part.designs and not any(path[0] == "designs" for path in reading.broken):
        reading.wrong("name at least one design, such as train", "designs")
    return designs


def _design(reading: Reading, space: Space | None, name: str, part: DesignPart) -> Design | None:
    path = ("designs", name)
    first = _method(reading, plugins.DESIGNS, part, path)
    more = [
        _method(reading, plugins.AUGMENTATIONS, addition, (*path, "augment", index))
        for index, addition in enumerate(part.augment)
    ]
    if space is None or first is None or None in more:
        return None
    with reading.mistakes_at(*path):
        coded = _points(part.method, space, first, space)
        added = []
        for addition, method in zip(part.augment, more, strict=True):
            rows = _points(addition.method, space, method, space, coded)
            added.append((addition.method, len(rows)))
            coded = np.vstack([coded, rows])
        options = {key: value for key, value in first.keywords.items() if key != "folder"}
        return Design(name, part.method, options, coded, tuple(added))
    return None


def _points(name: str, space: Space, method: Callable[..., Any], *given: Any) -> np.ndarray:
    """Coded points (run, parameter) that a method gives, whoever wrote it."""
    coded = plugins.call(f"'{name}' fails", lambda: np.asarray(method(*given), dtype=float))
    if coded.ndim != 2 or coded.shape[1] != space.size or not np.isfinite(coded).all():
        raise PluginError(
            f"'{name}' gave an array of shape {coded.shape}; it must give coded "
            f"points (run, {space.size}), one column a parameter, all finite"
        )
    return coded


def _method(reading: Reading, group: str, part, path: KeyPath):
    """The plug-in of a design with its options filled in; None when they are wrong.

    A seed that the study leaves open follows from the design's name, so that train and
    test are not the same points.
    """
    with reading.mistakes_at(*path, "method"):
        function = plugins.load(group, part.method, reading.folder)
        mistakes = option_mistakes(function, part.options, GIVEN_TO_DESIGNS)
        reading.add(mistakes, *path)
        if mistakes:
            return None
        if not callable(function):
            raise PluginError(f"'{part.method}' is not a method: it cannot be called")
        taken = parameters_of(function)
        given = {"folder": reading.folder} if "folder" in taken else {}
        if "seed" in taken:
            given["seed"] = part.options.get("seed", zlib.crc32(path[1].encode()))
        return partial(function, **{**part.options, **given})
    return None
