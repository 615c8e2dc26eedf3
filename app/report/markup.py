"""Pieces of the HTML report."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from app.report.drawing.picture_drawing import DPI, MOST_DRAWN


def figure(png: bytes, caption: str, alt: str) -> str:
    """A picture within the file, with its caption."""
    data = base64.b64encode(png).decode()
    width = int.from_bytes(png[16:20], "big") * 96 // DPI  # as many CSS pixels as it has inches
    return (
        f'<figure><img width="{width}" alt="{escape(alt)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def of_many(count: int, what: str = "stages") -> str:
    """What a caption adds where not all is drawn; empty else."""
    if count <= MOST_DRAWN:
        return ""
    return f" Drawn are the {MOST_DRAWN} of {count} {what} that do most; the table has all of them."


def table(
    heads: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    numbers: Sequence[int] = (),
    marks: Mapping[int, Mapping[str, str]] | None = None,
    kind: str = "",
) -> str:
    """A table; columns in `numbers` end together, `marks` gives cells of a column a class."""

    def cell(tag: str, index: int, text: str) -> str:
        kinds = ["n"] if index in numbers else []
        kinds += [(marks or {}).get(index, {}).get(text, "")] if tag == "td" else []
        named = " ".join(each for each in kinds if each)
        attribute = f' class="{named}"' if named else ""
        return f"<{tag}{attribute}>{escape(str(text))}</{tag}>"

    head = "".join(cell("th", index, text) for index, text in enumerate(heads))
    lines = [
        "<tr>" + "".join(cell("td", index, text) for index, text in enumerate(row)) + "</tr>"
        for row in rows
    ]
    start = f'<table class="{kind}">' if kind else "<table>"
    body = f"<thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"
    return f"<div class=wide>{start}{body}</div>"
