"""The layout that is in use: it grows with the window, and keeps what the user has dragged."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from itertools import pairwise
from typing import Literal, get_args

from PySide6.QtCore import QByteArray, QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QInputDialog,
    QMainWindow,
    QStackedWidget,
    QStyle,
    QTabBar,
    QWidget,
)

from app.editor.gestures import SecondClick, without_argument
from app.editor.library_view import LibraryView
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.widgets import Menu
from app.editor.window.recent_files import DOCKS_VERSION, Settings

Share = tuple[float, float]  # of the window's width and height
Sizes = dict[str, tuple[int, int]]


class WindowLayout(QObject):
    """Places the docks by a named layout, and sizes them when the window is resized."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self.name: LayoutName = DEFAULT
        self._window = window
        self._shares: dict[str, Share] = {}  # by the docks' object names
        self._shown = self._placing = False
        self._pressed: Sizes | None = None
        self._followed: set[str] = set()
        self._soon = QTimer(self, singleShot=True)
        self._soon.timeout.connect(self.keep)
        window.installEventFilter(self)

    def choose(self, name: LayoutName) -> None:
        self.name = name
        self._shares = {}
        self.place()
        self.begin()

    def place(self) -> None:
        with self.placing():
            place(self._window, self.name)

    @contextmanager
    def placing(self) -> Iterator[None]:
        """While docks are moved by the program, not by the user."""
        self._placing = True
        try:
            yield
        finally:
            self._placing = False

    def begin(self) -> None:
        self._shown = True
        self._follow_docks()
        self._size()

    def keep(self) -> None:
        """Keep the sizes of the docks, remembered or dragged, as shares of the window."""
        self._shown = True
        self._follow_docks()
        width, height = self._window.width(), self._window.height()
        shares = {name: (w / width, h / height) for name, (w, h) in self._sizes().items()}
        if shares:  # none is shown beside the first page
            self._shares = shares

    def state(self) -> str:
        return json.dumps({"name": self.name, "shares": self._shares})

    def restore(self, state: str) -> bool:
        """Use what `state` gave; whether it is that."""
        try:
            stored = json.loads(state)
            name = stored["name"]
            shares = {
                dock: (float(share[0]), float(share[1])) for dock, share in stored["shares"].items()
            }
        except (ValueError, TypeError, LookupError, AttributeError):
            return False
        sound = all(0 < part <= 1 for share in shares.values() for part in share)
        if name not in get_args(LayoutName) or not sound:
            return False
        self.name, self._shares = name, shares
        return True

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """See the window resized, and the end of a drag at the line between two docks."""
        if watched is self._window and self._shown:
            if event.type() is QEvent.Type.Resize:
                self._size()
            elif event.type() is QEvent.Type.MouseButtonPress:
                self._pressed = self._sizes()
            elif event.type() is QEvent.Type.MouseButtonRelease:
                pressed, self._pressed = self._pressed, None
                if pressed is not None and pressed != self._sizes():
                    self.keep()
        return False

    def _sizes(self) -> Sizes:
        window = self._window
        return {
            dock.objectName(): (dock.width(), dock.height())
            for dock in Docks(self._window).all
            if dock.isVisible()
            and not dock.isFloating()
            and window.rect().intersects(dock.geometry())  # Qt has those behind another outside
        }

    def _follow_docks(self) -> None:
        for dock in Docks(self._window).all:
            if dock.objectName() not in self._followed:
                self._followed.add(dock.objectName())
                dock.topLevelChanged.connect(self._moved)
                dock.dockLocationChanged.connect(self._moved)

    def _moved(self, *_: object) -> None:
        """A dock has another place: the shares are those of a while later, once all are laid."""
        if self._shown and not self._placing:
            self._soon.start(0)

    def _size(self) -> None:
        if not self._shares:
            size(self._window, self.name)
            return
        width, height = self._window.width(), self._window.height()
        docks = [
            dock
            for dock in Docks(self._window).all
            if dock.objectName() in self._shares and not dock.isFloating()
        ]
        shares = [self._shares[dock.objectName()] for dock in docks]
        widths = [max(1, round(share[0] * width)) for share in shares]
        heights = [max(1, round(share[1] * height)) for share in shares]
        self._window.resizeDocks(docks, widths, Qt.Orientation.Horizontal)
        self._window.resizeDocks(docks, heights, Qt.Orientation.Vertical)


# Named layouts: where the docks stand, and what share of the window each has.
#
# The picture comes first: by default its viewer has at least two fifths of the window, at any
# size, with the chain as a band above it.

LayoutName = Literal["picture_below", "picture_beside", "canvas_first"]
DEFAULT: LayoutName = "picture_below"
_LEAST_PANELS = 40  # letters that a control panel is wide at least
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
    return least + _LEAST_PANELS * unit > window.width()


def size(window: QMainWindow, layout: LayoutName) -> None:
    docks = Docks(window)
    unit, line = window.fontMetrics().averageCharWidth(), window.fontMetrics().height()
    width, height = window.width(), window.height()
    viewer = docks.viewers[0]
    picture = PICTURE_SHARE * width * height
    library = docks.library.widget()  # as narrow as its headings are read without an ellipsis
    headings = library.headings_width() if isinstance(library, LibraryView) else library.width()
    bars = _height_of_bars(viewer, window.findChild(ImageViewer, "image_viewer.1"))
    room = height - window.menuBar().height()
    if layout == "picture_beside":
        tall = max(1, room - bars)
        window.resizeDocks([viewer, docks.library], [round(picture / tall), headings], _Across)
        below = round(0.52 * room)
        window.resizeDocks([docks.curves, docks.panels], [below, below], _Along)
        left = width - round(picture / tall)
        window.resizeDocks([docks.curves, docks.panels], [round(0.5 * left)] * 2, _Across)
        return
    needed = [
        dock.minimumSizeHint().width() for dock in (docks.panels, *docks.beside) if dock.isVisible()
    ]
    side = max(round(min(max(60 * unit, 0.21 * width), 90 * unit)), *needed, 0)
    if layout == "canvas_first":
        window.resizeDocks([docks.library, docks.panels], [headings, 52 * unit], _Across)
        window.resizeDocks([viewer, docks.curves], [min(24 * line, round(0.42 * room))] * 2, _Along)
        window.resizeDocks([viewer, docks.curves], [62 * unit, 75 * unit], _Across)
        return
    tall = round(picture / (width - side)) + bars
    window.resizeDocks([docks.library, docks.panels], [headings, side], _Across)
    window.resizeDocks([viewer], [max(tall, round(0.62 * room))], _Along)
    shares = [round(0.6 * room), round(0.4 * room)]
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


# The pages of the window: the first page, beside which there are no docks, and the network.


class Pages(QStackedWidget):
    """Shows one of both. The docks get their sizes with the network that is shown first."""

    def __init__(
        self, first: QWidget, work: QWidget, layout: WindowLayout, window: QMainWindow
    ) -> None:
        super().__init__(window)
        self._first, self._work = first, work
        self._layout = layout
        self._window = window
        self._docks: QByteArray | None = None  # as they were before the first page hid them
        self._away: list[QDockWidget] = []  # what an empty network has no use for
        self._second_click = SecondClick(self)
        self._sized = False
        self._tidying = QTimer(self, singleShot=True, interval=0)
        self._tidying.timeout.connect(self._put_away_tab_bars)
        self.sizes_remembered = False
        """Whether the docks have the sizes of the last window, to be kept."""
        self.addWidget(first)
        self.addWidget(work)

    @property
    def at_first(self) -> bool:
        return self.currentWidget() is self._first

    @property
    def shows_docks(self) -> bool:
        return self._docks is None and not self._away

    def show_first(self) -> None:
        self.setCurrentWidget(self._first)
        self._hide_docks()

    def show_work(self) -> None:
        if self.at_first:
            self._second_click.drop()
        self.setCurrentWidget(self._work)
        self.show_docks()
        if not self._sized:
            self._sized = True
            (self._layout.keep if self.sizes_remembered else self._layout.begin)()

    def show_canvas_alone(self) -> None:
        """Show an empty network on a large canvas; what would show its pictures comes with them."""
        self.show_work()
        docks = Docks(self._window)
        of_pictures = (*docks.viewers, *docks.tools, *docks.beside)
        self._away = [dock for dock in of_pictures if not (dock.isHidden() or dock.isFloating())]
        for dock in self._away:
            dock.hide()

    def show_docks(self) -> None:
        docks, self._docks = self._docks, None
        if docks is not None:
            with self._layout.placing():
                self._window.restoreState(docks)
        self._bring_back()
        self._tidying.start()

    def _bring_back(self) -> None:
        away, self._away = self._away, []
        if away:
            docks = Docks(self._window)
            opened = [dock for dock in docks.beside if dock.isVisible()]
            for dock in away:
                dock.show()
            for dock in (docks.curves, docks.viewers[0], *opened):
                dock.raise_()
            self._layout.begin()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._tidying.start()

    def _put_away_tab_bars(self) -> None:
        """Qt forgets bars of a single tab in the window's corner when docks come back."""
        direct = Qt.FindChildOption.FindDirectChildrenOnly
        for bar in self._window.findChildren(QTabBar, options=direct):
            if bar.count() <= 1:
                bar.move(-bar.width(), -bar.height())

    def _hide_docks(self) -> None:
        if self._docks is None:
            self._docks = self._window.saveState()
        for dock in self._window.findChildren(QDockWidget):
            if not dock.isFloating():
                dock.hide()

    def choose_layout(self, name: LayoutName) -> None:
        self.show_docks()
        self._layout.choose(name)
        self._hide_at_first()

    def places(self) -> tuple[QByteArray, str]:
        return self._window.saveState(DOCKS_VERSION), self._layout.state()

    def restore_layout(self, docks: QByteArray, state: str) -> None:
        self.show_docks()
        with self._layout.placing():
            self._window.restoreState(docks, DOCKS_VERSION)
        if self._layout.restore(state):
            self._layout.begin()
        self._hide_at_first()

    def _hide_at_first(self) -> None:
        if self.at_first:
            self._hide_docks()
            self.sizes_remembered = self._sized = False


class LayoutMenu(Menu):
    """View > Saved Layouts, made anew each time it opens."""

    def __init__(self, settings: Settings, pages: Pages) -> None:
        super().__init__("Saved La&youts", pages)
        self._settings, self._pages = settings, pages
        self.aboutToShow.connect(self._fill)

    def _fill(self) -> None:
        self.clear()
        deleting = Menu("&Delete", self)
        for name, places in self._settings.layouts.items():
            choosing = partial(self._pages.restore_layout, *places)
            for menu, act in ((self, choosing), (deleting, partial(self._keep, name))):
                action = menu.addAction(name.replace("&", "&&"))
                action.triggered.connect(partial(without_argument, act))
        self.addSeparator()
        saving = self.addAction("&Save Current as…")
        saving.triggered.connect(self._ask)
        saving.setEnabled(self._pages.shows_docks)
        deleting.setEnabled(not deleting.isEmpty())
        self.addMenu(deleting)

    def _ask(self) -> None:
        dialog = QInputDialog(self._pages)
        dialog.setLabelText("Name of the layout:")
        dialog.textValueSelected.connect(lambda name: self._keep(name, *self._pages.places()))
        dialog.open()

    def _keep(self, name: str, *places: object) -> None:
        others = {one: kept for one, kept in self._settings.layouts.items() if one != name}
        new = {name.strip(): list(places)} if places and name.strip() else {}
        self._settings.layouts = others | new
