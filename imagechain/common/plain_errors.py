"""Errors as a user is to see them: one line, without the way they took inside."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, NoReturn, ParamSpec, TypeVar

from core.errors import ImagechainError, UsageError

P = ParamSpec("P")
T = TypeVar("T")


def plain_errors(function: Callable[P, T]) -> Callable[P, T]:
    """Let the errors of a public function end at it: no frames of what it calls, and no causes.

    The cause of a plug-in's fault stays: its traceback is for who wrote it.
    """

    @wraps(function)
    def plain(*words: P.args, **named: P.kwargs) -> T:
        try:
            return function(*words, **named)
        except ImagechainError as error:
            # Raised here: below, the traceback would go on into the engine.
            raised = error.with_traceback(None)
        raised.__context__ = None
        raised.__cause__ = getattr(raised, "fault", None)
        if more := getattr(raised, "more", 0):
            raised.add_note(f"(and {more} more: chain.check() lists them)")
        raise raised

    return plain


def stays_here(value: Any) -> NoReturn:
    """As ``__reduce__`` of what holds on to an engine, and cannot go to another process."""
    raise UsageError(
        f"a {type(value).__name__} stays in the process that made it: send the chain, or arrays "
        "and tables of the result: image(), dict(readouts), curves().to_frame()"
    )
