"""What stands on the panel of a module: picture, parameters, read-outs, ports."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFrame, QLabel, QMenu, QVBoxLayout, QWidget

from app.editor.evaluation.evaluator import Evaluator
from app.editor.panels.fit_menu import add_fit_action
from app.editor.panels.illustrations import illustration_for
from app.editor.panels.macro_menu import add_macro_actions
from app.editor.panels.ports_section import PortsView
from app.editor.panels.readouts import ReadoutsView
from app.editor.panels.sections_view import SectionsView
from app.editor.session import Session
from app.editor.theme import FAINT, Theme
from core.editing.operations import ABSENT, set_parameter
from core.modules.declaration import Declaration
from core.names import thaw
from core.network.linked_values import LinkError
from core.network.network import Network, Node


class ModuleBody(QWidget):
    """The panel of a node of a known module, below its head.

    Signals
    -------
    view_requested(node, port, viewer)
        Show that output in the viewer of that number.
    trade_off_requested(node, parameter)
        Show figures of merit as it moves.
    held(parameter, on)
        The mouse holds a control of that parameter: nothing may move.
    """

    view_requested = Signal(str, str, int)
    trade_off_requested = Signal(str, str)
    held = Signal(str, bool)

    def __init__(
        self,
        declaration: Declaration,
        node: str,
        session: Session,
        evaluator: Evaluator | None,
        theme: Theme,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName("body")
        self._session = session
        self._node = node
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(8, 4, 8, 8)
        self._column.setSpacing(4)
        self.illustration: QWidget | None = None
        special = illustration_for(declaration)
        if special is not None:
            self.illustration = special(session, evaluator, node, theme, self)
            self._column.addWidget(self.illustration)
        self.sections = SectionsView(declaration, session, theme, self)
        self.sections.edited.connect(self._edit)
        self.sections.reset_wanted.connect(self._reset)
        self.sections.gesture_ended.connect(session.end_gesture)
        self.sections.trade_off_wanted.connect(self._trade_off)
        self.sections.menu_opening.connect(self._add_to_menu)
        self.sections.unlink_wanted.connect(self._unlink)
        self.sections.held.connect(self.held)
        for field in self.sections.fields:
            field.link_fault = self._link_fault
            field.node_name = node
        session.free.changed.connect(self._mark_free)
        self._mark_free()
        self._valued: Node | None = None
        self._column.addWidget(self.sections)
        self.readouts = ReadoutsView(declaration, node, evaluator, session, theme, self)
        if declaration.readouts:
            self._titled(self.readouts.title, self.readouts)
        else:
            self.readouts.hide()
            self.readouts.title.hide()
        self.ports = PortsView(declaration, node, theme, self)
        self.ports.view_requested.connect(self.view_requested)
        self._titled(QLabel("Ports", self), self.ports)
        self.set_theme(theme)

    def follow(self, before: Network | None, after: Network) -> None:
        """Show the node as it is now, where it was changed."""
        node, valued = after.nodes[self._node], self._session.valued(self._node)
        faults = self._session.resolved.faults_of(node)
        changed = before is None or before.nodes.get(self._node) is not node
        if changed or valued is not self._valued or faults:
            self.sections.follow(node, valued.params, faults)
        self._valued = valued
        if before is None or before.links != after.links:
            self.ports.follow(after)

    def set_held_back(self, on: bool) -> None:
        """Whether the node stays as it was until all is generated."""
        self.readouts.set_held_back(on)

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        for part in (self.illustration, self.sections, self.readouts, self.ports):
            draw = getattr(part, "set_theme", None)
            if draw is not None:
                draw(theme)

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
        """Mark what is free for a fit."""
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
