"""What the menu of a field offers about macros: whether one shows the parameter, and its name."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QMenu, QWidget, QWidgetAction

from app.editor.session import Session
from core.editing.macros import expose, exposed_as, hide, rename_exposed
from core.editing.operations import Operation
from core.errors import ImagechainError
from core.network.macro import SEPARATOR


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
    line = QWidget(menu)
    label = QLabel("Name", line)
    edit = QLineEdit(name, line)
    edit.setObjectName("exposed_name")
    edit.setAccessibleName(f"name of the parameter {name} on this panel")
    edit.setToolTip("What the parameter is called on this panel; Enter takes it")
    label.setBuddy(edit)
    row = QHBoxLayout(line)
    row.setContentsMargins(12, 2, 12, 2)
    row.addWidget(label)
    row.addWidget(edit, 1)

    def take() -> None:
        new = edit.text().strip()
        menu.close()
        if new != name:
            network = session.document.network
            _do(session, partial(rename_exposed, network, macro, name, new))

    edit.returnPressed.connect(take)
    action = QWidgetAction(menu)
    action.setObjectName("rename_exposed")
    action.setDefaultWidget(line)
    return action
