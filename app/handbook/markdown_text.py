"""Markdown as pieces of pages: titles with anchors, tables, code, formulas and drawings.

Beside plain Markdown there are

- *Module Title* in slanted letters, which becomes a link to the module's page;
- a block of `math`, TeX to be typeset;
- a block of `figure`, words that name a drawing (see `page_figures`);
- a file's name behind the language of a block of code, which is shown above it;
- a block of `output`, what the code above it prints.
"""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from app.handbook.formula_drawing import formula_svg

Figure = Callable[[str], str]
_SHORT = 28  # letters of code that stay on one line
_SOURCE = re.compile(r"^(\w+)\.md\b")
_REMARK = re.compile(r"^<!--.*-->\n", re.MULTILINE)  # such as marks to write between


@dataclass(frozen=True)
class Heading:
    """A title within a page."""

    level: int
    text: str
    anchor: str


@dataclass
class Rendered:
    """A page's body, and what it says."""

    title: str = ""
    lead: str = ""
    body: str = ""
    headings: list[Heading] = field(default_factory=list)
    words: str = ""


@dataclass(frozen=True)
class Block:
    """A block of code, of output, or of a file's content."""

    kind: str
    name: str
    text: str


def blocks_of(text: str) -> list[Block]:
    """The fenced blocks of a page, in order."""
    blocks = []
    for token in _parser().parse(text):
        if token.type == "fence":
            kind, _, name = token.info.strip().partition(" ")
            blocks.append(Block(kind, name.strip(), token.content))
    return blocks


def rendered(text: str, modules: Mapping[str, str], figure: Figure) -> Rendered:
    """A page of Markdown.

    Parameters
    ----------
    text : str
        The Markdown; it begins with a title and a paragraph on what the page is about.
    modules : mapping
        Address of a module's page by its title.
    figure : callable
        The drawing that a block of `figure` names.
    """
    parser = _parser()
    page = Rendered()
    tokens = parser.parse(_REMARK.sub("", text))
    _name_headings(tokens, page)
    _link_modules(tokens, modules)
    _link_pages(tokens)
    _wrap_tables(tokens)
    parser.add_render_rule("fence", _fence(figure))
    parser.add_render_rule("code_inline", _code)
    page.body = parser.renderer.render(tokens, parser.options, {})
    page.words = " ".join(
        token.content for token in tokens if token.type in ("inline", "fence", "code_block")
    )
    paragraphs = (token.content for token in tokens if token.type == "inline")
    next(paragraphs, "")
    page.lead = next(paragraphs, "")
    return page


def anchor_of(text: str) -> str:
    """The name by which a title can be linked to."""
    return re.sub(r"[^\w]+", "-", text.casefold()).strip("-")


def _parser() -> Any:
    # Imported only where pages are made.
    from markdown_it import MarkdownIt

    return MarkdownIt("commonmark", {"html": False}).enable("table")


def _name_headings(tokens: list[Any], page: Rendered) -> None:
    for token, inline in pairwise(tokens):
        if token.type != "heading_open":
            continue
        text = re.sub(r"[*`]", "", inline.content)
        anchor = anchor_of(text)
        if token.tag == "h1":
            page.title = text
        else:
            token.attrSet("id", anchor)
            page.headings.append(Heading(int(token.tag[1]), text, anchor))


def _link_modules(tokens: list[Any], modules: Mapping[str, str]) -> None:
    """Make a link of slanted words that are a module's title."""
    for token in tokens:
        children = token.children or []
        for first, inner, last in zip(children, children[1:], children[2:], strict=False):
            if first.type == "em_open" and last.type == "em_close" and inner.content in modules:
                first.type, first.tag = "link_open", "a"
                first.attrSet("href", modules[inner.content])
                last.type, last.tag = "link_close", "a"


def _link_pages(tokens: list[Any]) -> None:
    """In the sources pages link to each other's sources, which can be read as they are, too."""
    for token in tokens:
        for child in token.children or []:
            if child.type == "link_open":
                child.attrSet("href", _SOURCE.sub(r"\1.html", child.attrGet("href") or ""))


def _wrap_tables(tokens: list[Any]) -> None:
    """A wide table scrolls by itself, not the page."""
    from markdown_it.token import Token

    for place in range(len(tokens) - 1, -1, -1):
        if tokens[place].type in ("table_open", "table_close"):
            opening = tokens[place].type == "table_open"
            wrapper = Token("html_block", "", 0)
            wrapper.content = '<div class="wide">\n' if opening else "</div>\n"
            tokens.insert(place if opening else place + 1, wrapper)


def _commands(lines: str) -> str:
    """Lines of a shell that go on in the next where they are long, between words alone."""
    return "".join(
        '<span class="line">'
        + " ".join(f"<span>{html.escape(word)}</span>" for word in line.split(" "))
        + "\n</span>"
        for line in lines.split("\n")
    )


def _code(_renderer: Any, tokens: list[Any], place: int, _options: Any, _env: Any) -> str:
    content = tokens[place].content
    whole = ' class="whole"' if len(content) <= _SHORT else ""
    return f"<code{whole}>{html.escape(content, quote=False)}</code>"


def _fence(figure: Figure) -> Callable[..., str]:
    def rule(_renderer: Any, tokens: list[Any], place: int, _options: Any, _env: Any) -> str:
        kind, _, name = tokens[place].info.strip().partition(" ")
        content = tokens[place].content
        if kind == "math":
            return f'<p class="math">{formula_svg(" ".join(content.split()))}</p>\n'
        if kind == "figure":
            return figure(content)
        label = f'<span class="file">{html.escape(name)}</span>' if name else ""
        lines = content.rstrip("\n")
        shown = _commands(lines) if kind == "sh" else html.escape(lines)
        return f'<pre class="{html.escape(kind)}">{label}<code>{shown}</code></pre>\n'

    return rule
