"""Markdown as pieces of pages: titles with anchors, tables, code, formulas and drawings.

Beside plain Markdown there are

- *Module Title* in slanted letters, which becomes a link to the module's page;
- a block of `math`, TeX to be typeset;
- a block of `figure`, words that name a drawing (see `page_figures`);
- a file's name behind the language of a block of code, which is shown above it;
- a block of `output`, what the code above it prints.
"""

import html
import re
from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from typing import Any

from app.report.drawing.picture_drawing import load_matplotlib

Figure = Callable[[str], str]
_SOURCE = re.compile(r"^(\w+)\.md\b")
_REMARK = re.compile(r"^<!--.*-->\n", re.MULTILINE)  # such as marks to write between


def rendered(text: str, modules: Mapping[str, str], figure: Figure) -> tuple[str, str, str, str]:
    """Title, lead, body and words of a page."""
    # Imported only where pages are made.
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = parser.parse(_REMARK.sub("", text))
    title = _name_headings(tokens)
    _link(tokens, modules)
    _wrap_tables(tokens)
    parser.add_render_rule("fence", _fence(figure))
    body = parser.renderer.render(tokens, parser.options, {})
    with_words = ("inline", "fence", "code_block")
    words = " ".join(token.content for token in tokens if token.type in with_words)
    _, lead, *_ = [*(token.content for token in tokens if token.type == "inline"), "", ""]
    return title, lead, body, words


def anchor_of(text: str) -> str:
    return re.sub(r"[^\w]+", "-", text.casefold()).strip("-")


def _name_headings(tokens: list[Any]) -> str:
    """Give headings their anchors; returns the title."""
    title = ""
    for token, inline in pairwise(tokens):
        if token.type != "heading_open":
            continue
        text = re.sub(r"[*`]", "", inline.content)
        if token.tag == "h1":
            title = text
        else:
            token.attrSet("id", anchor_of(text))
    return title


def _link(tokens: list[Any], modules: Mapping[str, str]) -> None:
    """Make links of slanted words that are a module's title, and to pages of links to sources."""
    for token in tokens:
        children = token.children or []
        for first, inner, last in zip(children, children[1:], children[2:], strict=False):
            if first.type == "em_open" and last.type == "em_close" and inner.content in modules:
                first.type, first.tag = "link_open", "a"
                first.attrSet("href", modules[inner.content])
                last.type, last.tag = "link_close", "a"
        for child in children:
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


def _fence(figure: Figure) -> Callable[..., str]:
    def rule(_renderer: Any, tokens: list[Any], place: int, _options: Any, _env: Any) -> str:
        kind, _, name = tokens[place].info.strip().partition(" ")
        content = tokens[place].content
        if kind == "math":
            return f'<p class="math">{formula_svg(" ".join(content.split()))}</p>\n'
        if kind == "figure":
            return figure(content)
        label = f'<span class="file">{html.escape(name)}</span>' if name else ""
        shown = html.escape(content.rstrip("\n"))
        return f'<pre class="{html.escape(kind)}">{label}<code>{shown}</code></pre>\n'

    return rule


# Formulas as drawings that stand in a page's text: alike on every machine, with or without fonts.
#
# A browser's own mathematics (MathML) takes whatever fonts a machine has, which on many is none
# that is made for it. Matplotlib typesets the same TeX with fonts of its own, and its outlines are
# a small drawing in the colour of the text round it.

EM = 16.0
"""Units of the drawing in one em of the text."""
_SIZE = 18.0  # of the letters: a serif face looks smaller than the page's
# A sum or an integral with its limits, behind which a thin space belongs.
_LARGE = re.compile(
    r"\\(?:sum|prod|i?int)(?:_(?:\{[^{}]*\}|\\?\w))?(?:\^(?:\{[^{}]*\}|\\?\w))?(?![a-z_^])"
)
_COMMANDS = {1: ("M", 1), 2: ("L", 1), 3: ("Q", 2), 4: ("C", 3), 79: ("Z", 1)}


@cache
def formula_svg(tex: str) -> str:
    """A formula's drawing; a `ValueError` where matplotlib cannot typeset it."""
    mpl = load_matplotlib()
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    with mpl.rc_context({"mathtext.fontset": "stix"}):
        drawing = TextToPath()
        face = FontProperties(family="STIXGeneral", size=_SIZE)
        spaced = _LARGE.sub(r"\g<0>\\,", tex)
        text = f"${spaced}$".replace(r"\frac", r"\dfrac")
        width, height, descent = drawing.get_text_width_height_descent(text, face, ismath=True)
        points, codes = drawing.get_text_path(face, text, ismath=True)
    outline = _outline(points, codes, _SIZE / drawing.FONT_SCALE, height - descent)
    return (
        f'<svg class="formula" role="math" aria-label="{html.escape(tex)}" '
        f'width="{width / EM:.3f}em" height="{height / EM:.3f}em" '
        f'viewBox="0 0 {width:.1f} {height:.1f}" style="vertical-align:{-descent / EM:.3f}em">'
        f'<path d="{outline}"/></svg>'
    )


def _outline(points: Any, codes: Any, scale: float, base: float) -> str:
    words = []
    place = 0
    while place < len(codes):
        letter, count = _COMMANDS[int(codes[place])]
        words.append(letter)
        if letter != "Z":
            ends = points[place : place + count]
            words.append(" ".join(f"{x * scale:.2f} {base - y * scale:.2f}" for x, y in ends))
        place += count
    return "".join(words)
