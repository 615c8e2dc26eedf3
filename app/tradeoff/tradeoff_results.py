"""What a trade-off has found: figures by value, for one curve or a family of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from app.run.readout_tables import number_text
from app.tradeoff.sweep import Point
from app.tradeoff.tradeoff_figures import Figure
from app.tradeoff.values import Variation

ROUNDING = 1e-5


@dataclass(frozen=True)
class Curve:
    """The points at one value of the second parameter, which is None where there is no second."""

    second: Any
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Results:
    """A trade-off, carried out.

    Parameters
    ----------
    network : str
        Name of the network.
    varied : Variation
        What moves along the axis.
    second : Variation or None
        What differs from curve to curve.
    figures : tuple of Figure
        The figures shown.
    curves : tuple of Curve
        One, or one for each value of the second parameter.
    present : object
        The value in the network as it stands.
    """

    network: str
    varied: Variation
    second: Variation | None
    figures: tuple[Figure, ...]
    curves: tuple[Curve, ...]
    present: Any = None

    def failures(self) -> list[tuple[str, str]]:
        """Where the network or a figure fails, and why; in words."""
        gaps = []
        for curve, point in self.rows():
            reasons = dict.fromkeys(
                point.reasons[figure.text]
                for figure in self.figures
                if figure.text in point.reasons
            )
            gaps += [(self._place(curve, point), reason) for reason in reasons]
        return gaps

    def warnings(self) -> list[tuple[str, str]]:
        """Where the nodes warn, and of what; in words."""
        return [
            (self._place(c, point), line) for c, point in self.rows() for line in point.warnings
        ]

    def _place(self, curve: Curve, point: Point) -> str:
        place = f"{self.varied.text} = {shown_value(point.value, self.varied.unit)}"
        if self.second is not None:
            place += f", {self.second.text} = {shown_value(curve.second, self.second.unit)}"
        return place

    def rows(self) -> Iterator[tuple[Curve, Point]]:
        """Every point with its curve."""
        return ((curve, point) for curve in self.curves for point in curve.points)


def changing_figures(figures: Sequence[Figure], curves: Sequence[Curve]) -> tuple[Figure, ...]:
    """Of the default figures, those that change; where none does, those that have a value."""
    rows = {
        figure: [point.figures.get(figure.text) for curve in curves for point in curve.points]
        for figure in figures
    }
    shown: list[Figure] = []
    for figure, row in rows.items():
        known = (f for f in shown if f.is_total and figure.is_total and f.name == figure.name)
        if any(value is not None for value in row) and row not in [rows[f] for f in known]:
            shown.append(figure)  # not the MTF with electronics that do not filter
    changing = [figure for figure in shown if _changes([v for v in rows[figure] if v is not None])]
    return tuple(changing or shown)


def _changes(values: Sequence[float]) -> bool:
    """Whether by more than single precision leaves of rounding."""
    return max(values) - min(values) > ROUNDING * max(map(abs, values))


def shown_value(value: Any, unit: str = "") -> str:
    """A parameter's value in words."""
    if value is None:
        return "empty"
    text = ("true" if value else "false") if isinstance(value, bool) else number_text(value)
    return f"{text} {unit}".strip() if not isinstance(value, str) else text
