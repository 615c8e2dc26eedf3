"""The panels that are open: of the network, the node selected last, and those that are pinned."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from PySide6 import QtWidgets
from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QFocusEvent, QResizeEvent

from app.editor import declared_text, messages, theme, widgets
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Badge
from app.editor.panels.fields.field import PanelNode, copy_values, paste_values
from app.editor.panels.fields.type_in import TypeIn, discard_typing
from app.editor.panels.head import PanelHead, TitleBar
from app.editor.panels.module_body import ModuleBody, UnknownBody
from app.editor.panels.preview_view import PreviewView, preview_query
from app.editor.session import Session, followed_name, renamed_node
from app.run.preset_files import Sets, given, remove_set, save_set, sets_of
from core.editing import operations
from core.errors import ImagechainError, ParameterError, several
from core.modules.declaration import where_absent
from core.network.macro import SEPARATOR
from core.network.network import MACRO, SEEDS, Network, check_seed


class PanelArea(widgets.WheelScrollArea):
    """A stack of panels that scrolls.

    `illustrations` has the modules whose illustration the person has folded away, or unfolded: of
    those with a transfer function, which stands among the curves, it is folded at first.
    """

    illustrations_changed = Signal(object)  # (illustrations)
    view_wanted = Signal(str, str, int)  # node, port, viewer: show that output in that viewer
    trade_off_wanted = Signal(str, str)  # node, parameter: show figures of merit as it moves
    generate_wanted = Signal()  # compute everything
    handbook_wanted = Signal(str)  # node: the page of its module is to be opened
    named = Signal()  # Enter in the name: the keyboard goes back to the canvas

    def __init__(self, session: Session, evaluator: Evaluator) -> None:
        super().__init__()
        widgets.labelled(self, "panels", "control panels")
        self.setFrameShape(QtWidgets.QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        # A bar that comes and goes would move the buttons of the heads.
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        self._session = session
        self.evaluator = evaluator
        self.illustrations: frozenset[str] = frozenset()
        self._badges: Mapping[str, Badge] = {}
        self.panels: dict[str, NodePanel] = {}
        self.sets_folder: Path | None = None
        content = QtWidgets.QWidget(self)
        self._column = widgets.filled(
            QtWidgets.QVBoxLayout(content), margins=(2, 2, 2, 2), spacing=6
        )
        self.network_panel = NetworkPanel(session, content)
        self._column.addWidget(self.network_panel)
        self._column.addStretch(1)
        self.setWidget(content)
        session.opened.connect(self._opened)
        session.changed.connect(self._changed)
        session.selection_changed.connect(self._selected)
        self._arrange(session.selection)

    def sizeHint(self) -> QSize:
        unit = self.fontMetrics().averageCharWidth()
        return QSize(52 * unit, 80 * unit)

    def set_badges(self, badges: Any) -> None:
        self._badges = badges
        for name, panel in self.panels.items():
            panel.set_badge(badges.get(name))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        for panel in self.panels.values():
            panel.head.fit(self.viewport().height())

    def illustrate(self, module: str, on: bool) -> None:
        self.illustrations ^= {module}
        for panel in self.panels.values():
            if panel.module == module:
                panel.head.show_illustration(on)
        self.illustrations_changed.emit(self.illustrations)

    def edit_name(self) -> None:
        panel = self.panels.get(next(iter(self._session.selection[-1:]), ""))
        if panel is not None:
            panel.head.bar.fold.setChecked(False)
            panel.head.name.setFocus(Qt.FocusReason.OtherFocusReason)
            panel.head.name.selectAll()
            self.ensureWidgetVisible(panel.head.name)

    def finish_typing(self) -> None:
        self.network_panel.finish_typing()
        for panel in tuple(self.panels.values()):
            panel.finish_typing()

    def _opened(self) -> None:
        for name in tuple(self.panels):
            self._drop(name)
        self._badges = {}
        self.network_panel.discard_typing()
        self._arrange(self._session.selection)

    def _changed(self, before: Any, after: Any) -> None:
        self.network_panel.follow(after)
        selection = self._session.selection
        renamed = renamed_node(before, after)
        old, new = renamed or ("", "")
        selection = tuple(followed_name(name, renamed) for name in selection)
        selection = tuple(name for name in selection if name in after.nodes)
        former = self.panels.get(old)
        typing = former is not None and former.head.name.hasFocus()
        for name, panel in tuple(self.panels.items()):
            node = after.nodes.get(name)
            other = node is None or node.module != panel.module
            if other or (node.macro and self._session.declared(name) != panel.declared):
                self._drop(name)
            else:
                panel.follow(before, after)
        self._arrange(selection)
        if former is not None and new in self.panels:
            self.panels[new].head.bar.fold.setChecked(former.head.bar.fold.isChecked())
            if typing:
                self.panels[new].head.name.setFocus(Qt.FocusReason.OtherFocusReason)

    def _selected(self, names: tuple[str, ...]) -> None:
        for name in self._unwanted(names):
            self.panels[name].finish_typing()
        self._arrange(names)
        if names:
            self.verticalScrollBar().setValue(0)

    def _arrange(self, selection: tuple[str, ...]) -> None:
        for name in self._unwanted(selection):
            self._drop(name)
        wanted = self._wanted(selection)
        self.network_panel.setVisible(not selection)
        for place, name in enumerate(wanted, start=1):
            panel = self.panels.get(name) or self._make(name)
            if self._column.indexOf(panel) != place:
                self._column.insertWidget(place, panel)

    def _wanted(self, selection: tuple[str, ...]) -> list[str]:
        """The node selected last, then those that are pinned."""
        nodes = self._session.network.nodes
        pinned = [name for name, node in nodes.items() if node.extra.get("pinned") is True]
        return [name for name in dict.fromkeys((*selection[-1:], *pinned)) if name in nodes]

    def _unwanted(self, selection: tuple[str, ...]) -> list[str]:
        wanted = self._wanted(selection)
        return [name for name in self.panels if name not in wanted]

    def _make(self, name: str) -> NodePanel:
        asked = self.trade_off_wanted, self.view_wanted
        of = PanelNode(self._session, self.evaluator, name, *asked)
        panel = NodePanel(of, self)
        panel.head.fit(self.viewport().height())
        panel.set_badge(self._badges.get(name))
        self.panels[name] = panel
        return panel

    def _drop(self, name: str) -> None:
        panel = self.panels.pop(name)
        discard_typing(panel)  # hiding takes the focus away, which would take what was typed
        self._column.removeWidget(panel)
        panel.hide()
        panel.deleteLater()

    def put_away(self, name: str) -> None:
        session = self._session
        if session.network.nodes[name].extra.get("pinned") is True:
            session.do(operations.set_node_field(name, "pinned", operations.ABSENT))
        if name in session.selection:
            session.select([other for other in session.selection if other != name])


class NetworkPanel(QtWidgets.QFrame):
    def __init__(self, session: Session, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent)
        widgets.labelled(self, "panel.network", "control panel of the network")
        self.setFrameShape(QtWidgets.QFrame.Shape.StyledPanel)
        self._session = session
        bar = TitleBar("Network", self)
        bar.setBackgroundRole(theme.RAISED)
        bar.setAutoFillBackground(True)
        bar.fold.hide()
        below = QtWidgets.QWidget(self)
        self.name = widgets.labelled(TypeIn(below), "network_name", "name of the network")
        self.name.setPlaceholderText("untitled")
        self.name.committed.connect(partial(self._set, "name"))
        about = "description of the network"
        self.description = widgets.labelled(Words(below), "network_description", about)
        self.description.committed.connect(partial(self._set, "description"))
        self.seed = widgets.labelled(TypeIn(below), "network_seed", "seed of the network's noise")
        about = f"The seed is {SEEDS}. The same seed gives the same noise"
        self.seed.setToolTip(declared_text.tip(about))
        self.seed.setAccessibleDescription(about)
        self.seed.committed.connect(self._set_seed)
        for edit in (self.name, self.seed):
            edit.given_up.connect(self._restore)
        self.seed_problem = widgets.plain_label("seed_problem", below, role=theme.ERROR)
        self.seed_problem.hide()
        self.count = widgets.plain_label("network_count", below)
        text = "Select a node to see its control panel here."
        hint = widgets.plain_label("network_hint", below, text, role=theme.FAINT)
        form = QtWidgets.QFormLayout(
            fieldGrowthPolicy=QtWidgets.QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow
        )
        form.setRowWrapPolicy(QtWidgets.QFormLayout.RowWrapPolicy.WrapLongRows)
        form.addRow("Name", self.name)
        form.addRow("Seed", self.seed)
        form.addRow(self.seed_problem)
        form.addRow("Contents", self.count)
        words = QtWidgets.QLabel("Description", below)
        words.setBuddy(self.description)
        widgets.filled(
            QtWidgets.QVBoxLayout(below), form, words, self.description, hint, margins=(8, 4, 8, 8)
        )
        widgets.filled(QtWidgets.QVBoxLayout(self), bar, below)
        self.follow(session.network)

    def follow(self, network: Network) -> None:
        self.name.show_text(network.name)
        self.description.show_text(network.description)
        if not self.seed.unsettled or self.seed.text() == str(network.seed):
            self._show_seed(network)
        nodes, wires = several(len(network.nodes), "node"), several(len(network.links), "wire")
        self.count.setText(f"{nodes}, {wires}")

    def finish_typing(self) -> None:
        for edit in (self.name, self.description, self.seed):
            edit.commit()

    def discard_typing(self) -> None:
        self.description.document().setModified(False)
        self._restore()

    def _restore(self) -> None:
        self._show_seed(self._session.network)
        self.follow(self._session.network)

    def _show_seed(self, network: Network) -> None:
        self.seed.show_text(str(network.seed))
        widgets.show_or_hide(self.seed_problem, "")

    def _set(self, field: str, value: object) -> None:
        self._session.do(operations.set_network_field(field, value))
        self.follow(self._session.network)

    def _set_seed(self, text: str) -> None:
        typed = text.strip()
        seed = int(typed) if typed.isdecimal() and len(typed) < 400 else typed
        try:
            check_seed(seed)
        except ParameterError as error:
            widgets.show_or_hide(self.seed_problem, error.message)
            self.seed.mark()
            return
        self.seed.setModified(False)
        self._set("seed", seed)


class Words(QtWidgets.QPlainTextEdit):
    """Several lines of text, taken when the focus leaves."""

    committed = Signal(str)

    def __init__(self, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent, tabChangesFocus=True)
        self.setMinimumHeight(self.fontMetrics().height() * 5)

    def show_text(self, text: str) -> None:
        if text != self.toPlainText() or self.document().isUndoAvailable():
            self.setPlainText(text)
        self.document().setModified(False)

    def commit(self) -> None:
        if self.document().isModified():
            self.committed.emit(self.toPlainText())

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() != Qt.FocusReason.PopupFocusReason:
            self.commit()


class NodePanel(QtWidgets.QFrame):
    """Head and body of a node's panel, which holds no part of the document itself."""

    def __init__(self, of: PanelNode, area: PanelArea) -> None:
        super().__init__(area.widget())
        self._of, self._area, self._session = of, area, of.session
        session, node = of.session, of.name
        self.setFrameShape(QtWidgets.QFrame.Shape.StyledPanel)
        self.node = node
        self._local_name = session.local_name(node)
        self.module = session.network.nodes[node].module
        declared = self.declared = session.declared(node)
        title = declared.title if declared is not None else self.module
        widgets.labelled(self, f"panel.{node}", f"control panel of {node}: {title}")
        self.body: ModuleBody | UnknownBody
        if declared is not None:
            self.head = PanelHead(title, declared.group, declared.text, self)
            self.head.output.setVisible(operations.has_picture(declared))
            module = session.library.get(declared.key)  # a macro is of none
            query = preview_query(module, node) if module is not None else None
            if query is not None:
                preview = PreviewView(session, of.evaluator, node, self.head.place)
                at_first = getattr(query, "part", "") != "mtf"  # which stands among the curves
                self.head.illustrate(preview, shown=at_first != (self.module in area.illustrations))
            self.body = ModuleBody(declared, of, self)
        else:
            self.head = PanelHead(title, "", "", self)
            why = where_absent(self.module, session.library)
            self.body = UnknownBody(self.module, node, why, self)
            for button in (self.head.auto, self.head.disable, self.head.generate, self.head.output):
                button.setEnabled(False)
        widgets.filled(QtWidgets.QVBoxLayout(self), self.head, self.body, spacing=0)
        keeps = area.sets_folder is not None and declared is not None and declared.key != MACRO
        self.head.sets.setVisible(keeps and bool(declared and declared.parameters))
        self._connect()
        if area.sets_folder is not None:
            self.sets_menu = sets_menu(
                of, area.sets_folder, self.head.sets, self.head.bar.actions()
            )
        self.follow(None, session.network)

    def _connect(self) -> None:
        head, area = self.head, self._area
        head.bar.folded.connect(self._fold)
        head.pin.clicked.connect(
            lambda: self._set("pinned", head.pin.isChecked() or operations.ABSENT)
        )
        head.fold_picture.clicked.connect(self._fold_picture)
        head.close_button.clicked.connect(lambda: area.put_away(self.node))
        head.name.committed.connect(self._rename)
        head.name.returnPressed.connect(self._leave_name)  # after it is taken, or refused
        head.name.given_up.connect(self._show_name)
        head.auto.clicked.connect(lambda: self._set("auto", head.auto.isChecked()))
        head.disable.clicked.connect(lambda: self._set("disabled", head.disable.isChecked()))
        head.output.clicked.connect(self._mark_output)
        head.generate.clicked.connect(lambda *_: area.generate_wanted.emit())
        head.more.linkActivated.connect(lambda _: area.handbook_wanted.emit(self.node))
        copying, pasting = (partial(self._with_values, act) for act in (copy_values, paste_values))
        widgets.offer(head.bar, "copy_values", "Copy values", copying)
        widgets.offer(head.bar, "paste_values", "Paste values", pasting)

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
            for field in self.body.sections.fields:
                field.mark_faulty(badge is not None and field.parameter.name in badge.parameters)
            self.body.readouts.set_held_back(badge is not None and badge.kind == "stale")

    def finish_typing(self) -> None:
        for edit in self.findChildren(TypeIn):
            edit.commit()

    def _fold(self, on: bool) -> None:
        self.head.below.setVisible(not on)
        self.body.setVisible(not on)

    def _fold_picture(self) -> None:
        shown = not self.head.fold_picture.isChecked()
        self._area.illustrate(self.module, shown)

    def _with_values(self, act: Callable[[Session, tuple[str, ...]], None]) -> None:
        self.finish_typing()
        if self._of.is_there:
            act(self._session, (self.node,))

    def _rename(self, text: str) -> None:
        node = self._session.network.nodes.get(self.node)
        if node is None or text == self._local_name:
            self._show_name()
            return
        try:
            self._session.check(operations.rename_node(self.node, text))
        except ImagechainError as error:
            self.head.show_name_error(error.message)
        else:
            self._session.do(operations.rename_node(self.node, text))

    def _leave_name(self) -> None:
        if not self.head.name.marked:
            self._area.named.emit()

    def _show_name(self) -> None:
        self.head.name.show_text(self._local_name)
        self.head.show_name_error("")

    def _mark_output(self) -> None:
        session = self._session
        if self._of.is_there:
            session.do(operations.output_toggled(session.network, session.library, self.node))

    def _set(self, name: str, value: object) -> None:
        self._of.do(operations.set_node_field(self.node, name, value))


def sets_menu(
    of: PanelNode, folder: Path, button: QtWidgets.QToolButton, above: Sequence[QAction]
) -> widgets.Menu:
    """A button's menu of the sets of parameters in the person's folder, read when it is opened."""
    session, name = of.session, of.name
    menu = widgets.labelled(widgets.Menu(button), "sets.menu")
    button.setMenu(menu)
    button.setPopupMode(QtWidgets.QToolButton.ToolButtonPopupMode.InstantPopup)
    told = partial(messages.told, session.message.emit)

    def fill() -> None:
        menu.clear()
        menu.addActions(list(above))
        menu.addSeparator()
        if not of.is_there:
            return
        sets: Sets = {}
        with told():
            sets = sets_of(session.network.nodes[name].module, folder)
        for one in sets:
            about = f"Set every parameter to its value in {one}"
            widgets.offer(menu, f"set.{one}", one, partial(take, one, sets), about=about)
        if sets:
            removing = widgets.Menu("Remove", menu)
            menu.addMenu(removing)
            removing.setObjectName("sets.remove")
            for one in sets:
                widgets.offer(removing, f"remove.{one}", one, partial(remove, one))
            menu.addSeparator()
        edit, action = widgets.line_in_menu(menu, "Save as", "set_name")
        edit.setPlaceholderText("name")
        edit.setAccessibleName("name to save these parameters under")
        edit.setToolTip("Press Enter to save the current parameters under this name")
        edit.returnPressed.connect(lambda: keep(edit.text().strip()))
        menu.addAction(action)

    def keep(new: str) -> None:
        menu.close()
        with told("not saved: "):
            save_set(new, session.valued(name), folder)
            session.message.emit("note", f"saved the parameters of {name} as {new}")

    def take(one: str, sets: Sets) -> None:
        declared, node = session.declared(name), session.network.nodes.get(name)
        if declared is not None and node is not None:
            with told():
                session.do(given(one, sets[one], node, declared, name))

    def remove(one: str) -> None:
        with told():
            remove_set(one, session.network.nodes[name].module, folder)

    menu.aboutToShow.connect(fill)
    return menu
