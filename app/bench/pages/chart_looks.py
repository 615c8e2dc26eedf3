"""The looks that all pictures of a benchmark share."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from app.report.drawing.picture_drawing import figure
from app.report.drawing.plain_matplotlib import load_matplotlib

WIDTH, HEIGHT = 8.2, 4.9  # inches
TITLE_WIDTH = 84  # letters of a line of the title
# Distinct in every kind of colour vision (Okabe and Ito 2008), their light ones darkened for
# letters on white.
COLOURS = ("#0072B2", "#D55E00", "#00805C", "#A8508A", "#8A6D00", "#2B2B2B", "#3C9BD6")
FAINT, DARK = "#8a8a8a", "#333333"
_STYLE: Any = {
    "font.size": 10.5,
    "axes.labelsize": 11.0,
    "axes.titlesize": 12.0,
    "axes.titlepad": 12.0,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "axes.axisbelow": True,
}


@contextmanager
def drawing(height: float, title: str) -> Iterator[tuple[Any, Any]]:
    """A figure of the benchmark's looks, under its title."""
    with figure(WIDTH, height) as (drawn, out), load_matplotlib().rc_context(_STYLE):
        drawn.get_layout_engine().set(w_pad=0.1, h_pad=0.08)
        if title:
            drawn.suptitle(
                textwrap.fill(title, TITLE_WIDTH),
                x=0.012,
                ha="left",
                fontsize=12.0,
                fontweight="bold",
            )
        yield drawn, out
