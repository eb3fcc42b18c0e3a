"""What the checks of all kinds of plug-in share: collecting sentences, watching side effects."""

from __future__ import annotations

import inspect
import pickle
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from surrogate.errors import PluginError, SurrogateError


def conclude(name: str, sentences: Iterable[str]) -> None:
    """Raise `PluginError` when there are any sentences."""
    found = [f"{name}: {sentence}" for sentence in dict.fromkeys(sentences)]
    if found:
        raise PluginError("\n".join(found))


def documented(plugin: Any) -> Iterable[str]:
    """A plug-in's first docstring line is what `surrogate list` prints."""
    if not (inspect.getdoc(plugin) or "").strip():
        yield "has no docstring; write one line that says what it is"


def attempt(
    what: str, call: Callable[[], Any], allowed: type[Exception] | tuple[type[Exception], ...] = ()
) -> tuple[Any, list[str]]:
    """Result of a call, and a sentence when it raised something that is not `allowed`.

    An allowed error without a message is no better than none.
    """
    try:
        return call(), []
    except allowed as error:
        empty = [f"{what} raised {type(error).__name__} without a message; say why"]
        return None, [] if str(error).strip() else empty
    except Exception as error:
        kind = type(error).__name__
        names = [a.__name__ for a in (allowed if isinstance(allowed, tuple) else (allowed,))]
        cure = f"; raise {' or '.join(names)} with a sentence instead" if names else ""
        said = str(error).strip().split("\n")[0] if not isinstance(error, SurrogateError) else error
        return None, [f"{what} raised {kind}: {said}{cure}"]


@contextmanager
def global_randomness(sentences: list[str]) -> Iterator[None]:
    """Add a sentence when NumPy's global random state is used meanwhile."""
    before = pickle.dumps(np.random.get_state())  # noqa: NPY002 - this watches for its use
    yield
    if pickle.dumps(np.random.get_state()) != before:  # noqa: NPY002
        sentences.append(
            "uses NumPy's global random state, which other code changes too; "
            "use np.random.default_rng(seed)"
        )


def same(a: Any, b: Any) -> bool:
    """True when two answers are equal to the last bit, NaN included."""
    return np.array_equal(np.asarray(a, dtype=float), np.asarray(b, dtype=float), equal_nan=True)
