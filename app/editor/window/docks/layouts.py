"""Named layouts: where the docks stand, and what share of the window each has.

The picture comes first: by default its viewer has at least two fifths of the window, at any size,
with the chain as a band above it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow, QStyle

from app.editor.viewers.picture.image_viewer import ImageViewer

LayoutName = Literal["picture_below", "picture_beside", "canvas_first"]
DEFAULT: LayoutName = "picture_below"
PICTURE_SHARE = 0.42  # of the window's area, for the picture with its axes; 0.4 is promised
_Area, _Across, _Along = Qt.DockWidgetArea, Qt.Orientation.Horizontal, Qt.Orientation.Vertical


@dataclass(frozen=True)
class Docks:
    """The docks of the window, by what they hold.

    Parameters
    ----------
    library, history, panels, curves, tradeoff, snapshots, runs, measuring, fitting : QDockWidget
        One of each.
    viewers : sequence of QDockWidget
        Those of pictures, by number.
    picture : ImageViewer
        The first picture's viewer; not in its dock while it is over the whole screen.
    """

    library: QDockWidget
    history: QDockWidget
    panels: QDockWidget
    curves: QDockWidget
    tradeoff: QDockWidget
    snapshots: QDockWidget
    runs: QDockWidget
    measuring: QDockWidget
    fitting: QDockWidget
    viewers: Sequence[QDockWidget]
    picture: ImageViewer

    @property
    def all(self) -> tuple[QDockWidget, ...]:
        """Every dock."""
        beside = (self.measuring, self.fitting, *self.beside)
        return (self.library, self.panels, *self.viewers, *beside)

    @property
    def beside(self) -> tuple[QDockWidget, ...]:
        """Those of curves, figures, runs and history, one behind another."""
        return (self.curves, self.tradeoff, self.snapshots, self.runs, self.history)


def place(window: QMainWindow, docks: Docks, layout: LayoutName) -> None:
    """Put every dock where the layout has it, and open the library, panels, picture and curves.

    Which of the other docks are open stays.
    """
    others = (*docks.viewers[1:], docks.measuring, docks.fitting, *docks.beside[1:])
    was_open = [dock for dock in others if not dock.isHidden()]
    for dock in docks.all:
        dock.setFloating(False)
        window.removeDockWidget(dock)
    first = docks.viewers[0]
    if layout == "picture_beside":
        _corners(window, left=_Area.LeftDockWidgetArea, right=_Area.BottomDockWidgetArea)
        window.addDockWidget(_Area.LeftDockWidgetArea, first)
        window.addDockWidget(_Area.RightDockWidgetArea, docks.library)
        window.addDockWidget(_Area.BottomDockWidgetArea, docks.curves)
        window.splitDockWidget(docks.curves, docks.panels, _Across)
    else:
        _corners(window, left=_Area.BottomDockWidgetArea, right=_Area.RightDockWidgetArea)
        window.addDockWidget(_Area.LeftDockWidgetArea, docks.library)
        window.addDockWidget(_Area.RightDockWidgetArea, docks.panels)
        window.addDockWidget(_Area.BottomDockWidgetArea, first)
        way = (first, docks.curves, _Across)
        if layout == "picture_below":
            way = (docks.panels, docks.curves, _Along)
        window.splitDockWidget(*way)
    for before, dock in zip(docks.beside, docks.beside[1:], strict=False):
        window.tabifyDockWidget(before, dock)
    pictures = (*docks.viewers, docks.measuring, docks.fitting)
    for before, dock in pairwise(pictures):
        window.tabifyDockWidget(before, dock)
    for dock in (docks.library, docks.panels, first, docks.curves, *was_open):
        dock.show()
    first.raise_()
    docks.curves.raise_()


def size(window: QMainWindow, docks: Docks, layout: LayoutName) -> None:
    """Give each dock the layout's share of the window as large as it is now."""
    unit, line = window.fontMetrics().averageCharWidth(), window.fontMetrics().height()
    width, height = window.width(), window.height()
    viewer = docks.viewers[0]
    picture = PICTURE_SHARE * width * height
    bars = _height_of_bars(viewer, docks.picture)
    room = height - window.menuBar().height() - window.statusBar().height()
    if layout == "picture_beside":
        tall = max(1, room - bars)
        window.resizeDocks([viewer, docks.library], [round(picture / tall), 22 * unit], _Across)
        below = round(0.52 * room)
        window.resizeDocks([docks.curves, docks.panels], [below, below], _Along)
        left = width - round(picture / tall)
        window.resizeDocks([docks.curves, docks.panels], [round(0.5 * left)] * 2, _Across)
        return
    needed = [
        dock.minimumSizeHint().width() for dock in (docks.panels, *docks.beside) if dock.isVisible()
    ]
    side = max(round(min(max(45 * unit, 0.235 * width), 90 * unit)), *needed, 0)
    if layout == "canvas_first":
        window.resizeDocks([docks.library, docks.panels], [26 * unit, 52 * unit], _Across)
        window.resizeDocks([viewer, docks.curves], [24 * line] * 2, _Along)
        window.resizeDocks([viewer, docks.curves], [62 * unit, 75 * unit], _Across)
        return
    tall = round(picture / (width - side)) + bars
    window.resizeDocks([docks.library, docks.panels], [26 * unit, side], _Across)
    window.resizeDocks([viewer], [max(tall, round(0.62 * room))], _Along)
    shares = [round(0.55 * room), round(0.45 * room)]
    window.resizeDocks([docks.panels, docks.curves], shares, _Along)


def _corners(window: QMainWindow, *, left: Qt.DockWidgetArea, right: Qt.DockWidgetArea) -> None:
    window.setCorner(Qt.Corner.BottomLeftCorner, left)
    window.setCorner(Qt.Corner.TopLeftCorner, _Area.LeftDockWidgetArea)
    window.setCorner(Qt.Corner.BottomRightCorner, right)
    window.setCorner(Qt.Corner.TopRightCorner, _Area.RightDockWidgetArea)


def _height_of_bars(dock: QDockWidget, viewer: ImageViewer) -> int:
    """What a viewer's dock has above and below its picture: title, controls, status, tabs."""
    bars = viewer.bar.sizeHint().height() + viewer.status.sizeHint().height()
    title: int = dock.style().pixelMetric(QStyle.PixelMetric.PM_TitleBarHeight, None, dock)
    tabs = 2 * dock.fontMetrics().height()
    return bars + title + tabs
