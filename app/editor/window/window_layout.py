"""The layout that is in use: it grows with the window, and keeps what the user has dragged."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import partial
from itertools import pairwise
from typing import Any, Literal, get_args

from PySide6.QtCore import QByteArray, QEvent, QObject, Qt, QTimer
from PySide6.QtWidgets import (
    QApplication,
    QDockWidget,
    QInputDialog,
    QMainWindow,
    QStackedWidget,
    QStyle,
    QTabBar,
)

from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.widgets import Menu, offer
from app.editor.window.recent_files import DOCKS_VERSION, Settings

Sizes = dict[str, tuple[int, int]]


class WindowLayout(QObject):
    """Places the docks by a named layout, and sizes them when the window is resized.

    Once the user has dragged a line between docks, all keep their `shares` of the window's width
    and height instead.
    """

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self.name: LayoutName = DEFAULT
        self.shares: dict[str, tuple[float, float]] = {}  # by the docks' object names
        self._window = window
        self._pressed: Sizes | None = None
        self._away: list[QDockWidget] = []  # what an empty network has no use for
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self._keep)
        self._tidy = QTimer(self, singleShot=True, interval=0)
        self._tidy.timeout.connect(self._put_away_tab_bars)
        window.installEventFilter(self)

    def choose(self, name: LayoutName) -> None:
        self._away = []
        self.name, self.shares = name, {}
        place(self._window, name)
        self._size()
        self._soon.stop()  # it was not the user who moved them

    def state(self) -> str:
        return json.dumps({"name": self.name, "shares": self.shares})

    def restore(self, docks: QByteArray, state: str) -> None:
        """Use what `saveState` and `state` gave; nothing of what is damaged."""
        self._away = []
        self._window.restoreState(docks, DOCKS_VERSION)
        with suppress(ValueError, TypeError, LookupError, AttributeError):
            stored = json.loads(state)
            shares = {dock: (float(w), float(h)) for dock, (w, h) in stored["shares"].items()}
            if stored["name"] in get_args(LayoutName):
                self.name, self.shares = stored["name"], shares
        self._size()
        self._soon.stop()
        self._tidy.start()

    @property
    def lacks_docks(self) -> bool:
        return bool(self._away)

    def make_room(self, *, empty: bool) -> None:
        """Give an empty network a large canvas; the docks of pictures come with its first node."""
        if not (empty or self._away):  # as after most edits
            return
        docks, shown = Docks(self._window), []
        if empty:
            beside = [*docks.viewers, *docks.tools, *docks.beside]
            if self._window.dockWidgetArea(docks.panels) == _Area.BottomDockWidgetArea:
                beside.append(docks.panels)  # which would keep the whole band below the canvas
                _seat_library(self._window, docks, _Area.RightDockWidgetArea, wide=True)
            shown = [dock for dock in beside if not (dock.isHidden() or dock.isFloating())]
        away, self._away = self._away, self._away + shown if empty else []
        for dock in shown if empty else away:
            dock.setVisible(not empty)
        if shown:
            docks.library.raise_()  # where it stands behind the panels
        if away and not empty:
            for dock in (docks.curves, docks.panels, docks.viewers[0]):
                dock.raise_()
            self._size()
            QTimer.singleShot(0, self, self._size)  # once Qt has laid them out
            self._soon.stop()

    def show_panels(self) -> None:
        """Bring the panels before the library, where it stands in front of them."""
        docks = Docks(self._window)
        if docks.library in self._window.tabifiedDockWidgets(docks.panels):
            docks.panels.raise_()

    def follow(self, dock: Any) -> None:
        """See the dock put somewhere else: the shares are those once all are laid out."""
        dock.topLevelChanged.connect(lambda _: self._soon.start())
        dock.dockLocationChanged.connect(lambda _: self._soon.start())

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """See the window resized, and the end of a drag at the line between two docks."""
        if event.type() in (QEvent.Type.Resize, QEvent.Type.Show):
            self._size()
            self._tidy.start()
        elif event.type() is QEvent.Type.MouseButtonPress:
            self._pressed = self._sizes()
        elif event.type() is QEvent.Type.MouseButtonRelease:
            pressed, self._pressed = self._pressed, None
            if pressed is not None and pressed != self._sizes():
                self._keep()
        return False

    def _put_away_tab_bars(self) -> None:
        """Qt forgets bars of a single tab in the window's corner when docks come back."""
        direct = Qt.FindChildOption.FindDirectChildrenOnly
        for bar in self._window.findChildren(QTabBar, options=direct):
            if bar.count() <= 1:
                bar.move(-bar.width(), -bar.height())

    def _keep(self) -> None:
        width, height = self._window.width(), self._window.height()
        if sizes := self._sizes():  # none is shown beside the first page
            self.shares = {name: (w / width, h / height) for name, (w, h) in sizes.items()}

    def _sizes(self) -> Sizes:
        window = self._window
        return {
            dock.objectName(): (dock.width(), dock.height())
            for dock in Docks(window).all
            if dock.isVisible()
            and not dock.isFloating()
            and window.rect().intersects(dock.geometry())  # Qt has those behind another outside
        }

    def _size(self) -> None:
        window, shares = self._window, self.shares
        if not shares:
            size(window, self.name)
            self._soon.stop()  # it was not the user who moved the library
            return
        docks = [
            dock
            for dock in Docks(window).all
            if dock.objectName() in shares and not dock.isFloating()
        ]
        for side, whole, way in ((0, window.width(), _Across), (1, window.height(), _Along)):
            dots = [max(1, round(shares[dock.objectName()][side] * whole)) for dock in docks]
            window.resizeDocks(docks, dots, way)


# Named layouts: where the docks stand, and what share of the window each has.
#
# The picture comes first: by default its viewer has at least two fifths of the window, at any
# size, with the chain as a band above it.

LayoutName = Literal["picture_below", "picture_beside", "canvas_first"]
DEFAULT: LayoutName = "picture_below"
_HEADINGS = 40  # letters, in which the library's headings are read without an ellipsis
_LEAST_PANELS = 40  # letters that a control panel is wide at least
_LEAST_THREE = 176  # letters of a window in which picture, curves and panels stand side by side
_LEAST_BESIDE = 240  # letters of a window in which the library has a place of its own
PICTURE_SHARE = 0.42  # of the window's area, for the picture with its axes; 0.4 is promised
_Area, _Across, _Along = Qt.DockWidgetArea, Qt.Orientation.Horizontal, Qt.Orientation.Vertical


class Docks:
    def __init__(self, window: QMainWindow) -> None:
        docks = window.findChildren(QDockWidget)
        named = {dock.objectName().removeprefix("dock."): dock for dock in docks}
        self.library, self.panels, self.curves = (named[n] for n in ("library", "panels", "curves"))
        self.viewers = [named[n] for n in sorted(named) if n.startswith("viewer_")]
        self.tools = [named[n] for n in ("measure", "fit")]
        names = ("curves", "tradeoff", "snapshots", "runs", "history")
        self.beside = [named[n] for n in names if n in named]  # one behind another
        self.all = (self.library, self.panels, *self.viewers, *self.tools, *self.beside)


def place(window: QMainWindow, layout: LayoutName) -> None:
    """Put docks where the layout has them, and open the main ones; others stay as they are."""
    docks = Docks(window)
    others = (*docks.viewers[1:], *docks.tools, *docks.beside[1:])
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
        if _is_narrow(window, docks):
            window.tabifyDockWidget(docks.curves, docks.panels)
        else:
            window.splitDockWidget(docks.curves, docks.panels, _Across)
    else:
        _corners(window, left=_Area.BottomDockWidgetArea, right=_Area.RightDockWidgetArea)
        window.addDockWidget(_Area.LeftDockWidgetArea, docks.library)
        window.addDockWidget(_Area.RightDockWidgetArea, docks.panels)
        window.addDockWidget(_Area.BottomDockWidgetArea, first)
        if layout == "picture_below":
            window.splitDockWidget(docks.panels, docks.curves, _Along)
        elif _is_narrow(window, docks):
            window.tabifyDockWidget(first, docks.curves)
        else:
            window.splitDockWidget(first, docks.curves, _Across)
    for before, dock in zip(docks.beside, docks.beside[1:], strict=False):
        window.tabifyDockWidget(before, dock)
    pictures = (*docks.viewers, *docks.tools)
    for before, dock in pairwise(pictures):
        window.tabifyDockWidget(before, dock)
    for dock in (docks.library, docks.panels, first, docks.curves, *was_open):
        dock.show()
    for dock in (docks.curves, docks.panels, first):
        dock.raise_()


def _is_narrow(window: QMainWindow, docks: Docks) -> bool:
    """Whether picture, curves and panels do not fit side by side: Qt would let them overlap."""
    unit = window.fontMetrics().averageCharWidth()
    beside = (docks.viewers[0], docks.curves)
    least = sum(dock.minimumSizeHint().width() for dock in beside)
    return max(least + _LEAST_PANELS * unit, _LEAST_THREE * unit) > window.width()


def size(window: QMainWindow, layout: LayoutName) -> None:
    docks = Docks(window)
    unit, line = window.fontMetrics().averageCharWidth(), window.fontMetrics().height()
    width, height = window.width(), window.height()
    viewer = docks.viewers[0]
    picture = PICTURE_SHARE * width * window.window().height()
    headings = _HEADINGS * unit
    bars = _height_of_bars(viewer, window.findChild(ImageViewer, "image_viewer.1"))
    if layout == "picture_beside":
        far = width >= 1.4 * _LEAST_BESIDE * unit  # the canvas stands between two others
        _seat_library(window, docks, _Area.RightDockWidgetArea, wide=far)
        tall = max(1, height - bars)
        window.resizeDocks([viewer, docks.library], [round(picture / tall), headings], _Across)
        below = round(0.52 * height)
        window.resizeDocks([docks.curves, docks.panels], [below, below], _Along)
        left = width - round(picture / tall)
        window.resizeDocks([docks.curves, docks.panels], [round(0.5 * left)] * 2, _Across)
        return
    needed = [
        dock.minimumSizeHint().width() for dock in (docks.panels, *docks.beside) if dock.isVisible()
    ]
    side = max(round(min(max(60 * unit, 0.21 * width), 90 * unit)), *needed, 0)
    _seat_library(window, docks, _Area.LeftDockWidgetArea, wide=width >= _LEAST_BESIDE * unit)
    if layout == "canvas_first":
        window.resizeDocks([docks.library, docks.panels], [headings, 60 * unit], _Across)
        window.resizeDocks(
            [viewer, docks.curves], [min(24 * line, round(0.42 * height))] * 2, _Along
        )
        window.resizeDocks([viewer, docks.curves], [62 * unit, 75 * unit], _Across)
        return
    tall = round(picture / (width - side)) + bars
    window.resizeDocks([docks.library, docks.panels], [headings, side], _Across)
    window.resizeDocks([viewer], [max(tall, round(0.62 * height))], _Along)
    shares = [round(0.6 * height), round(0.4 * height)]
    window.resizeDocks([docks.panels, docks.curves], shares, _Along)


def _seat_library(
    window: QMainWindow, docks: Docks, area: Qt.DockWidgetArea, *, wide: bool
) -> None:
    """Put the library behind the panels where it would leave the chain too little of the width."""
    library, panels = docks.library, docks.panels
    seen = window.isVisible() and not panels.isHidden()
    if not seen or panels.isFloating() or library.isFloating():
        return
    is_behind = library in window.tabifiedDockWidgets(panels)
    if not wide and not is_behind:
        window.tabifyDockWidget(panels, library)
        panels.raise_()
    elif wide and is_behind:
        window.addDockWidget(area, library)


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


class Pages(QStackedWidget):
    """The first page, or the network with its docks."""

    @property
    def at_first(self) -> bool:
        return self.currentIndex() == 0

    has_worked = False  # whether a network has been shown, to which one can return

    def show_work(self) -> None:
        self.has_worked = True
        if self.at_first:
            QApplication.instance().installEventFilter(self)
            QTimer.singleShot(QApplication.doubleClickInterval(), self, self._let_clicks_through)
        self.setCurrentIndex(1)

    def _let_clicks_through(self) -> None:
        QApplication.instance().removeEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Hold back a second click: it was meant for what was there before."""
        second = event.type() == QEvent.Type.MouseButtonDblClick
        if second or event.type() == QEvent.Type.MouseButtonPress:  # a press begins another one
            self._let_clicks_through()
        return second


def layout_menu(settings: Settings, layout: WindowLayout, window: QMainWindow) -> Menu:
    """View > Saved Layouts, made anew each time it opens."""
    menu = Menu("Saved La&youts", window)
    deleting = Menu("&Delete", menu)

    def fill() -> None:
        menu.clear()
        deleting.clear()
        for name, places in settings.layouts.items():
            offer(menu, "", name, partial(layout.restore, *places))
            offer(deleting, "", name, partial(keep, name))
        menu.addSeparator()
        saving = menu.addAction("&Save Current as…")
        saving.setEnabled(not layout.lacks_docks)
        saving.triggered.connect(ask)
        deleting.setEnabled(not deleting.isEmpty())
        menu.addMenu(deleting)

    def ask() -> None:
        dialog = QInputDialog(window)
        dialog.setLabelText("Name of the layout:")
        dialog.textValueSelected.connect(
            lambda name: keep(name, window.saveState(DOCKS_VERSION), layout.state())
        )
        dialog.open()

    def keep(name: str, *places: object) -> None:
        others = {one: kept for one, kept in settings.layouts.items() if one != name}
        new = {name.strip(): list(places)} if places and name.strip() else {}
        settings.layouts = others | new

    menu.aboutToShow.connect(fill)
    return menu
