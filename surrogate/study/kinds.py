"""Is an object what a study takes it for? Decided by looking, before anything of it is called.

A study may name any `module:object`; called with options of the study, many a function
would do harm (`subprocess:run`). Installed plug-ins are trusted, they were installed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from typing_extensions import get_type_hints

from surrogate.errors import PluginError
from surrogate.stages.plugin import parameters_of
from surrogate.study.plugins import AUGMENTATIONS, DESIGNS, EXECUTORS, REGRESSORS, SOLVERS
from surrogate.study.solver_factory import is_built


def check_kind(group: str, name: str, found: Any) -> None:
    """Raise `PluginError` when the object called `module:object` is none of this group."""
    if ":" in name and group in _KINDS:
        fits, wanted = _KINDS[group]
        if not fits(found):
            raise PluginError(f"'{name}' is not called: {wanted}")


def _is_solver(found: Any) -> bool:
    return is_built(found) or _makes(found, ("inputs", "outputs", "__call__"))


def _is_regressor(found: Any) -> bool:
    return _makes(found, ("fit", "predict"))


def _is_design(found: Any) -> bool:
    return not callable(found) or "space" in parameters_of(found)


def _is_executor(found: Any) -> bool:
    return _makes(found, ("submit", "shutdown"))


def _makes(found: Any, words: tuple[str, ...]) -> bool:
    """True for a class with these attributes, and for a function annotated to return one."""
    if not isinstance(found, type) and callable(found):
        try:
            found = get_type_hints(found).get("return")
        except (NameError, TypeError, AttributeError):
            return False
    return isinstance(found, type) and set(words) <= _attributes(found)


def _attributes(kind: type) -> set[str]:
    """What a class declares: its attributes, annotations, and names that its methods use."""
    names: set[str] = set()
    for base in kind.__mro__[:-1]:
        names |= {*vars(base), *vars(base).get("__annotations__", {})}
        for method in vars(base).values():
            names |= set(getattr(getattr(method, "__code__", None), "co_names", ()))
    return names


_KINDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    SOLVERS: (
        _is_solver,
        "a solver is a class that declares inputs, outputs and __call__ (see surrogate.solver), "
        "or a function annotated to return one",
    ),
    REGRESSORS: (
        _is_regressor,
        "a regressor is a class with fit and predict, or a function annotated to return one",
    ),
    DESIGNS: (_is_design, "a design is a function of `space` that gives coded points"),
    EXECUTORS: (
        _is_executor,
        "an executor is a class of concurrent.futures' Executor, or a function annotated to "
        "return one",
    ),
    AUGMENTATIONS: (_is_design, "an augmentation is a function of `space` and `coded`"),
}
