"""Pages that need no other file, written by one template from blocks, whose texts are no markup."""

import base64
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from app.report.drawing.picture_drawing import DPI, MOST_DRAWN
from core.records import dataclass, field

MOST_ROWS = 500  # of a table, and nodes with read-outs: a page of more is no page
IN_FILES = "readouts.json and mtf.csv"


@dataclass(frozen=True)
class Heading:
    """A heading of a level from 1 to 3; `aside` stands smaller behind it."""

    level: int
    text: str
    aside: str = ""


@dataclass(frozen=True)
class Text:
    text: str
    kind: str = ""


@dataclass(frozen=True)
class Items:
    texts: tuple[str, ...]
    kind: str = ""


@dataclass(frozen=True)
class Drawn:
    """A picture within the file, with its caption; `alt` is its description in words."""

    png: bytes
    caption: str
    alt: str

    @property
    def width(self) -> int:
        """As many CSS pixels as it has inches."""
        return int.from_bytes(self.png[16:20], "big") * 96 // DPI


@dataclass(frozen=True)
class Grid:
    """A table; columns in `numbers` end together, `marks` gives cells of a column a class."""

    heads: Sequence[str]
    rows: Iterable[Sequence[str]]
    numbers: Sequence[int] = ()
    marks: Mapping[int, Mapping[str, str]] = field(default_factory=dict)
    kind: str = ""

    def classes(self, column: int, cell: str | None = None) -> str:
        """Classes of a head, or of a cell of that text."""
        mark = "" if cell is None else self.marks.get(column, {}).get(cell, "")
        return " ".join([*(["n"] if column in self.numbers else []), *([mark] if mark else [])])


@dataclass(frozen=True)
class Beside:
    """Blocks side by side, as far as the window is wide enough; else one below the other."""

    blocks: Sequence["Block"]


Block = Heading | Text | Items | Drawn | Grid | Beside


def of_many(count: int, what: str = "stages") -> str:
    """What a caption adds where not all is drawn; empty else."""
    if count <= MOST_DRAWN:
        return ""
    where = "the table contains" if count <= MOST_ROWS else f"{IN_FILES} contain"
    return f" Only the {MOST_DRAWN} strongest of {count:,} {what} are drawn; {where} all of them."


TEMPLATES = Path(__file__).with_name("templates")


def templates(folder: Path, **how: Any) -> Any:
    """The templates of a folder, whose values are escaped."""
    # Imported only where a page is written: 40 ms.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    how |= {"trim_blocks": True, "lstrip_blocks": True, "undefined": StrictUndefined}
    return Environment(loader=FileSystemLoader(folder), autoescape=True, **how)


def html_page(title: str, blocks: Iterable[Block]) -> str:
    environment = templates(TEMPLATES, keep_trailing_newline=True)
    environment.filters["base64"] = lambda png: base64.b64encode(png).decode()
    environment.tests["block"] = lambda block, kind: type(block).__name__ == kind
    page: str = environment.get_template("page.html").render(title=title, blocks=list(blocks))
    return page
