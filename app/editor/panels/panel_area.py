"""The panels that are open: of the network, the node selected last, and those that are pinned."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QFormLayout, QFrame, QLabel, QPlainTextEdit, QVBoxLayout, QWidget

from app.editor.declared_text import tip
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Badge
from app.editor.panels.fields.panel_node import PanelNode, Requests
from app.editor.panels.fields.type_in import TypeIn
from app.editor.panels.head import TitleBar
from app.editor.panels.node_panel import NodePanel
from app.editor.session import Session, followed_name, renamed_node
from app.editor.theme import ERROR, FAINT, RAISED
from app.editor.widgets import WheelScrollArea, filled, labelled, plain_label, show_or_hide
from core.editing.operations import ABSENT, set_network_field, set_node_field
from core.errors import ParameterError
from core.network.network import SEEDS, Network, check_seed


class PanelArea(WheelScrollArea):
    """A stack of panels that scrolls.

    `illustrations` has the modules whose illustration the person has folded away, or unfolded: of
    those with a transfer function, which stands among the curves, it is folded at first.
    """

    illustrations_changed = Signal(object)  # (illustrations)

    def __init__(
        self, session: Session, evaluator: Evaluator | None, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        labelled(self, "panels", "control panels")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._session = session
        self._evaluator = evaluator
        self.requests = Requests(self)
        self.requests.close.connect(self._close)
        self.requests.illustrated.connect(self._illustrate)
        self.illustrations: frozenset[str] = frozenset()
        self._badges: Mapping[str, Badge] = {}
        self.panels: dict[str, NodePanel] = {}
        self.sets_folder: Path | None = None
        content = QWidget(self)
        self._column = filled(QVBoxLayout(content), margins=(2, 2, 2, 2), spacing=6)
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

    def _illustrate(self, module: str, on: bool) -> None:
        self.illustrations ^= {module}
        for panel in self.panels.values():
            if panel.module == module:
                panel.head.show_illustration(on)
        self.illustrations_changed.emit(self.illustrations)

    def edit_name(self) -> None:
        panel = self.panels.get(next(iter(self._session.selection[-1:]), ""))
        if panel is not None:
            panel.edit_name()
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
        successor = self.panels.get(old)
        typing = successor is not None and successor.head.name.hasFocus()
        folded = successor is not None and successor.folded
        for name, panel in tuple(self.panels.items()):
            node = after.nodes.get(name)
            if node is None or node.module != panel.module or self._shows_other(name, panel):
                self._drop(name)
            else:
                panel.follow(before, after)
        self._arrange(selection)
        if new in self.panels:
            self.panels[new].folded = folded
            if typing:
                self.panels[new].head.name.setFocus(Qt.FocusReason.OtherFocusReason)

    def _shows_other(self, name: str, panel: NodePanel) -> bool:
        """Whether a macro shows other ports or parameters than its panel."""
        macro = self._session.network.nodes[name].macro
        return macro is not None and self._session.declared(name) != panel.declared

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
        of = PanelNode(self._session, name, self.requests)
        panel = NodePanel(
            of, self._evaluator, self.widget(), self.sets_folder, illustrations=self.illustrations
        )
        panel.head.fit(self.viewport().height())
        panel.set_badge(self._badges.get(name))
        self.panels[name] = panel
        return panel

    def _drop(self, name: str) -> None:
        panel = self.panels.pop(name)
        panel.discard_typing()  # hiding takes the focus away, which would take what was typed
        self._column.removeWidget(panel)
        panel.hide()
        panel.deleteLater()

    def _close(self, name: str) -> None:
        session = self._session
        if session.network.nodes[name].extra.get("pinned") is True:
            session.do(set_node_field(name, "pinned", ABSENT))
        if name in session.selection:
            session.select([other for other in session.selection if other != name])


class NetworkPanel(QFrame):
    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        labelled(self, "panel.network", "control panel of the network")
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._session = session
        self.bar = TitleBar("Network", self)
        self.bar.setBackgroundRole(RAISED)
        self.bar.setAutoFillBackground(True)
        self.bar.fold.hide()
        self.below = QWidget(self)
        self._build()
        filled(QVBoxLayout(self), self.bar, self.below)
        self.follow(session.network)

    def _build(self) -> None:
        self.name = _named(TypeIn(self.below), "network_name", "name of the network")
        self.name.setPlaceholderText("untitled")
        self.name.committed.connect(self._set_name)
        self.name.given_up.connect(self._restore)
        self.description = Words(self.below)
        self.description.setObjectName("network_description")
        self.description.setAccessibleName("description of the network")
        self.description.committed.connect(self._set_description)
        self.description.given_up.connect(self._restore)
        self.seed = _named(TypeIn(self.below), "network_seed", "seed of the network's noise")
        about = f"The same seed gives the same noise: {SEEDS}"
        self.seed.setToolTip(tip(about))
        self.seed.setAccessibleDescription(about)
        self.seed.committed.connect(self._set_seed)
        self.seed.given_up.connect(self._restore)
        self.seed_problem = plain_label("seed_problem", self.below, role=ERROR)
        self.seed_problem.hide()
        self.count = plain_label("network_count", self.below)
        text = "Select a node to see its control panel here."
        hint = plain_label("network_hint", self.below, text, role=FAINT)
        form = QFormLayout()
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        form.addRow("Name", self.name)
        form.addRow("Seed", self.seed)
        form.addRow(self.seed_problem)
        form.addRow("Contents", self.count)
        words = QLabel("Description", self.below)
        words.setBuddy(self.description)
        filled(QVBoxLayout(self.below), form, words, self.description, hint, margins=(8, 4, 8, 8))

    def follow(self, network: Network) -> None:
        self.name.show_text(network.name)
        self.description.show_text(network.description)
        if not self.seed.unsettled or self.seed.text() == str(network.seed):
            self._show_seed(network)
        self.count.setText(f"{_many(network.nodes, 'node')}, {_many(network.links, 'wire')}")

    def finish_typing(self) -> None:
        for edit in (self.name, self.description, self.seed):
            edit.commit()

    def discard_typing(self) -> None:
        self.name.setModified(False)
        self.seed.setModified(False)
        self.description.document().setModified(False)
        self._restore()

    def _restore(self) -> None:
        self._show_seed(self._session.network)
        self.follow(self._session.network)

    def _show_seed(self, network: Network) -> None:
        self.seed.show_text(str(network.seed))
        self._show_problem("")

    def _show_problem(self, text: str) -> None:
        show_or_hide(self.seed_problem, text)

    def _set_name(self, text: str) -> None:
        self._session.do(set_network_field("name", text))
        self.name.show_text(self._session.network.name)

    def _set_description(self, text: str) -> None:
        self._session.do(set_network_field("description", text))
        self.description.show_text(self._session.network.description)

    def _set_seed(self, text: str) -> None:
        typed = text.strip()
        seed = int(typed) if typed.isdecimal() and len(typed) < 400 else typed
        try:
            check_seed(seed)
        except ParameterError as error:
            self._show_problem(error.message)
            self.seed.mark()
            return
        self._session.do(set_network_field("seed", seed))
        self._show_seed(self._session.network)


class Words(QPlainTextEdit):
    """Several lines of text, taken when the focus leaves or on Ctrl+Enter; Esc gives up."""

    committed = Signal(str)
    given_up = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTabChangesFocus(True)
        self.setMinimumHeight(self.fontMetrics().height() * 5)

    def show_text(self, text: str) -> None:
        if text != self.toPlainText() or self.document().isUndoAvailable():
            self.setPlainText(text)
        self.document().setModified(False)

    def commit(self) -> None:
        if self.document().isModified():
            self.committed.emit(self.toPlainText())

    def event(self, event: QEvent) -> bool:
        """Keep Esc and Ctrl+Enter where something is typed."""
        if not isinstance(event, QKeyEvent) or event.type() != QEvent.Type.ShortcutOverride:
            return super().event(event)
        if self.document().isModified() and self._ends(event):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not self._ends(event) or not self.document().isModified():
            super().keyPressEvent(event)
        elif event.key() == Qt.Key.Key_Escape:
            self.document().setModified(False)
            self.given_up.emit()
        else:
            self.commit()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() != Qt.FocusReason.PopupFocusReason:
            self.commit()

    def _ends(self, event: QKeyEvent) -> bool:
        enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
        control = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        return event.key() == Qt.Key.Key_Escape or (enter and control)


def _named(edit: TypeIn, name: str, accessible: str) -> TypeIn:
    labelled(edit, name, accessible)
    return edit


def _many(things: object, word: str) -> str:
    number = len(things)  # type: ignore[arg-type]
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
