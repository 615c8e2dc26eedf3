"""The docks of the viewers: up to nine for pictures, one for curves, one for trade-offs."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QApplication,
    QDockWidget,
    QGraphicsView,
    QMainWindow,
    QTabBar,
    QWidget,
)
from shiboken6 import isValid

from app.editor.docks.tradeoff_view import TradeOffView
from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.editor.viewers.network_ports import PICTURE_TYPES, PLOT_TYPES
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot.plot_viewer import PlotViewer

_BOTTOM = Qt.DockWidgetArea.BottomDockWidgetArea


class ViewerDocks(QObject):
    """Viewers by number; one that is not there yet is made when something is shown in it."""

    made = Signal(object)  # (dock): a dock has been made

    def __init__(self, session: Session, evaluator: Evaluator, window: QMainWindow) -> None:
        super().__init__(window)
        self._session = session
        self._evaluator = evaluator
        self._window = window
        self.picture_actions: tuple[QAction, ...] = ()
        self._compare_actions: tuple[QAction, ...] = ()
        self.images: dict[int, ImageViewer] = {}
        self.docks: dict[int, QDockWidget] = {}
        self.plot = PlotViewer(session, evaluator)
        self.plot_dock = self._dock("Curves", "dock.curves", self.plot)
        self._viewer(1)
        self.tradeoff = TradeOffView(session, evaluator)
        self.tradeoff_dock = self._dock("Trade-off", "dock.tradeoff", self.tradeoff)
        self.tradeoff_dock.hide()

    def set_picture_actions(self, *actions: QAction) -> None:
        self.picture_actions = actions
        for viewer in self.images.values():
            viewer.window_actions = actions

    def add_compare_actions(self, actions: Sequence[QAction]) -> None:
        """Offer these actions under Compare, and let their keys work on pictures and curves."""
        self._compare_actions = tuple(actions)
        self.plot.canvas.addActions(self._compare_actions)
        for viewer in self.images.values():
            viewer.add_compare_actions(self._compare_actions)

    def look_at(self, number: int, port: str) -> None:
        self._viewer(number).look_at(port)
        self.docks[number].show()
        self.docks[number].raise_()

    def plot_port(self, port: str) -> None:
        self.plot.look_at(port)
        self.plot_dock.show()
        self.plot_dock.raise_()

    def look_at_node(self, name: str, number: int) -> None:
        """Show the first output of a node that is a picture; a curve in the plot viewer."""
        declared = self._session.declared(name)
        if declared is None:
            self._session.message.emit("error", f"{name}: an unknown module has nothing to show")
            return
        for kinds in (PICTURE_TYPES[:1], PICTURE_TYPES):
            for port in declared.outputs:
                if port.types[0] in kinds:
                    self.look_at(number, f"{name}.{port.name}")
                    return
        curves = [port.name for port in declared.outputs if port.types[0] in PLOT_TYPES]
        if curves:
            self.plot_port(f"{name}.{curves[0]}")
        elif declared.inputs:
            self._look_at_input(name, number)
        else:
            self._session.message.emit("advice", f"{name} has nothing to show")

    def trade_off(self, node: str, parameter: str) -> None:
        self.tradeoff.trade_off(*self._session.plain.parameter_behind(node, parameter))
        bring_forward(self.tradeoff_dock, self.tradeoff.bar.parameter)

    def forget_pictures(self) -> None:
        """Show nothing, as for another document; viewers beyond the first close."""
        for number, viewer in self.images.items():
            viewer.look_at(None)
            if number > 2:
                self.docks[number].hide()

    def _look_at_input(self, name: str, number: int) -> None:
        for link in self._session.network.links_into(name):
            self.look_at(number, f"{link.source}.{link.output}")
            return
        self._session.message.emit("advice", f"{name} has nothing to show: it has no input")

    def _viewer(self, number: int) -> ImageViewer:
        viewer = self.images.get(number)
        if viewer is None:
            viewer = ImageViewer(self._session, self._evaluator, number)
            viewer.window_actions = self.picture_actions
            viewer.add_compare_actions(self._compare_actions)
            dock = self._dock(f"Viewer {number}", f"dock.viewer_{number}", viewer)
            if self.docks:
                self._window.tabifyDockWidget(list(self.docks.values())[-1], dock)
            self._window.restoreDockWidget(dock)  # to where it was the last time, if anywhere
            self.images[number] = viewer
            self.docks[number] = dock
        return viewer

    def _dock(self, title: str, name: str, widget: QWidget) -> QDockWidget:
        dock = add_dock(self._window, title, name, widget, _BOTTOM)
        dock.visibilityChanged.connect(self.name_tabs)
        self.made.emit(dock)
        return dock

    def name_tabs(self, _visible: bool) -> None:
        """Tabs of docks behind one another are Qt's own, made when needed."""
        if not isValid(self._window):  # type: ignore[no-untyped-call] # they vanish with the window
            return
        for bar in self._window.findChildren(QTabBar):
            bar.setAccessibleName(bar.accessibleName() or "Tabs")


# Docks of the window.


def add_dock(
    window: QMainWindow, title: str, name: str, widget: QWidget, area: Qt.DockWidgetArea
) -> QDockWidget:
    """Put a widget in a dock of that title; `name` is what its place is remembered under."""
    dock = QDockWidget(title, window)
    dock.setObjectName(name)
    dock.setWidget(widget)
    window.addDockWidget(area, dock)
    return dock


def stand_behind(window: QMainWindow, front: QDockWidget, dock: QDockWidget) -> None:
    """Have a dock that is closed open behind another one.

    What a window of an earlier version has stored has no place for it.
    """
    if dock.isHidden() and not front.isFloating():
        window.tabifyDockWidget(front, dock)


def in_front(dock: QDockWidget) -> bool:
    """Whether a dock is seen: Qt calls one visible behind another's tab, and has it outside."""
    return dock.isVisible() and not dock.visibleRegion().isEmpty()


def bring_forward(dock: QDockWidget, focus: QWidget) -> None:
    dock.show()
    dock.raise_()
    focus.setFocus(Qt.FocusReason.OtherFocusReason)


def toggle_dock(dock: QDockWidget, focus: QWidget) -> None:
    """Show a dock with the focus in it, or hide it where it is in front."""
    if in_front(dock):
        dock.hide()
    else:
        bring_forward(dock, focus)


# One viewer over the whole screen, and back to its dock.

_BACK = ("F11", "Esc")


class FullScreen(QObject):
    """Makes the viewer that was used last a window over the whole screen, and puts it back.

    `page` is that viewer meanwhile.
    """

    def __init__(self, viewers: ViewerDocks, session: Session, window: QWidget) -> None:
        super().__init__(window)
        self._viewers = viewers
        self._session = session
        self._window = window
        self._used: QDockWidget | None = None
        self._keys: list[QShortcut] = []
        self.page: QWidget | None = None
        QApplication.instance().focusChanged.connect(self._focus_changed)

    def toggle(self) -> None:
        docks = (self._used, *self._viewers.docks.values(), self._viewers.plot_dock)
        dock = next((dock for dock in docks if dock is not None and dock.isVisible()), None)
        if self.page is not None:
            self.leave()
        elif dock is None:
            self._session.message.emit("note", "no viewer is open to show in full screen")
        else:
            self._used, self.page = dock, dock.widget()
            focus = self.page.focusWidget() or self.page.findChild(QGraphicsView)
            self._keys = [QShortcut(QKeySequence(key), self.page, self.leave) for key in _BACK]
            self.page.installEventFilter(self)
            self.page.setParent(self._window, Qt.WindowType.Window)
            self.page.setWindowTitle(f"{dock.windowTitle()} — Imagechain")
            self.page.setGeometry(self._window.screen().geometry())
            self.page.showFullScreen()
            self.page.activateWindow()
            focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def leave(self) -> None:
        """Put the viewer back into its dock, with the focus where it was in it."""
        page, self.page = self.page, None
        if page is None or self._used is None:
            return
        page.removeEventFilter(self)
        while self._keys:
            self._keys.pop().deleteLater()
        focus = page.focusWidget()
        self._used.setWidget(page)
        self._window.activateWindow()
        if focus is not None:
            focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def close(self) -> None:
        self.leave()
        QApplication.instance().focusChanged.disconnect(self._focus_changed)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Closed by the window manager, or with all windows: back to the dock."""
        if event.type() == QEvent.Type.Close:
            QTimer.singleShot(0, self, self.leave)  # once Qt has hidden it
        return False

    def _focus_changed(self, _before: object, now: QWidget | None) -> None:
        viewers = self._viewers
        for dock in (*viewers.docks.values(), viewers.plot_dock, viewers.tradeoff_dock):
            if now is not None and self.page is None and dock.isAncestorOf(now):
                self._used = dock
