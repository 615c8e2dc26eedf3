"""Errors as the user sees them: one line, without the traceback inside the package."""

from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from html import escape
from importlib import import_module
from types import ModuleType
from typing import Any, NoReturn, ParamSpec, TypeVar

from core.errors import ImagechainError, UsageError, printable

P = ParamSpec("P")
T = TypeVar("T")


def plain_errors(function: Callable[P, T]) -> Callable[P, T]:
    """Cut the traceback of errors at a public function: no inner frames and no causes."""

    @wraps(function)
    def plain(*words: P.args, **named: P.kwargs) -> T:
        try:
            return function(*words, **named)
        except ImagechainError as error:
            # Raised here: below, the traceback would go on into the engine.
            raised = error.with_traceback(None)
        raised.__context__ = None
        raised.__cause__ = getattr(raised, "fault", None)
        if (more := len(getattr(raised, "problems", ())) - 1) > 0:
            raised.add_note(f"(and {more} more; chain.check() lists all errors)")
        raise raised

    return plain


def stays_here(value: Any) -> NoReturn:
    """``__reduce__`` of objects that hold an engine and cannot be sent to another process."""
    raise UsageError(
        f"a {type(value).__name__} cannot be sent to another process: send the chain, or the "
        "result's arrays and tables: image(), dict(readouts), curves().to_frame()"
    )


# Libraries that are used where they are installed, and not needed otherwise.


def needed(name: str, purpose: str) -> ModuleType:
    """Import an optional library; raises `UsageError` if the library is not installed."""
    try:
        return import_module(name)
    except ImportError:
        raise UsageError(
            f"{purpose} need {name}, which is not installed: run pip install {name}"
        ) from None


# Small pieces of HTML for notebooks; all text is escaped.


def text(value: object) -> str:
    """A value as text, escaped for HTML."""
    return escape(printable(str(value)))


def table(
    head: Sequence[str], rows: Iterable[Sequence[object]], *, caption: str = "", right: int = -1
) -> str:
    """An HTML table, with column number `right`, counted from 0, aligned to the right."""
    titles = "".join(f'<th style="text-align:left">{text(name)}</th>' for name in head)
    lines = [f"<tr>{''.join(_cell(v, i == right) for i, v in enumerate(row))}</tr>" for row in rows]
    above = f'<caption style="text-align:left">{text(caption)}</caption>' if caption else ""
    return f"<table>{above}<thead><tr>{titles}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def _cell(value: object, right: bool) -> str:
    return f'<td style="text-align:{"right" if right else "left"}">{text(value)}</td>'


def png(content: bytes, *, alt: str, width: int | None = None) -> str:
    """A picture embedded in the page."""
    size = f' width="{width}"' if width else ""
    data = b64encode(content).decode("ascii")
    return (
        f'<img alt="{text(alt)}"{size} style="max-width:100%" src="data:image/png;base64,{data}">'
    )


def block(*parts: str) -> str:
    """HTML parts, one below the other."""
    return "<div>" + "".join(f"<div>{part}</div>" for part in parts if part) + "</div>"
