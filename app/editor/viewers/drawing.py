"""What a plot shows, as plain data: lines in panels that share their abscissa."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.editor.viewers.curves_want import Mark, TransferCurves
from core.data import CurveData

Vector = NDArray[np.float64]
Parts = Literal["mtf", "ptf", "both"]
_AXES = {0.0: "ξ", 90.0: "η"}


@dataclass(frozen=True)
class Entry:
    """A line of the legend.

    Parameters
    ----------
    name : str
        Unique in the drawing.
    title : str
        For people.
    total : bool
        Whether it is a product of the others.
    shown : bool
        Whether it is shown unless the person says otherwise.
    """

    name: str
    title: str
    total: bool = False
    shown: bool = True


@dataclass(frozen=True, eq=False)
class Line:
    """The points of an entry in one panel."""

    name: str
    x: Vector
    y: Vector


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes; `least` is the range that the ordinate shows at least."""

    y_label: str
    lines: tuple[Line, ...]
    least: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Drawing:
    """All that is plotted."""

    x_label: str
    entries: tuple[Entry, ...] = ()
    panels: tuple[Panel, ...] = ()
    marks: tuple[Mark, ...] = ()

    @property
    def x_range(self) -> tuple[float, float] | None:
        """Least and greatest abscissa; None without points."""
        lines = [line for panel in self.panels for line in panel.lines if len(line.x)]
        if not lines:
            return None
        low = min(float(line.x.min()) for line in lines)
        return low, max(float(line.x.max()) for line in lines)


def transfer_drawing(curves: TransferCurves, parts: Parts) -> Drawing:
    """MTF, PTF or both of a chain; a PTF that is 0 everywhere is not drawn."""
    entries = tuple(
        Entry(
            curve.name,
            f"{curve.title} (beside)" if curve.kind == "beside" else curve.title,
            curve.kind == "total",
            curve.kind == "total" or (curve.acts and curve.kind == "stage"),
        )
        for curve in curves.curves
    )
    panels = []
    if parts in ("mtf", "both"):
        lines = (Line(each.name, curves.frequency, each.mtf) for each in curves.curves)
        panels.append(Panel("MTF", tuple(lines), (0.0, 1.0)))
    if parts in ("ptf", "both"):
        shifting = [each for each in curves.curves if each.ptf.any()]
        lines = (Line(each.name, curves.frequency, each.ptf) for each in shifting)
        panels.append(Panel("PTF (rad)", tuple(lines), None if shifting else (-1.0, 1.0)))
    along = _AXES.get(curves.angle_deg % 180.0)
    label = along or f"frequency along {curves.angle_deg:g}°"
    return Drawing(f"{label} (cyc/mrad)", entries, tuple(panels), curves.marks)


def curve_drawing(data: CurveData) -> Drawing:
    """Curves of a port."""
    names = [str(number) for number in range(len(data.series))]
    entries = tuple(
        Entry(name, series.label or f"curve {name}", series.label.startswith("Total"))
        for name, series in zip(names, data.series, strict=True)
    )
    lines = tuple(
        Line(name, series.x, series.y) for name, series in zip(names, data.series, strict=True)
    )
    least = (0.0, 1.0) if data.y_label == "MTF" else None
    return Drawing(data.x_label, entries, (Panel(data.y_label, lines, least),))


def y_range(panel: Panel, shown: Iterable[str]) -> tuple[float, float]:
    """What the ordinate has to show for these entries, with a little room around."""
    names = set(shown)
    values = [line.y for line in panel.lines if line.name in names and len(line.y)]
    low, high = panel.least or (np.inf, -np.inf)
    low = min([low, *(float(each.min()) for each in values)])
    high = max([high, *(float(each.max()) for each in values)])
    if not (np.isfinite(low) and np.isfinite(high)):
        return -1.0, 1.0
    room = 0.04 * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


def value_at(line: Line, x: float) -> float | None:
    """Ordinate at an abscissa, linear between points; None outside."""
    if not len(line.x) or not line.x[0] <= x <= line.x[-1]:
        return None
    return float(np.interp(x, line.x, line.y))
