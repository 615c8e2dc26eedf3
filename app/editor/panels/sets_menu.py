"""The menu of a panel: named sets of the module's parameters, to be kept and taken again."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QToolButton,
    QWidget,
    QWidgetAction,
)

from app.editor.session import Session
from app.presets.parameter_sets import Sets, given, remove_set, save_set, sets_of
from core.errors import ImagechainError


class SetsMenu(QMenu):
    """Filled when it is opened, from the files of the person's folder.

    Parameters
    ----------
    session : Session
        The document.
    node : str
        The panel's node.
    folder : Path
        Where sets are kept.
    button : QToolButton
        What opens it.
    """

    def __init__(self, session: Session, node: str, folder: Path, button: QToolButton) -> None:
        super().__init__(button)
        self.setObjectName("sets.menu")
        self._session = session
        self._node = node
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
            action = self.addAction(name.replace("&", "&&"))
            action.setObjectName(f"set.{name}")
            action.setToolTip(f"Give every parameter its value of {name}")
            action.triggered.connect(partial(self._take, name, sets))
        if sets:
            removing = self.addMenu("Remove")
            removing.setObjectName("sets.remove")
            for name in sets:
                action = removing.addAction(name.replace("&", "&&"))
                action.setObjectName(f"remove.{name}")
                action.triggered.connect(partial(self._remove, name))
            self.addSeparator()
        self.addAction(self._keeping())

    def _keeping(self) -> QWidgetAction:
        line = QWidget(self)
        label = QLabel("Save as", line)
        edit = QLineEdit(line)
        edit.setObjectName("set_name")
        edit.setPlaceholderText("name")
        edit.setAccessibleName("name to save these parameters under")
        edit.setToolTip("Enter keeps the parameters as they are now under this name")
        edit.returnPressed.connect(partial(self._keep, edit))
        label.setBuddy(edit)
        row = QHBoxLayout(line)
        row.setContentsMargins(12, 2, 12, 2)
        row.addWidget(label)
        row.addWidget(edit, 1)
        line.setFocusProxy(edit)
        action = QWidgetAction(self)
        action.setDefaultWidget(line)
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

    def _take(self, name: str, sets: Sets, *_: object) -> None:
        session = self._session
        declared, node = session.declared(self._node), session.network.nodes.get(self._node)
        if declared is None or node is None:
            return
        try:
            session.do(given(name, sets[name], node, declared, self._node))
        except ImagechainError as error:
            session.message.emit("error", str(error))

    def _remove(self, name: str, *_: object) -> None:
        try:
            remove_set(name, self._session.network.nodes[self._node].module, self._folder)
        except ImagechainError as error:
            self._session.message.emit("error", str(error))


def add_sets_menu(button: QToolButton, session: Session, node: str, folder: Path) -> SetsMenu:
    """Have a button open the menu of a node's sets of parameters."""
    menu = SetsMenu(session, node, folder, button)
    button.setMenu(menu)
    button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return menu
