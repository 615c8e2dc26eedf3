"""Formulas as drawings that stand in a page's text: alike on every machine, with or without fonts.

A browser's own mathematics (MathML) takes whatever fonts a machine has, which on many is none that
is made for it. Matplotlib typesets the same TeX with fonts of its own, and its outlines are a small
drawing in the colour of the text round it.
"""

from __future__ import annotations

import html
import re
from functools import cache
from typing import Any

from app.report.drawing.plain_matplotlib import load_matplotlib
from core.errors import ImagechainError

EM = 16.0
"""Units of the drawing in one em of the text."""
_SIZE = 18.0  # of the letters: a serif face looks smaller than the page's
# A sum or an integral with its limits, behind which a thin space belongs.
_LARGE = re.compile(
    r"\\(?:sum|prod|i?int)(?:_(?:\{[^{}]*\}|\\?\w))?(?:\^(?:\{[^{}]*\}|\\?\w))?(?![a-z_^])"
)
_COMMANDS = {1: ("M", 1), 2: ("L", 1), 3: ("Q", 2), 4: ("C", 3), 79: ("Z", 1)}


class FormulaError(ImagechainError):
    """A formula that cannot be typeset."""

    exit_code = 1


@cache
def formula_svg(tex: str) -> str:
    """The drawing of a formula, as a piece of a page.

    Parameters
    ----------
    tex : str
        Without dollar signs.

    Raises
    ------
    FormulaError
        If it is no TeX that can be typeset; names the formula.
    """
    mpl = load_matplotlib()
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    try:
        with mpl.rc_context({"mathtext.fontset": "stix"}):
            drawing = TextToPath()
            face = FontProperties(family="STIXGeneral", size=_SIZE)
            text = f"${_LARGE.sub(_spaced, tex)}$".replace(r"\frac", r"\dfrac")
            width, height, descent = drawing.get_text_width_height_descent(text, face, ismath=True)
            points, codes = drawing.get_text_path(face, text, ismath=True)
    except ValueError as error:
        raise FormulaError(f"the formula {tex!r} cannot be typeset: {error}") from error
    outline = _outline(points, codes, _SIZE / drawing.FONT_SCALE, height - descent)
    return (
        f'<svg class="formula" role="math" aria-label="{html.escape(tex)}" '
        f'width="{width / EM:.3f}em" height="{height / EM:.3f}em" '
        f'viewBox="0 0 {width:.1f} {height:.1f}" style="vertical-align:{-descent / EM:.3f}em">'
        f'<path d="{outline}"/></svg>'
    )


def _spaced(match: re.Match[str]) -> str:
    return match[0] + r"\,"


def _outline(points: Any, codes: Any, scale: float, base: float) -> str:
    words = []
    place = 0
    while place < len(codes):
        letter, count = _COMMANDS[int(codes[place])]
        words.append(letter)
        if letter != "Z":
            words.append(
                " ".join(
                    f"{x * scale:.2f} {base - y * scale:.2f}"
                    for x, y in points[place : place + count]
                )
            )
        place += count
    return "".join(words)
