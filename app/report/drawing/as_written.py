"""Texts of a figure as they are written: a dollar sign is a dollar sign, and begins no formula."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from core.names import printable


def as_written(drawn: Any) -> None:
    """Have the figure's texts drawn letter by letter, not as formulas: they are the network's.

    What numbers on axes are written with, powers of ten, stays.
    """
    from matplotlib.axis import Axis
    from matplotlib.text import Text
    from matplotlib.ticker import FixedFormatter, FuncFormatter

    of_axes: set[int] = set()
    for axis in drawn.findobj(Axis):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, FixedFormatter):
            formatter.seq = [_escaped(label) for label in formatter.seq]
        elif isinstance(formatter, FuncFormatter):
            formatter.func = _escaping(formatter.func)
        ticks = (*axis.get_major_ticks(), *axis.get_minor_ticks())
        of_axes.update(id(text) for tick in ticks for text in (tick.label1, tick.label2))
        of_axes.add(id(axis.get_offset_text()))
    for text in drawn.findobj(Text):
        if id(text) not in of_axes:
            text.set_parse_math(False)
            text.set_text(printable(text.get_text()))


def _escaping(named: Callable[..., str]) -> Callable[..., str]:
    return lambda *place: _escaped(named(*place))


def _escaped(text: str) -> str:
    return printable(text).replace("$", r"\$")
