"""The menu of a field: what can be done with a parameter, beside editing its value."""

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QMenu, QWidget, QWidgetAction

from app.editor.declared_text import FreeNumber, choice_text, shown_number, shown_value
from app.editor.messages import told
from app.editor.session import Session
from app.editor.widgets import filled, without_argument
from core.editing.macros import expose, hide, rename_exposed
from core.editing.operations import Operation, exposed_as
from core.modules.parameters import Parameter
from core.network.macro import SEPARATOR

_ABOUT_FREE = (
    "A fit to a picture (the Fit dock) determines the free parameters. Parameters stay free "
    "while the network is open; this choice is not saved"
)
_SWITCH = {"on": True, "true": True, "yes": True, "off": False, "false": False, "no": False}


def offer(
    menu: QMenu, name: str, text: str, act: Callable[[], object], *, about: str = ""
) -> QAction:
    action = menu.addAction(text.replace("&", "&&"))
    action.setObjectName(name)
    if about:
        action.setToolTip(about)
    action.triggered.connect(partial(without_argument, act))
    return action


def chosen(parameter: Parameter, text: str) -> Any:
    """The choice, or the state of a switch, that a text names; the text where there is none."""
    if parameter.kind == "switch":
        return _SWITCH.get(text.lower(), text)
    options = (*parameter.choices, *((None,) if parameter.empty else ()))
    return next((one for one in options if text in (str(one), choice_text(one))), text)


def typed_text(parameter: Parameter, text: str) -> str:
    """What is to be typed for a text with a unit, which need not be one that can be typed."""
    text, unit = text.strip(), parameter.param.unit
    is_number = parameter.kind in ("number", "integer") and not text.startswith("=")
    return text.removesuffix(f" {unit}") if unit and is_number else text


def text_with_unit(parameter: Parameter, value: Any, unit: str) -> str:
    if parameter.kind in ("number", "integer") and type(value) in (int, float):
        return f"{shown_number(value)} {unit}".strip()
    return "" if value in ((), []) else shown_value(parameter, value)


def add_fit_action(menu: QMenu, session: Session, node: str, parameter: str) -> None:
    is_free = session.free.has(node, parameter)
    if not is_free and parameter in session.network.nodes[node].linked:
        return  # what it follows can be free
    menu.addSeparator()
    act: Callable[[], object] = partial(session.free.put, FreeNumber(node, parameter))
    name, text = "free", "Free for a fit"
    if is_free:
        act = partial(session.free.fix, node, parameter)
        name, text = "fix", "Fix (do not fit)"
    action = offer(menu, name, text, act, about=_ABOUT_FREE)
    action.setStatusTip(_ABOUT_FREE)
    menu.setToolTipsVisible(True)


def add_macro_actions(menu: QMenu, session: Session, node: str, parameter: str) -> None:
    """Add what a macro can do with a parameter of one of its nodes, or with one that it shows."""
    network = session.document.network
    value_of = session.resolved.value
    if session.network.nodes[node].macro is not None:
        menu.addSeparator()
        hiding = partial(hide, network, node, parameter, value_of)
        offer(menu, "hide", "Hide from this panel", partial(_do, session, hiding))
        menu.addAction(_naming(menu, session, node, parameter))
        return
    macro = node.removesuffix(SEPARATOR + session.local_name(node))
    if macro == node:  # in no macro
        return
    menu.addSeparator()
    name = exposed_as(network, node, parameter)
    act, begin = partial(expose, network, node, parameter), "Show on"
    if name:
        act, begin = partial(hide, network, macro, name, value_of), "Hide from"
    key = "hide" if name else "expose"
    offer(menu, key, f"{begin} the panel of {macro}", partial(_do, session, act))


def _do(session: Session, made: Callable[[], Operation]) -> None:
    with told(session.message.emit):
        session.do(made())


def _naming(menu: QMenu, session: Session, macro: str, name: str) -> QWidgetAction:
    edit, action = line_in_menu(menu, "Name", "exposed_name")
    edit.setText(name)
    edit.setAccessibleName(f"name of the parameter {name} on this panel")
    edit.setToolTip("Name of the parameter on this panel; press Enter to apply")

    def take() -> None:
        new = edit.text().strip()
        menu.close()
        if new != name:
            _do(session, lambda: rename_exposed(session.document.network, macro, name, new))

    edit.returnPressed.connect(take)
    action.setObjectName("rename_exposed")
    return action


def line_in_menu(menu: QMenu, text: str, name: str) -> tuple[QLineEdit, QWidgetAction]:
    """A line to type in that can be added to a menu, with a label of that text before it."""
    line = QWidget(menu)
    label, edit = QLabel(text, line), QLineEdit(line)
    edit.setObjectName(name)
    label.setBuddy(edit)
    filled(QHBoxLayout(line), label, (edit, 1), margins=(12, 2, 12, 2))
    line.setFocusProxy(edit)
    action = QWidgetAction(menu)
    action.setDefaultWidget(line)
    return edit, action
