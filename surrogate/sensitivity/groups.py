"""Groups of parameters whose share of the variance is asked for as a whole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from inspect import signature

from surrogate.errors import StudyError, nearest
from surrogate.estimator import has_indices
from surrogate.space.space import Space

#: Group name -> names of its parameters, none of them in another group.
Named = Mapping[str, Sequence[str]]


def numbers(space: Space, groups: Named | None) -> list[list[int]]:
    """Input numbers of each group; none without groups. Raises `StudyError` with all mistakes."""
    found = mistakes(groups or {}, space.names)
    if found:
        raise StudyError(*(sentence for _, sentence in found))
    return [[space.names.index(name) for name in members] for members in (groups or {}).values()]


def mistakes(groups: Named, names: Sequence[str]) -> list[tuple[tuple[str | int, ...], str]]:
    """(place below `groups`, sentence) of each group or member that cannot stand.

    names: the study's parameters. A place of one word is the group's name.
    """
    found: list[tuple[tuple[str | int, ...], str]] = []
    home: dict[str, str] = {}
    for group, members in groups.items():
        if not members:
            found.append(((group,), f"group '{group}' is empty; name its parameters, or drop it"))
        for place, name in enumerate(members):
            if name not in names:
                found.append(
                    (
                        (group, place),
                        f"'{name}' is not a parameter of this study; {nearest(name, names)}",
                    )
                )
            elif name in home:
                where = f"group '{home[name]}'" if home[name] != group else "this group"
                found.append(
                    (
                        (group, place),
                        f"'{name}' is already in {where}; a parameter belongs to one group, once",
                    )
                )
            else:
                home[name] = group
    return found


def knows_groups(estimator: object) -> bool:
    """True when the estimator has Sobol' indices of groups in closed form."""
    if not has_indices(estimator):
        return False
    single = getattr(estimator, "estimator", estimator)  # that of a field's modes
    return "groups" in signature(single.sobol_indices).parameters
