"""Generators of a fraction in the words of a study file.

`D = ABC` and `ABC` name parameters by position (A, B, .. without I); `length = tension *
mu_skin` by name. `-` before the product reverses the sign. Without a left-hand side the
generators make the last parameters, in order.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surrogate.designs.minimum_aberration import LETTERS
from surrogate.errors import DesignError

Generator = tuple[str, list[str], float]


def read(generators: Sequence[str], names: Sequence[str]) -> list[Generator]:
    """(made parameter, factors of its product, sign) for each generator.

    Raises `DesignError` with a sentence for each mistake.
    """
    if isinstance(generators, str) or not generators:
        raise DesignError(f"generators: {generators!r} must be a list such as ['D = AB', 'E = AC']")
    made, mistakes = [], []
    last = list(names)[-len(generators) :]
    for text, default in zip(generators, last, strict=False):
        try:
            made.append(_read_one(str(text), default, names))
        except DesignError as error:
            mistakes.append(str(error))
    mistakes = mistakes or _contradictions(made, generators, names)
    if mistakes:
        raise DesignError("\n".join(mistakes))
    return made


def _read_one(text: str, default: str, names: Sequence[str]) -> Generator:
    left, equals, right = text.rpartition("=")
    right = right.strip()
    sign = -1.0 if right.startswith("-") else 1.0
    product = _parameters(right.lstrip("+-").strip(), text, names)
    target = _parameters(left.strip(), text, names) if equals else [default]
    if len(target) != 1:
        raise DesignError(f"generators: '{text}' must have one parameter left of '='")
    return target[0], product, sign


def _parameters(text: str, generator: str, names: Sequence[str]) -> list[str]:
    """Parameter names in a product written by name (a * b, a:b) or by letters (AB)."""
    if text in names:
        return [text]
    parts = [part.strip() for part in text.replace(":", "*").split("*")]
    if len(parts) == 1 and not set(text) <= set(names):
        letters = dict(zip(LETTERS, names, strict=False))
        parts = [letters.get(letter, letter) for letter in text]
    elif len(parts) == 1:
        parts = list(text)
    wrong = [part for part in parts if part not in names] if text else ["nothing"]
    if wrong:
        legend = ", ".join(f"{a} = {b}" for a, b in zip(LETTERS, names, strict=False))
        raise DesignError(
            f"generators: '{wrong[0]}' in '{generator}' is not a parameter; "
            f"write letters ({legend}) or names joined by *"
        )
    return parts


def _contradictions(made: list[Generator], texts: Sequence[str], names: Sequence[str]) -> list[str]:
    targets = [target for target, _, _ in made]
    base = [name for name in names if name not in targets]
    if len(texts) >= len(names):
        return [
            f"generators: {len(texts)} generators leave no base factor among "
            f"{len(names)} parameters; give at most {len(names) - 1}"
        ]
    mistakes = [
        f"generators: {target} is made twice"
        for target in sorted(set(targets))
        if targets.count(target) > 1
    ]
    seen: dict[frozenset[str], str] = {frozenset([name]): name for name in base}
    for (target, product, _), text in zip(made, texts, strict=True):
        if not set(product) <= set(base):
            other = ", ".join(sorted(set(product) - set(base)))
            mistakes.append(
                f"generators: '{text}' uses {other}, which a generator makes; "
                f"use the base factors {', '.join(base)}"
            )
            continue
        twin = seen.setdefault(_odd(product), target)
        if not _odd(product):
            mistakes.append(f"generators: '{text}' makes {target} constant")
        elif twin != target:
            mistakes.append(
                f"generators: '{text}' makes {target} change together with {twin}; "
                "choose another product"
            )
    return mistakes


def _odd(product: list[str]) -> frozenset[str]:
    """Factors that remain of a product, since the square of a level is 1."""
    return frozenset(name for name in product if product.count(name) % 2)


def matrix(generators: Sequence[Generator], names: Sequence[str]) -> np.ndarray:
    """Levels -1 and 1, (2^(parameters - generators), parameter), base factors in Yates order."""
    made = {target: (product, sign) for target, product, sign in generators}
    base = [name for name in names if name not in made]
    runs = np.arange(2 ** len(base))
    levels = {name: np.where(runs >> i & 1, 1.0, -1.0) for i, name in enumerate(base)}
    for target, (product, sign) in made.items():
        levels[target] = sign * np.prod([levels[name] for name in product], axis=0)
    return np.column_stack([levels[name] for name in names])
