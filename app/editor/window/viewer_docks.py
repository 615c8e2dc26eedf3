"""The docks of the viewers: up to nine for pictures, one for curves, one for trade-offs."""

from collections.abc import Callable, Sequence
from functools import partial

from PySide6 import QtWidgets
from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeySequence, QPainter, QPaintEvent, QPalette, QRegion, QShortcut
from shiboken6 import isValid

from app.editor.docks.tradeoff_view import TradeOffView
from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.viewers.viewer import PICTURE_TYPES, PLOT_TYPES
from app.editor.widgets import labelled
from app.run.transfer_chain import ANALYSIS, find_output, source_images
from core.chain.engine import Plan
from core.chain.wires import Curve, Image, Table
from core.errors import ImagechainError
from core.network.network import reached

_BOTTOM = Qt.DockWidgetArea.BottomDockWidgetArea


class ViewerDocks(QObject):
    """Viewers by number; one that is not there yet is made when something is shown in it."""

    made = Signal(object)  # (dock): a viewer has been made, and is in its place

    def __init__(
        self, session: Session, evaluator: Evaluator, window: QtWidgets.QMainWindow
    ) -> None:
        super().__init__(window)
        self._session = session
        self._evaluator = evaluator
        self._window = window
        self._actions: tuple[tuple[QAction, ...], tuple[QAction, ...]] = ((), ())
        self.images: dict[int, ImageViewer] = {}
        self.docks: dict[int, QtWidgets.QDockWidget] = {}
        self.plot = PlotViewer(session, evaluator)
        self.plot_dock = add_dock(window, "Curves", "curves", self.plot)
        self._viewer(1)
        self.tradeoff = TradeOffView(session, evaluator)
        self.tradeoff_dock = add_dock(window, "Trade-off", "tradeoff", self.tradeoff, hidden=True)

    def offer(self, picture: Sequence[QAction], compare: Sequence[QAction]) -> None:
        """Offer these actions, some under Compare, whose keys work on pictures and curves."""
        self._actions = tuple(picture), tuple(compare)
        self.plot.canvas.addActions(compare)
        for viewer in self.images.values():
            self._offer_to(viewer)

    def _offer_to(self, viewer: ImageViewer) -> None:
        viewer.window_actions, compare = self._actions
        viewer.add_compare_actions(compare)

    def look_at(self, number: int, port: str) -> None:
        self._viewer(number).look_at(port)
        bring_forward(self.docks[number])

    def plot_port(self, port: str) -> None:
        self.plot.look_at(port)
        bring_forward(self.plot_dock)

    def look_at_node(self, name: str, number: int) -> None:
        """Show the first output of a node that is a picture; a curve in the plot viewer."""
        declared = self._session.declared(name)
        if declared is None:
            self._session.message.emit(
                "error", f"{name}: the module is unknown, so there is nothing to show"
            )
            return
        outputs, into = declared.outputs, self._session.network.links_into(name)
        pictures = [port for port in outputs if port.types[0] in PICTURE_TYPES]
        pictures.sort(key=lambda port: port.types[0] != PICTURE_TYPES[0])
        curves = [port for port in outputs if port.types[0] in PLOT_TYPES]
        if pictures:
            self.look_at(number, f"{name}.{pictures[0].name}")
        elif curves:
            self.plot_port(f"{name}.{curves[0].name}")
        elif into:
            self.look_at(number, f"{into[0].source}.{into[0].output}")
        else:
            self._session.message.emit("note", f"{name} has nothing to show")

    def trade_off(self, node: str, parameter: str) -> None:
        self.tradeoff.trade_off(*self._session.plain.parameter_behind(node, parameter))
        bring_forward(self.tradeoff_dock, self.tradeoff.parameter)

    def forget_pictures(self) -> None:
        for number, viewer in self.images.items():
            viewer.look_at(None)
            if number > 2:
                self.docks[number].hide()

    def _viewer(self, number: int) -> ImageViewer:
        viewer = self.images.get(number)
        if viewer is None:
            viewer = ImageViewer(self._session, self._evaluator, number)
            self._offer_to(viewer)
            dock = add_dock(self._window, f"Viewer {number}", f"viewer_{number}", viewer)
            if self.docks:
                self._window.tabifyDockWidget(list(self.docks.values())[-1], dock)
            self._window.restoreDockWidget(dock)  # to where it was the last time, if anywhere
            self.images[number] = viewer
            self.docks[number] = dock
            self.made.emit(dock)
        return viewer

    def name_tabs(self, _visible: bool) -> None:
        """Tabs of docks behind one another are Qt's own, made when needed."""
        if not isValid(self._window):  # type: ignore[no-untyped-call] # they vanish with the window
            return
        for bar in self._window.findChildren(QtWidgets.QTabBar):
            bar.setAccessibleName(bar.accessibleName() or "Tabs")


# Docks of the window.


def add_dock(
    window: QtWidgets.QMainWindow,
    title: str,
    name: str,
    widget: QtWidgets.QWidget,
    area: Qt.DockWidgetArea = _BOTTOM,
    *,
    hidden: bool = False,
) -> QtWidgets.QDockWidget:
    """Put a widget in a dock of that title; `name` is what its place is remembered under."""
    dock = labelled(QtWidgets.QDockWidget(title, window), f"dock.{name}")
    dock.setWidget(widget)
    window.addDockWidget(area, dock)
    dock.setHidden(hidden)
    return dock


def in_front(dock: QtWidgets.QDockWidget) -> bool:
    """Whether a dock is seen: Qt calls one visible behind another's tab, and has it outside."""
    return dock.isVisible() and not dock.visibleRegion().isEmpty()


def bring_forward(dock: QtWidgets.QDockWidget, focus: QtWidgets.QWidget | None = None) -> None:
    dock.show()
    dock.raise_()
    if focus is not None:
        focus.setFocus(Qt.FocusReason.OtherFocusReason)


# One viewer over the whole screen, and back to its dock.

_BACK = ("F11", "Esc")


class FullScreen(QObject):
    """Makes the viewer in use a window over the whole screen, `page`, and puts it back."""

    def __init__(self, viewers: ViewerDocks, session: Session, window: QtWidgets.QWidget) -> None:
        super().__init__(window)
        self._viewers = viewers
        self._session = session
        self._window = window
        self._dock = viewers.plot_dock
        self._keys: list[QShortcut] = []
        self.page: QtWidgets.QWidget | None = None

    def toggle(self) -> None:
        viewers, focus = self._viewers, QtWidgets.QApplication.focusWidget()
        docks = (*viewers.docks.values(), viewers.plot_dock, viewers.tradeoff_dock)
        seen = [dock for dock in docks if dock.isVisible()]
        if self.page is not None:
            self.leave()
        elif not seen:
            self._session.message.emit(
                "note", "no viewer is open: open one to show it in full screen"
            )
        else:
            self._dock = dock = next((dock for dock in seen if _holds(dock, focus)), seen[0])
            self.page = page = dock.widget()
            focus = page.focusWidget() or page.findChild(QtWidgets.QGraphicsView)
            self._keys = [QShortcut(QKeySequence(key), page, self.leave) for key in _BACK]
            page.installEventFilter(self)
            page.setParent(self._window, Qt.WindowType.Window)
            page.setWindowTitle(f"{dock.windowTitle()} — Imagechain")
            page.setGeometry(self._window.screen().geometry())
            page.showFullScreen()
            page.activateWindow()
            focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def leave(self) -> None:
        page, self.page = self.page, None
        if page is None:
            return
        page.removeEventFilter(self)
        while self._keys:
            self._keys.pop().deleteLater()
        focus = page.focusWidget()
        self._dock.setWidget(page)
        self._window.activateWindow()
        if focus is not None:
            focus.setFocus(Qt.FocusReason.OtherFocusReason)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Closed by the window manager, or with all windows: back to the dock."""
        if event.type() == QEvent.Type.Close:
            QTimer.singleShot(0, self, self.leave)  # once Qt has hidden it
        return False


# What is most useful of a network that has just been opened: its picture first, and the panel and
# curve of its first analysis node with figures; without one, the chain's transfer functions.

DIFFERENCE = "difference"  # the output of what a node's picture differs in from the usual


def node_with_figures(plan: Plan) -> str | None:
    """The first analysis node with figures; of slices, the chain's curves show the same."""
    for name, planned in plan.nodes.items():
        if planned.module is None or planned.declaration.group != ANALYSIS:
            continue
        if any(isinstance(value, Table) for value in planned.outputs.values()):
            return name
    return None


def first_ports(plan: Plan) -> tuple[str, ...]:
    """The final picture and the input picture it is to be compared with; as many as there are."""
    try:
        final = find_output(plan).port
    except ImagechainError:
        final = None
    sources = [port for port in source_images(plan) if port != final]
    return tuple(port for port in (final, *sources[:1]) if port is not None)


class FirstViews(QObject):
    """Follows what is opened.

    The final picture is looked at as soon as the network is planned. What stands beside it comes
    with the end of that pass: a viewer of its own takes 0.1 s to make. Then the first viewer
    follows the end of the chain, until a person chooses what it shows.
    """

    def __init__(self, session: Session, evaluator: Evaluator, viewers: ViewerDocks) -> None:
        super().__init__(viewers)
        self._session = session
        self._evaluator = evaluator
        self._viewers = viewers
        self._due = False
        self._beside: Callable[[], None] | None = None
        session.opened.connect(self._opened)
        evaluator.planned.connect(self._planned)
        evaluator.pass_done.connect(self._pass_done)

    def _opened(self) -> None:
        self._due = True
        self._beside = None

    def _planned(self, _plan: object) -> None:
        plan = self._evaluator.plan
        if not self._due or plan is None or not plan.network.nodes:
            return  # an empty network waits for its first nodes
        self._due = False
        node, pictures, front = node_with_figures(plan), first_ports(plan), 1
        outputs = plan.nodes[node].outputs if node is not None else {}
        if pictures and isinstance(outputs.get(DIFFERENCE), Image):
            # What cannot be seen by comparing the two.
            pictures, front = (pictures[0], f"{node}.{DIFFERENCE}"), 2
        if pictures:
            self._viewers.look_at(1, pictures[0])
            self._viewers.images[1].by_hand = False
        curves = [f"{node}.{name}" for name, value in outputs.items() if isinstance(value, Curve)]
        self._beside = partial(self._look_beside, node, curves[:1], pictures[1:], front)

    def _pass_done(self, done: object) -> None:
        if self._due:
            self._planned(done)
        elif self._beside is not None:
            self._viewers.images[1].canvas.viewport().repaint()  # before the others are made
            look, self._beside = self._beside, None
            look()
        else:
            self._follow_end()

    def _follow_end(self) -> None:
        """Move on to the end of the chain as it grows, unless a picture was chosen by hand."""
        viewer, plan = self._viewers.images[1], self._evaluator.plan
        if plan is None or viewer.by_hand or viewer.choices.compares or viewer.kept_side:
            return
        end, shown = next(iter(first_ports(plan)), None), viewer.choices.port
        shown = plan.network.port_names.get(shown, shown)
        if end is None or end == shown:
            return
        node = end.rpartition(".")[0]
        if not shown or node in reached(plan.network.followers, [shown.rpartition(".")[0]]):
            viewer.look_at(end)
            viewer.by_hand = False

    def _look_beside(
        self, node: str | None, curves: Sequence[str], pictures: Sequence[str], front: int
    ) -> None:
        viewers = self._viewers
        shown = viewers.images.get(2)
        if pictures and (shown is None or not shown.choices.port):
            viewers.look_at(2, pictures[0])
            viewers.docks[front].raise_()
        for curve in curves:
            viewers.plot.look_at(curve)
        if node is not None and not self._session.selection:
            self._session.select([node])


# Which part of the window has the keyboard: a ring around it, F6 from part to part.

_TAB = Qt.FocusPolicy.TabFocus
_FOLLOWED = (QEvent.Type.Resize, QEvent.Type.Move, QEvent.Type.Show, QEvent.Type.Hide)
_DOTS = 2


class FocusRing(QtWidgets.QWidget):
    """A ring round the part of the window that has the keyboard; `parts` as F6 has them.

    Only its edges are a widget, so what is inside is not hit. What gets the focus behind other
    tabs is raised.
    """

    def __init__(
        self, parts: Callable[[], Sequence[QtWidgets.QWidget]], window: QtWidgets.QWidget
    ) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.hide()
        self._parts = parts
        self._at: QtWidgets.QWidget | None = None
        # A page that comes back into its dock has the focus before it has its place, and a widget
        # that is shown has the window laid out at once.
        self._settled = QTimer(self, singleShot=True, interval=0)
        self._settled.timeout.connect(self._settle)
        QtWidgets.QApplication.instance().focusChanged.connect(self._follow)

    def go(self, step: int) -> None:
        """Give the focus to the next part in sight."""
        seen = [part for part in self._parts() if in_sight(part)]
        focus = QtWidgets.QApplication.focusWidget()
        at = next((number for number, part in enumerate(seen) if _holds(part, focus)), -1)
        part = seen[(at + step) % len(seen)]
        for widget in (part, *part.findChildren(QtWidgets.QWidget)):
            if widget is part or (widget.isVisible() and widget.focusPolicy() & _TAB):
                widget.setFocus(Qt.FocusReason.TabFocusReason)
                if _holds(part, QtWidgets.QApplication.focusWidget()):
                    return

    def end(self) -> None:
        self._settled.stop()
        QtWidgets.QApplication.instance().focusChanged.disconnect(self._follow)

    def _follow(self, _old: QtWidgets.QWidget | None, new: QtWidgets.QWidget | None) -> None:
        if new is None or new.window() is not self.window():
            return  # a menu or a dialog; the part has the keyboard again after it
        part = next((part for part in self._parts() if _holds(part, new)), None)
        if part is not self._at:
            if self._at is not None:
                self._at.removeEventFilter(self)
            if part is not None:
                part.installEventFilter(self)
            self._at = part
        self._settled.start()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        if event.type() in _FOLLOWED:
            self._settled.start()
        return False

    def _settle(self) -> None:
        above, part = QtWidgets.QApplication.focusWidget(), self._at
        while above is not None and not isinstance(above, QtWidgets.QDockWidget):
            above = above.parentWidget()
        if above is not None and above.window() is self.window() and not in_sight(above):
            above.raise_()
        self.setVisible(part is not None and part.isVisible())
        if part is not None:
            self.setGeometry(QRect(part.mapTo(self.window(), QPoint(0, 0)), part.size()))
            inside = self.rect().adjusted(_DOTS, _DOTS, -_DOTS, -_DOTS)
            self.setMask(QRegion(self.rect()) - QRegion(inside))
            self.raise_()

    def paintEvent(self, _event: QPaintEvent) -> None:
        QPainter(self).fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Highlight))


def in_sight(part: QtWidgets.QWidget) -> bool:
    if not part.isVisible():
        return False
    window = part.window()
    hit = window.childAt(part.mapTo(window, part.rect().center()))
    return part is window or _holds(part, hit)


def _holds(part: QtWidgets.QWidget, widget: QtWidgets.QWidget | None) -> bool:
    return widget is not None and (part is widget or part.isAncestorOf(widget))
