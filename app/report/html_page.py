"""Pages that need no other file: pieces of HTML whose texts are no markup, in one template."""

import base64
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from markupsafe import Markup

from app.report.drawing.picture_drawing import DPI, MOST_DRAWN

MOST_ROWS = 500  # of a table, and nodes with read-outs: a page of more is no page
_IN_FILES = "readouts.json and mtf.csv"
Marks = Mapping[int, Mapping[str, str]]
_NONE: Marks = MappingProxyType({})


def heading(level: int, text: str, aside: str = "") -> str:
    """A heading of a level from 1 to 3; `aside` stands smaller behind it."""
    small = " " + _element("small", aside) if aside else ""
    return _element(f"h{level}", Markup("{}{}").format(text, small)) + "\n"


def paragraph(text: str, kind: str = "") -> str:
    return _element("p", text, kind) + "\n"


def items(texts: Iterable[str], kind: str = "") -> str:
    return _element("ul", Markup("").join(_element("li", text) for text in texts), kind) + "\n"


def drawn(png: bytes, caption: str, alt: str) -> str:
    """A picture as wide in CSS pixels as in inches; `alt` is its description in words."""
    width, data = int.from_bytes(png[16:20], "big") * 96 // DPI, base64.b64encode(png).decode()
    image = Markup('<img width="{}" alt="{}" src="data:image/png;base64,{}">')
    return (
        _element("figure", image.format(width, alt, data) + _element("figcaption", caption)) + "\n"
    )


def grid(
    heads: Sequence[str],
    rows: Iterable[Sequence[str]],
    numbers: Sequence[int] = (),
    marks: Marks = _NONE,
    kind: str = "",
    *,
    most: int | None = None,
) -> str:
    """A table; columns in `numbers` end together, `marks` gives cells of a column a class.

    Of more than `most` rows the first alone are shown, and a line says so.
    """

    def line(name: str, row: Sequence[str], marks: Marks) -> Markup:
        cells = Markup("")
        for column, text in enumerate(row):
            kinds = ("n" if column in numbers else "", marks.get(column, {}).get(text, ""))
            cells += _element(name, text, " ".join(filter(None, kinds)))
        return _element("tr", cells)

    rows = list(rows)
    body = Markup("").join(line("td", row, marks) + "\n" for row in rows[:most])
    inner = Markup("\n<thead>{}</thead>\n<tbody>\n{}</tbody>").format(
        line("th", heads, _NONE), body
    )
    table = _element("div", _element("table", inner, kind), "wide") + "\n"
    cut = most is not None and len(rows) > most
    return table + (paragraph(first_of(len(rows), "rows")) if cut else "")


report_grid = partial(grid, most=MOST_ROWS)


def beside(blocks: Iterable[str]) -> str:
    """Blocks side by side, as far as the window is wide enough; else one below the other."""
    return _element("div", Markup("\n{}").format(Markup("").join(blocks)), "beside") + "\n"


def _element(name: str, content: str, kind: str = "") -> Markup:
    given = Markup(' class="{}"').format(kind) if kind else ""
    return Markup("<{0}{1}>{2}</{0}>").format(name, given, content)


def first_of(count: int, what: str) -> str:
    return f"The first {MOST_ROWS} of {count:,} {what}; {_IN_FILES} contain all of them."


def of_many(count: int, what: str = "stages") -> str:
    """What a caption adds where not all is drawn; empty else."""
    if count <= MOST_DRAWN:
        return ""
    where = "the table contains" if count <= MOST_ROWS else f"{_IN_FILES} contain"
    return f" Only the {MOST_DRAWN} strongest of {count:,} {what} are drawn; {where} all of them."


TEMPLATES = Path(__file__).with_name("templates")


def templates(folder: Path, **how: Any) -> Any:
    # Imported only where a page is written: 40 ms.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    how |= {"trim_blocks": True, "lstrip_blocks": True, "undefined": StrictUndefined}
    return Environment(loader=FileSystemLoader(folder), autoescape=True, **how)


def page(title: str, blocks: Iterable[str]) -> str:
    template = templates(TEMPLATES, keep_trailing_newline=True).get_template("page.html")
    return str(template.render(title=title, content=Markup("").join((heading(1, title), *blocks))))
