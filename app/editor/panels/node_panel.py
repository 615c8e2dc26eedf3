"""The control panel of one node."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QFrame, QLineEdit, QToolButton, QVBoxLayout, QWidget, QWidgetAction

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Badge
from app.editor.gestures import without_argument
from app.editor.panels.fields.field_menu import line_in_menu, offer
from app.editor.panels.fields.panel_node import PanelNode, copy_values, paste_values
from app.editor.panels.fields.type_in import TypeIn, discard_typing
from app.editor.panels.head import PanelHead
from app.editor.panels.module_body import ModuleBody, UnknownBody
from app.editor.panels.preview_view import PreviewView, preview_query
from app.editor.session import Session
from app.editor.widgets import Menu, filled
from app.run.preset_files import Sets, given, remove_set, save_set, sets_of
from core.editing.operations import ABSENT, Rename, has_picture, output_toggled, set_node_field
from core.errors import ImagechainError
from core.modules.declaration import where_absent
from core.network.macro import SEPARATOR
from core.network.network import MACRO, Network


class NodePanel(QFrame):
    """Head and body of a node's panel. It shows the document and holds no part of it.

    For another node there is another panel. Without a folder where named sets of parameters are
    kept, none are offered.
    """

    def __init__(
        self,
        of: PanelNode,
        evaluator: Evaluator | None,
        parent: QWidget | None = None,
        sets_folder: Path | None = None,
        *,
        illustrations: Collection[str] = (),
    ) -> None:
        super().__init__(parent)
        self._of = of
        session, node = of.session, of.name
        self.setObjectName(f"panel.{node}")
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.node = node
        self._local_name = session.local_name(node)
        self.module = session.network.nodes[node].module
        self._session = session
        declared = self.declared = session.declared(node)
        title, group, text = (
            (declared.title, declared.group, declared.text)
            if declared is not None
            else (self.module, "", "")
        )
        self.setAccessibleName(f"control panel of {node}: {title}")
        self.head = PanelHead(title, group, text, self)
        self.body: ModuleBody | UnknownBody
        if declared is not None:
            self.head.output.setVisible(has_picture(declared))
            module = session.library.get(declared.key)  # a macro is of none
            query = preview_query(module, node) if module is not None else None
            if query is not None:
                preview = PreviewView(session, evaluator, node, self.head.place)
                at_first = getattr(query, "part", "") != "mtf"  # which stands among the curves
                self.head.illustrate(preview, shown=at_first != (self.module in illustrations))
            self.body = ModuleBody(declared, of, evaluator, self)
        else:
            why = where_absent(self.module, session.library)
            self.body = UnknownBody(self.module, node, why, self)
            for button in (self.head.auto, self.head.disable, self.head.generate, self.head.output):
                button.setEnabled(False)
        filled(QVBoxLayout(self), self.head, self.body, spacing=0)
        keeps = sets_folder is not None and declared is not None and declared.key != MACRO
        self.head.sets.setVisible(keeps and bool(declared and declared.parameters))
        if sets_folder is not None:
            self.sets_menu = add_sets_menu(self.head.sets, of, sets_folder)
        self._connect()
        if sets_folder is not None:
            self.sets_menu.above = self.head.bar.actions()
        self.follow(None, session.network)

    def _connect(self) -> None:
        head, requests = self.head, self._of.requests
        head.bar.folded.connect(self._fold)
        head.pin.clicked.connect(self._pin)
        head.fold_picture.clicked.connect(self._fold_picture)
        head.close_button.clicked.connect(
            partial(without_argument, partial(requests.close.emit, self.node))
        )
        head.name.committed.connect(self._rename)
        head.name.returnPressed.connect(self._leave_name)  # after it is taken, or refused
        head.name.given_up.connect(self._show_name)
        head.auto.clicked.connect(self._set_auto)
        head.disable.clicked.connect(self._set_disabled)
        head.output.clicked.connect(self._mark_output)
        head.generate.clicked.connect(partial(without_argument, requests.generate.emit))
        head.more.linkActivated.connect(
            partial(without_argument, partial(requests.handbook.emit, self.node))
        )
        head.bar.offer("copy_values", "Copy values", partial(self._with_values, copy_values))
        head.bar.offer("paste_values", "Paste values", partial(self._with_values, paste_values))

    @property
    def folded(self) -> bool:
        return self.head.bar.fold.isChecked()

    @folded.setter
    def folded(self, on: bool) -> None:
        self.head.bar.fold.setChecked(on)

    def follow(self, before: Network | None, after: Network) -> None:
        if before is None or before.nodes.get(self.node) is not after.nodes[self.node]:
            self.head.follow(after.nodes[self.node])
            self.head.name.show_text(self._local_name)
        marked = after.output_nodes
        inside = f"{self.node}{SEPARATOR}"
        self.head.output.setChecked(any(n == self.node or n.startswith(inside) for n in marked))
        self.body.follow(before, after)

    def set_badge(self, badge: Badge | None) -> None:
        self.head.set_badge(badge)
        if isinstance(self.body, ModuleBody) and (badge is None or badge.kind != "running"):
            self.body.readouts.set_held_back(badge is not None and badge.kind == "stale")

    def edit_name(self) -> None:
        self.folded = False
        self.head.name.setFocus(Qt.FocusReason.OtherFocusReason)
        self.head.name.selectAll()

    def finish_typing(self) -> None:
        for edit in self.findChildren(TypeIn):
            edit.commit()

    def discard_typing(self) -> None:
        discard_typing(self)

    def _fold(self, on: bool) -> None:
        self.head.below.setVisible(not on)
        self.body.setVisible(not on)

    def _fold_picture(self) -> None:
        shown = not self.head.fold_picture.isChecked()
        self._of.requests.illustrated.emit(self.module, shown)

    def _with_values(self, act: Callable[[Session, tuple[str, ...]], None]) -> None:
        self.finish_typing()
        if self._of.is_there:
            act(self._session, (self.node,))

    def _rename(self, text: str) -> None:
        node = self._session.network.nodes.get(self.node)
        if node is None or text == self._local_name:
            self._show_name()
            return
        operation = Rename(self.node, text)
        try:
            self._session.check(operation)
        except ImagechainError as error:
            self.head.show_name_error(error.message)
            return
        self._session.do(operation)

    def _leave_name(self) -> None:
        if not self.head.name.marked:
            self._of.requests.named.emit()

    def _show_name(self) -> None:
        self.head.name.show_text(self._local_name)
        self.head.show_name_error("")

    def _set_auto(self) -> None:
        self._of.do(set_node_field(self.node, "auto", self.head.auto.isChecked()))

    def _set_disabled(self) -> None:
        self._of.do(set_node_field(self.node, "disabled", self.head.disable.isChecked()))

    def _mark_output(self) -> None:
        session = self._session
        if self._of.is_there:
            session.do(output_toggled(session.network, session.library, self.node))

    def _pin(self) -> None:
        value = True if self.head.pin.isChecked() else ABSENT
        self._of.do(set_node_field(self.node, "pinned", value))


# The menu of a panel: named sets of the module's parameters, to be kept and taken again.


class SetsMenu(Menu):
    """Filled when it is opened, from the files of the person's folder."""

    def __init__(self, of: PanelNode, folder: Path, button: QToolButton) -> None:
        super().__init__(button)
        self.setObjectName("sets.menu")
        self._session = of.session
        self._node = of.name
        self._folder = folder
        self.above: Sequence[QAction] = ()
        self.aboutToShow.connect(self.fill)

    def fill(self) -> None:
        """Offer the sets there are now, and a line to keep another."""
        self.clear()
        if self.above:
            self.addActions(list(self.above))
            self.addSeparator()
        node = self._session.network.nodes.get(self._node)
        if node is None:
            return
        sets: Sets = {}
        try:
            sets = sets_of(node.module, self._folder)
        except ImagechainError as error:
            self._session.message.emit("error", error.message)
        for name in sets:
            about = f"Give every parameter its value of {name}"
            offer(self, f"set.{name}", name, partial(self._take, name, sets), about=about)
        if sets:
            removing = Menu("Remove", self)
            self.addMenu(removing)
            removing.setObjectName("sets.remove")
            for name in sets:
                offer(removing, f"remove.{name}", name, partial(self._remove, name))
            self.addSeparator()
        self.addAction(self._keeping())

    def _keeping(self) -> QWidgetAction:
        edit, action = line_in_menu(self, "Save as", "set_name")
        edit.setPlaceholderText("name")
        edit.setAccessibleName("name to save these parameters under")
        edit.setToolTip("Press Enter to save the current parameters under this name")
        edit.returnPressed.connect(partial(self._keep, edit))
        return action

    def _keep(self, edit: QLineEdit) -> None:
        name = edit.text().strip()
        node = self._session.valued(self._node)
        self.close()
        try:
            save_set(name, node, self._folder)
        except ImagechainError as error:
            self._session.message.emit("error", f"not saved: {error}")
        else:
            self._session.message.emit("note", f"saved the parameters of {self._node} as {name}")

    def _take(self, name: str, sets: Sets) -> None:
        session = self._session
        declared, node = session.declared(self._node), session.network.nodes.get(self._node)
        if declared is None or node is None:
            return
        try:
            session.do(given(name, sets[name], node, declared, self._node))
        except ImagechainError as error:
            session.message.emit("error", str(error))

    def _remove(self, name: str) -> None:
        try:
            remove_set(name, self._session.network.nodes[self._node].module, self._folder)
        except ImagechainError as error:
            self._session.message.emit("error", str(error))


def add_sets_menu(button: QToolButton, of: PanelNode, folder: Path) -> SetsMenu:
    menu = SetsMenu(of, folder, button)
    button.setMenu(menu)
    button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return menu
