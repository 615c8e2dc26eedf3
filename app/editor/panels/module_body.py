"""What stands on the panel of a module: picture, parameters, read-outs, ports."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAction, QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QToolButton,
    QVBoxLayout,
    QWidget,
    QWidgetAction,
)

from app.editor.declared_text import tip
from app.editor.evaluation.evaluator import Evaluator
from app.editor.number_text import FreeNumber
from app.editor.panels.preview_view import PreviewView, preview_query
from app.editor.panels.readouts import ReadoutsView
from app.editor.panels.sections_view import SectionsView
from app.editor.session import Session
from app.editor.theme import CHANGED, FAINT, theme_of
from app.editor.viewers.network_ports import PLOT_TYPES, VIEWER_NUMBERS
from app.editor.widgets import plain_label, tool_button
from core.editing.macros import expose, exposed_as, hide, rename_exposed
from core.editing.operations import ABSENT, Operation, set_parameter
from core.errors import ImagechainError
from core.modules.declaration import Declaration, Port
from core.names import shown, thaw
from core.network.linked_values import LinkError
from core.network.macro import SEPARATOR
from core.network.network import Link, Network, Node


class ModuleBody(QWidget):
    """The panel of a node of a known module, below its head."""

    # node, port, viewer: show that output in the viewer of that number
    view_requested = Signal(str, str, int)
    trade_off_requested = Signal(str, str)  # node, parameter: show figures of merit as it moves
    # parameter, on: the mouse holds a control of that parameter: nothing may move
    held = Signal(str, bool)

    def __init__(
        self,
        declaration: Declaration,
        node: str,
        session: Session,
        evaluator: Evaluator | None,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName("body")
        self._session = session
        self._node = node
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(8, 4, 8, 8)
        self._column.setSpacing(4)
        module = session.library.get(declaration.key)  # a macro is of none
        if module is not None and preview_query(module, node) is not None:
            self._column.addWidget(PreviewView(session, evaluator, node, self))
        self.sections = SectionsView(declaration, session, self)
        for field in self.sections.fields:
            field.edited.connect(self._edit)
            field.reset_wanted.connect(self._reset)
            field.gesture_ended.connect(session.end_gesture)
            field.trade_off_wanted.connect(self._trade_off)
            field.menu_opening.connect(self._add_to_menu)
            field.unlink_wanted.connect(self._unlink)
            field.held.connect(self.held)
            field.link_fault = self._link_fault
            field.node_name = node
        session.free.changed.connect(self._mark_free)
        self._mark_free()
        self._valued: Node | None = None
        self._column.addWidget(self.sections)
        self.readouts = ReadoutsView(declaration, node, evaluator, session, self)
        if declaration.readouts:
            self._titled(self.readouts.title, self.readouts)
        else:
            self.readouts.hide()
            self.readouts.title.hide()
        self.ports = PortsView(declaration, node, self)
        self.ports.view_requested.connect(self.view_requested)
        self._titled(QLabel("Ports", self), self.ports)

    def follow(self, before: Network | None, after: Network) -> None:
        node, valued = after.nodes[self._node], self._session.valued(self._node)
        faults = self._session.resolved.faults_of(node)
        changed = before is None or before.nodes.get(self._node) is not node
        if changed or valued is not self._valued or faults:
            self.sections.follow(node, valued.params, faults)
        self._valued = valued
        if before is None or before.links != after.links:
            self.ports.follow(after)

    def _titled(self, title: QLabel, widget: QWidget) -> None:
        line = QFrame(self)
        line.setFrameShape(QFrame.Shape.HLine)
        line.setFrameShadow(QFrame.Shadow.Sunken)
        font = title.font()
        font.setBold(True)
        title.setFont(font)
        title.setForegroundRole(FAINT)
        for part in (line, title, widget):
            self._column.addWidget(part)

    def _edit(self, name: str, value: object, gesture: object) -> None:
        if self._node in self._session.network.nodes:
            self._session.do(set_parameter(self._node, name, value), gesture=gesture)

    def _add_to_menu(self, name: str, menu: QMenu) -> None:
        if self._node in self._session.network.nodes:
            add_fit_action(menu, self._session, self._node, name)
            add_macro_actions(menu, self._session, self._node, name)

    def _mark_free(self) -> None:
        for field in self.sections.fields:
            field.show_free(self._session.free.has(self._node, field.parameter.name))

    def _link_fault(self, name: str, raw: object) -> LinkError | None:
        """Why a parameter cannot follow that; None where it can."""
        return self._session.link_fault(self._node, name, raw)

    def _unlink(self, name: str) -> None:
        if self._node in self._session.network.nodes:
            value = thaw(self._session.valued(self._node).params[name])
            label = f"Unlink {self._node}.{name}"
            self._session.do(set_parameter(self._node, name, value, label))

    def _trade_off(self, name: str) -> None:
        self.trade_off_requested.emit(self._node, name)

    def _reset(self, name: str) -> None:
        if self._node in self._session.network.nodes:
            self._session.do(set_parameter(self._node, name, ABSENT))


# What the menu of a number offers about fits: free it, or fix it again.

_ABOUT = (
    "A fit to a picture (the dock Fit) determines what is free; this holds while the network is "
    "open, and is not saved with it"
)


def add_fit_action(menu: QMenu, session: Session, node: str, parameter: str) -> None:
    """Offer to free a number that may lie between others, or to fix it."""
    declared = session.declared(node)
    known = declared.parameter(parameter) if declared is not None else None
    if known is None or known.kind != "number":
        return
    free = session.free.has(node, parameter)
    if not free and parameter in session.network.nodes[node].linked:
        return  # what it follows can be free
    menu.addSeparator()
    action = menu.addAction("Fix (no longer fitted)" if free else "Free for a fit")
    action.setObjectName("fix" if free else "free")
    action.setToolTip(_ABOUT)
    action.setStatusTip(_ABOUT)
    action.triggered.connect(partial(_switch, session, node, parameter))
    menu.setToolTipsVisible(True)


def _switch(session: Session, node: str, parameter: str, *_: object) -> None:
    if session.free.has(node, parameter):
        session.free.fix(node, parameter)
    else:
        session.free.put(FreeNumber(node, parameter))


# What the menu of a field offers about macros: whether one shows the parameter, and its name.


def add_macro_actions(menu: QMenu, session: Session, node: str, parameter: str) -> None:
    """Add what a macro can do with a parameter of one of its nodes, or with one that it shows."""
    network = session.document.network
    if session.network.nodes[node].macro is not None:
        menu.addSeparator()
        hiding = partial(hide, network, node, parameter, session.resolved.value)
        _add(menu, "hide", "Hide from this panel", session, hiding)
        menu.addAction(_naming(menu, session, node, parameter))
        return
    macro = node.removesuffix(SEPARATOR + session.local_name(node))
    if macro == node:  # in no macro
        return
    menu.addSeparator()
    name = exposed_as(network, node, parameter)
    if name:
        text, value_of = f"Hide from the panel of {macro}", session.resolved.value
        _add(menu, "hide", text, session, partial(hide, network, macro, name, value_of))
    else:
        text = f"Show on the panel of {macro}"
        _add(menu, "expose", text, session, partial(expose, network, node, parameter))


def _add(
    menu: QMenu, name: str, text: str, session: Session, made: Callable[[], Operation]
) -> None:
    action = menu.addAction(text.replace("&", "&&"))
    action.setObjectName(name)
    action.triggered.connect(partial(_do, session, made))


def _do(session: Session, made: Callable[[], Operation], *_: object) -> None:
    try:
        session.do(made())
    except ImagechainError as error:
        session.message.emit("error", str(error))


def _naming(menu: QMenu, session: Session, macro: str, name: str) -> QWidgetAction:
    """A line in the menu in which the parameter's name is typed; Enter takes it."""
    edit, action = line_in_menu(menu, "Name", "exposed_name")
    edit.setText(name)
    edit.setAccessibleName(f"name of the parameter {name} on this panel")
    edit.setToolTip("What the parameter is called on this panel; Enter takes it")

    def take() -> None:
        new = edit.text().strip()
        menu.close()
        if new != name:
            network = session.document.network
            _do(session, partial(rename_exposed, network, macro, name, new))

    edit.returnPressed.connect(take)
    action.setObjectName("rename_exposed")
    return action


def line_in_menu(menu: QMenu, text: str, name: str) -> tuple[QLineEdit, QWidgetAction]:
    """A line to type in that can be added to a menu, with a label of that text before it."""
    line = QWidget(menu)
    label, edit = QLabel(text, line), QLineEdit(line)
    edit.setObjectName(name)
    label.setBuddy(edit)
    row = QHBoxLayout(line)
    row.setContentsMargins(12, 2, 12, 2)
    row.addWidget(label)
    row.addWidget(edit, 1)
    line.setFocusProxy(edit)
    action = QWidgetAction(menu)
    action.setDefaultWidget(line)
    return edit, action


# The ports of a node on its panel, each with a button that shows it.


class PortsView(QWidget):
    """Inputs and outputs; an input shows what its wire brings."""

    # node, port, viewer: show that output in the viewer of that number
    view_requested = Signal(str, str, int)

    def __init__(self, declaration: Declaration, node: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("ports")
        self._node = node
        self._rows: list[_PortRow] = []
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 2, 0, 2)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(1, 1)
        sides = (("input", declaration.inputs), ("output", declaration.outputs))
        for side, ports in sides:
            for port in ports:
                row = _PortRow(node, port, side, self)
                row.view_requested.connect(self.view_requested)
                line = len(self._rows)
                for column, widget in enumerate((row.mark, row.label, row.button)):
                    grid.addWidget(widget, line, column)
                self._rows.append(row)

    def follow(self, network: Network) -> None:
        links = {link.input: link for link in network.links_into(self._node)}
        for row in self._rows:
            row.follow(links.get(row.port.name))


class _PortRow(QObject):
    view_requested = Signal(str, str, int)

    def __init__(self, node: str, port: Port, side: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.port = port
        self._side = side
        self._source = (node, port.name) if side == "output" else None
        self.mark = _Dot(port.types[0], parent)
        self.label = plain_label("", parent)
        kinds = " or ".join(port.types)
        need = "" if port.required else ", may be left unconnected"
        self.label.setToolTip(tip(f"{side} {port.name}: {kinds}{need}"))
        about = f"view {side} {port.name}"
        self.button = tool_button(f"view.{side}.{port.name}", "View", about, parent)
        if set(port.types) <= set(PLOT_TYPES):
            self.button.setToolTip(tip("Show it in Curves"))
        else:
            self._offer_viewers()
        self.button.clicked.connect(self._clicked)
        self.follow(None)

    def _offer_viewers(self) -> None:
        tooltip = "Show it in viewer 1; the arrow (or Down key) offers the others"
        self.button.setToolTip(tip(tooltip))
        self.button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        menu = QMenu(self.button)
        for number in VIEWER_NUMBERS:
            menu.addAction(f"Viewer &{number}").setData(number)
        menu.triggered.connect(self._view)
        self.button.setMenu(menu)

    def follow(self, link: Link | None) -> None:
        text = self.port.name
        if self._side == "input":
            self._source = (link.source, link.output) if link is not None else None
            text += f" ← {link.source}.{link.output}" if link is not None else " ← not connected"
        self.label.setText(text)
        self.button.setEnabled(self._source is not None)

    def _clicked(self) -> None:
        self._view(None)

    def _view(self, action: QAction | None) -> None:
        if self._source is not None:
            number = 1 if action is None else int(action.data())
            self.view_requested.emit(*self._source, number)


class _Dot(QWidget):
    """The mark of a port, in the colour of its type."""

    def __init__(self, kind: str, parent: QWidget) -> None:
        super().__init__(parent)
        self._kind = kind
        self.setFixedSize(QSize(1, 1) * self.fontMetrics().height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme, radius = theme_of(self), 0.28 * self.height()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(theme.ports.get(self._kind, theme.faint_text)))
        painter.drawEllipse(QRectF(self.rect()).center(), radius, radius)
        painter.end()


# What stands on the panel of a module that the library does not have.


class UnknownBody(QWidget):
    """The parameters as the file has them, to be read only.

    `why` says why the library does not have the module, where that is known.
    """

    def __init__(self, module: str, node: str, why: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("body")
        self._node = node
        self.note = plain_label(
            "unknown_module",
            self,
            f"There is no module {shown(module)} in this library{why and f': {why}'}. The node is "
            "kept as it is, with these parameters, and is saved again; it computes nothing.",
            role=CHANGED,
        )
        self._grid = QGridLayout()
        self._grid.setColumnStretch(1, 1)
        self._labels: list[QLabel] = []
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 4, 8, 8)
        column.addWidget(self.note)
        column.addLayout(self._grid)

    def follow(self, before: Network | None, after: Network) -> None:
        node = after.nodes[self._node]
        if before is not None and before.nodes.get(self._node) is node:
            return
        for label in self._labels:
            self._grid.removeWidget(label)
            label.deleteLater()
        self._labels = []
        for row, (name, value) in enumerate(sorted(node.params.items())):
            text = value if isinstance(value, str) else json.dumps(thaw(value), ensure_ascii=False)
            for column, words in enumerate((name, text)):
                label = plain_label("", self, words)
                self._grid.addWidget(label, row, column)
                self._labels.append(label)
            label.setObjectName(f"raw.{name}")
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
