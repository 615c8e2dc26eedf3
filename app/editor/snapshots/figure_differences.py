"""Figures of two states side by side: what differs, by how much, and which way."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from app.editor.number_text import shown_figure
from app.editor.snapshots.all_figures import NodeFigure
from app.editor.viewers.figures.figure_text import NONE, figure_text, prefixed
from app.run.readout_tables import number_text, without_rounding

Way = Literal["same", "up", "down", "other", "only A", "only B", "unit"]
_ARROWS = {"up": "▲", "down": "▼"}
_LEAST_PERCENT = 0.001  # written as a number


@dataclass(frozen=True)
class FigureDifference:
    """One figure of A, kept, and of B, now.

    Parameters
    ----------
    node, name : str
        The node's id, and the read-out's name in files.
    caption, meaning : str
        For people.
    a, b : NodeFigure or None
        The figure of each; None where that state has no such node.
    shown_a, shown_b, unit : str
        Both values with the same prefix of the unit, and that unit.
    way : str
        "same" where no difference shows in six digits, as figures are written elsewhere; "up" or
        "down" where B is more or less than A, "other" where they differ without more or
        less, "unit" where they are in different units, or which of the two has a value.
    text : str
        The difference for people: an arrow or sign, and what share of A it is.
    about : str
        The difference with its unit.
    """

    node: str
    name: str
    caption: str
    meaning: str
    a: NodeFigure | None
    b: NodeFigure | None
    shown_a: str
    shown_b: str
    unit: str
    way: Way
    text: str
    about: str

    @property
    def differs(self) -> bool:
        """Whether the two states have something else there."""
        return self.way != "same"


def figure_differences(
    kept: Iterable[NodeFigure], now: Iterable[NodeFigure]
) -> tuple[FigureDifference, ...]:
    """The figures of both in the order of the present ones; then those that only A has.

    Figures belong together by their node's id and their name. One without a value on either side
    is left out.
    """
    before = {(figure.node, figure.name): figure for figure in kept}
    after = {(figure.node, figure.name): figure for figure in now}
    rows = []
    for key in dict.fromkeys((*after, *before)):
        a, b = before.get(key), after.get(key)
        figure = b or a
        assert figure is not None
        if _value(a) is None and _value(b) is None:
            continue
        texts = _shown(a, b)
        difference = _difference(a, b)
        rows.append(
            FigureDifference(
                figure.node,
                figure.name,
                figure.caption,
                figure.meaning,
                a,
                b,
                *texts,
                *difference,
            )
        )
    return tuple(rows)


def _value(figure: NodeFigure | None) -> Any:
    return None if figure is None else figure.value


def _shown(a: NodeFigure | None, b: NodeFigure | None) -> tuple[str, str, str]:
    """Both values in four digits with one prefix, that of the larger, and the unit with it."""
    figures = [figure for figure in (a, b) if figure is not None]
    numbers = [float(figure.value) for figure in figures if _is_number(figure.value)]
    sizes = [abs(number) for number in numbers if math.isfinite(number)]
    factor, unit = 1.0, figures[0].unit
    if any(figure.unit != unit for figure in figures):
        unit = ""  # each is in its own, which the tooltip has
    elif sizes:
        factor, unit = prefixed(max(sizes), unit)
    return _plain(a, factor), _plain(b, factor), unit


def _plain(figure: NodeFigure | None, factor: float) -> str:
    value = _value(figure)
    if value is None:
        return NONE
    if not _is_number(value):
        return shown_figure(value)
    if isinstance(value, int) and factor == 1.0:
        return str(value).replace("-", "\N{MINUS SIGN}")
    return f"{float(value) / factor:.4g}".replace("-", "\N{MINUS SIGN}")


def _difference(a: NodeFigure | None, b: NodeFigure | None) -> tuple[Way, str, str]:
    if a is None or a.value is None:
        return "only B", "only B", "A has no such figure"
    if b is None or b.value is None:
        return "only A", "only A", "B has no such figure"
    if a.unit != b.unit:
        return "unit", "≠ unit", f"A in {a.unit or 'no unit'}, B in {b.unit or 'no unit'}"
    if not (_is_number(a.value) and _is_number(b.value)):
        same = type(a.value) is type(b.value) and bool(a.value == b.value)
        return ("same", "=", "the same") if same else ("other", "≠", "not the same")
    one, other = (float(without_rounding(float(f.value), f.unit)) for f in (a, b))
    return _number_difference(one, other, a.unit)


def _is_number(value: Any) -> bool:
    if value is None or isinstance(value, bool | str):
        return False
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return True


def _number_difference(a: float, b: float, unit: str) -> tuple[Way, str, str]:
    if a == b or (math.isnan(a) and math.isnan(b)):
        return "same", "=", "the same"
    if number_text(a) == number_text(b):  # what solving for a root, or another order, leaves
        return "same", "=", "the same in six digits"
    if math.isnan(a) or math.isnan(b):
        return "other", "≠", "one of them is no number"
    way: Way = "up" if b > a else "down"
    difference = b - a
    sign = "+" if difference > 0 else ""
    about = f"B \N{MINUS SIGN} A = {sign}{figure_text(difference, unit)}"
    if not (math.isfinite(difference) and a):
        return way, f"{_ARROWS[way]} {sign}{figure_text(difference, unit)}", about
    return way, f"{_ARROWS[way]} {_share_text(100.0 * difference / abs(a))}", about


def _share_text(percent: float) -> str:
    """A share in as many digits as one looks at."""
    size = abs(percent)
    if size < _LEAST_PERCENT:
        return f"< {_LEAST_PERCENT:g} %"
    digits = 3 if size >= 1.0 else 2
    return f"{percent:+.{digits}g} %".replace("-", "\N{MINUS SIGN}")
