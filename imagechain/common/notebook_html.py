"""Small pieces of HTML for notebooks; all text is escaped."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape

from core.names import printable


def text(value: object) -> str:
    """A value as text that no page takes for its own."""
    return escape(printable(str(value)))


def table(
    head: Sequence[str], rows: Iterable[Sequence[object]], *, caption: str = "", right: int = -1
) -> str:
    """A table; the cells of column `right` end together."""
    titles = "".join(f'<th style="text-align:left">{text(name)}</th>' for name in head)
    lines = [f"<tr>{''.join(_cell(v, i == right) for i, v in enumerate(row))}</tr>" for row in rows]
    above = f'<caption style="text-align:left">{text(caption)}</caption>' if caption else ""
    return f"<table>{above}<thead><tr>{titles}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def _cell(value: object, right: bool) -> str:
    return f'<td style="text-align:{"right" if right else "left"}">{text(value)}</td>'


def png(content: bytes, *, alt: str, width: int | None = None) -> str:
    """A picture within the page."""
    size = f' width="{width}"' if width else ""
    data = b64encode(content).decode("ascii")
    return (
        f'<img alt="{text(alt)}"{size} style="max-width:100%" src="data:image/png;base64,{data}">'
    )


def block(*parts: str) -> str:
    """Pieces below one another."""
    return "<div>" + "".join(f"<div>{part}</div>" for part in parts if part) + "</div>"
