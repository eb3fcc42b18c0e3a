"""Names that a section of a study takes from others: a surrogate, an output of one number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from surrogate.errors import nearest
from surrogate.fitting.best import BEST
from surrogate.solver import Output
from surrogate.study.reading.mistakes import Reading


def check_surrogate(
    reading: Reading,
    name: str,
    needed: str,
    *path: str,
    words: Sequence[str] = (BEST,),
    on_key: bool = False,
) -> None:
    """Note when the section at `path` names a surrogate that the study does not have.

    needed  what the section needs one for, as the start of a sentence
    words   that stand for a surrogate
    on_key  the section's key is the place of the mistake that there is none
    """
    surrogates = reading.part.surrogates
    if not surrogates and not any(broken[0] == "surrogates" for broken in reading.broken):
        reading.wrong(f"{needed}, but the study has none; add surrogates:", *path, on_key=on_key)
    elif name not in (*words, *surrogates) and not reading.is_broken("surrogates", name):
        names = [*words, *surrogates]
        reading.wrong(f"surrogate '{name}' is unknown; {nearest(name, names)}", *path, "surrogate")


def is_scalar(
    reading: Reading, name: str, offered: Mapping[str, Output], needed: str, *path: str | int
) -> bool:
    """Whether the study keeps an output of this name that is a single number; noted when not.

    offered  outputs that the study keeps
    needed   what needs a single number, as the end of a sentence
    """
    if name not in offered:
        reading.wrong(f"the study has no output '{name}'; {nearest(name, offered)}", *path)
    elif offered[name].dims:
        reading.wrong(f"output '{name}' is a field; {needed}", *path)
    else:
        return True
    return False
