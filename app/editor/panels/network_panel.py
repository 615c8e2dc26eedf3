"""The panel of the network as a whole, shown while no node is selected."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QFormLayout, QFrame, QLabel, QPlainTextEdit, QVBoxLayout, QWidget

from app.editor.declared_text import tip
from app.editor.panels.fields.type_in import TypeIn
from app.editor.panels.head import TitleBar
from app.editor.session import Session
from app.editor.theme import ERROR, FAINT, RAISED
from app.editor.widgets import filled, named, plain_label, show_or_hide
from core.editing.operations import set_network_field
from core.errors import ParameterError
from core.network.network import SEEDS, Network, check_seed


class NetworkPanel(QFrame):
    """Name, description and seed of the network, and how many nodes it has."""

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        named(self, "panel.network", "control panel of the network")
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
        """Show the document's text; what was typed is gone."""
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
    named(edit, name, accessible)
    return edit


def _many(things: object, word: str) -> str:
    number = len(things)  # type: ignore[arg-type]
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
