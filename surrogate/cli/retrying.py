"""The option --retry-failed: all failed runs, or those of a status, or of a message."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from typer.core import TyperCommand

from surrogate.execution.rerun import MESSAGE, STATUSES

NAME, ALL = "--retry-failed", "all"


class RetryingCommand(TyperCommand):
    """A verb whose option --retry-failed may stand alone, or before what it is to choose."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the words of the command."""
        return super().parse_args(ctx, list(_joined(args)))


def _joined(args: list[str]) -> Iterator[str]:
    """`--retry-failed timed_out` as one word; `--retry-failed` alone means all."""
    words = iter([*args, ""])
    word = next(words)
    for following in words:
        if word != NAME:
            yield word
        elif following in STATUSES or following.startswith(MESSAGE):
            yield f"{NAME}={following}"
            following = next(words)
        else:
            yield f"{NAME}={ALL}"
        word = following


def chosen(words: list[str] | None) -> tuple[str, ...]:
    """What `execute` is to do again."""
    return STATUSES if ALL in (words or ()) else tuple(words or ())
