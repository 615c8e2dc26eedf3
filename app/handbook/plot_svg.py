"""Plots as drawings within a page, in the page's own colours, light or dark."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from app.report.drawing.as_written import as_written
from app.report.drawing.plain_matplotlib import load_matplotlib

_INK, _GRID = "#010203", "#040506"
_STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": _INK,
    "axes.labelcolor": _INK,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "grid.color": _GRID,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "path",
}
# Colours that are bright enough on dark paper and dark enough on light.
COLOURS = ("#2f81c8", "#e0701a", "#35a05a", "#d0438c", "#8a6fd1", "#a08040")
_DARK = re.compile(r"#(?:000000|555555|666666|010203|888888)\b")


@contextmanager
def plot(name: str, width: float, height: float) -> Iterator[tuple[Any, io.StringIO]]:
    """A figure of that size in inches; what is written is a piece of a page.

    Parameters
    ----------
    name : str
        Of the plot; on one page no two plots have the same.
    width, height : float
        Inches.
    """
    mpl = load_matplotlib()
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    out = io.StringIO()
    # The salt makes names within the drawing, the same for the same plot.
    with mpl.rc_context({**_STYLE, "svg.hashsalt": name}):
        drawn = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasSVG(drawn)
        yield drawn, out
        as_written(drawn)
        written = io.StringIO()
        drawn.savefig(
            written,
            format="svg",
            metadata={"Date": None, "Creator": None, "Format": None, "Type": None},
        )
    out.write(_within_a_page(written.getvalue(), name))


def _within_a_page(svg: str, name: str) -> str:
    """Without the head of a file, in the colours of the text, names of its own."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    # It would be one of the whole page; the page's own has it for its plots.
    body = re.sub(r'<style type="text/css">.*?</style>', "", body, flags=re.DOTALL)
    opening, rest = body.split(">", 1)
    view = re.search(r'viewBox="([^"]+)"', opening)
    assert view is not None
    rest = _DARK.sub("currentColor", rest).replace(_GRID, "var(--grid)")
    # Groups are numbered alike in every drawing; names on a page must differ.
    rest = re.sub(r' id="(?!m|D|p|image|[a-z]+[0-9a-f]{8})[\w-]+"', "", rest)
    mark = re.sub(r"\W", "", name)
    rest = re.sub(r'(\bid="|"#|\(#)', rf"\g<1>{mark}-", rest)
    return (
        f'<svg class="plot" role="img" viewBox="{view[1]}" xmlns:xlink="http://www.w3.org/1999/xlink">'
        + re.sub(r"\s*\n\s*", "\n", rest)
    )
