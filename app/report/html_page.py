"""Pages that need no other file, written from blocks by one template."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from pathlib import Path

from app.report.blocks import Block

TEMPLATES = Path(__file__).with_name("templates")


def html_page(title: str, blocks: Iterable[Block]) -> str:
    # Imported only where a page is written: 40 ms.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    environment.filters["base64"] = lambda png: base64.b64encode(png).decode()
    environment.tests["block"] = lambda block, kind: type(block).__name__ == kind
    return environment.get_template("page.html").render(title=title, blocks=list(blocks))
