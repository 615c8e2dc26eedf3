"""What all fields have: node, label, unit, message, menu; and fields of choices and lists."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from PySide6 import QtWidgets
from PySide6.QtCore import QPoint, Qt, QTimer, SignalInstance
from PySide6.QtGui import QContextMenuEvent, QFontMetrics, QGuiApplication, QWheelEvent

from app.editor import declared_text, messages, widgets
from app.editor.evaluation.evaluator import Evaluator
from app.editor.panels.fields.type_in import NameLabel, TypeIn, discard_typing
from app.editor.session import FreeNumber, Session
from app.editor.theme import CHANGED, ERROR, FAINT, TEXT
from core.editing import macros
from core.editing.clipboard import copied_values, pasted_values
from core.editing.operations import ABSENT, Operation, exposed_as, named, set_parameter, together
from core.errors import ParameterError, thaw
from core.modules.parameters import Parameter, plain
from core.network.expressions import quoted
from core.network.macro import SEPARATOR
from core.records import dataclass

_CLICK_MS = 250  # after which a button is up again
_MOST_REASONS = 3


@dataclass(frozen=True)
class PanelNode:
    session: Session
    evaluator: Evaluator
    name: str
    trade_off_wanted: SignalInstance[Any]  # node, parameter
    view_wanted: SignalInstance[Any]  # node, port, viewer

    @property
    def is_there(self) -> bool:
        return self.name in self.session.network.nodes

    def do(self, operation: Operation, gesture: object = None) -> None:
        if self.is_there:
            self.session.do(operation, gesture=gesture)

    def put(self, parameter: str, value: object, gesture: object = None) -> None:
        """Give a value to the node, and to others selected with it; a gesture is one step."""
        alike = self.session.selected_alike
        names = alike if self.name in alike else (self.name,)
        steps = [set_parameter(name, parameter, value) for name in names]
        self.do(together(steps) if len(steps) > 1 else steps[0], gesture)

    def names_beside(self) -> list[str]:
        """The numbers of the nodes that lie in the same macro, as expressions name them."""
        session, names = self.session, []
        around = self.name.removesuffix(session.local_name(self.name))
        for name in session.network.nodes:
            local, declared = session.local_name(name), session.declared(name)
            for one in declared.parameters if declared and around + local == name else ():
                if one.kind in ("number", "integer"):
                    names.append(f"{quoted(local)}.{one.name}")
        return names


class FieldLink(NamedTuple):
    text: str
    value: Any
    problem: str = ""


class Field(QtWidgets.QWidget):
    """One parameter on a panel. Holds no value of its own: it shows the document's."""

    lines_up = False  # whether its unit stands in one column with those of others
    _faulty = False

    def __init__(self, parameter: Parameter, node: PanelNode, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent)
        self.parameter = parameter
        self.node = node
        self.value: Any = parameter.default
        self.stored = False
        self.link: FieldLink | None = None
        self.setObjectName(f"field.{parameter.name}")
        self.title = declared_text.label_of(parameter.name)
        self.setToolTip(declared_text.tip(f"{self.title}: {declared_text.about(parameter)}"))
        self.label = widgets.labelled(NameLabel(self.title, self), f"label.{parameter.name}")
        self.label.setTextFormat(Qt.TextFormat.PlainText)
        self.label.setSizePolicy(
            QtWidgets.QSizePolicy.Policy.Maximum, QtWidgets.QSizePolicy.Policy.Preferred
        )
        self.unit = widgets.plain_label(
            f"unit.{parameter.name}", self, parameter.param.unit, role=FAINT
        )
        self.unit.setWordWrap(False)
        self.message = widgets.plain_label(f"message.{parameter.name}", self, role=ERROR)
        self.message.hide()
        self.row = QtWidgets.QHBoxLayout()
        self.row.setSpacing(6)
        self.column = widgets.filled(
            QtWidgets.QVBoxLayout(self), self.row, margins=(0, 1, 0, 1), spacing=1
        )
        self.build()
        self.column.addWidget(self.message)
        self._mark_changed()

    @property
    def changed(self) -> bool:
        if self.link is not None:
            return True
        return not self.parameter.required and self.value != self.parameter.default

    @property
    def shown_value(self) -> str:
        unit = self.parameter.param.unit if self.value not in (None, (), "") else ""
        return f"{declared_text.shown_value(self.parameter, self.value)} {unit}".rstrip()

    @property
    def standing(self) -> str:
        """The value that the document has, in words; empty where it has none."""
        if self.link is not None:
            return "" if self.link.problem else f"= {self.link.text}"
        return "" if self.value is ... else self.shown_value

    def build(self) -> None:
        """Make the widgets that the value is shown in; every kind of field has its own."""
        raise NotImplementedError

    def show_value(self, value: Any) -> None:
        """Without a signal; every kind of field its own way."""
        raise NotImplementedError

    def line_up(self, label: int, unit: int, _room: int) -> None:
        """Take the width of the names, of the units, and the room between them."""
        self.label.column = label
        self.label.updateGeometry()
        if self.lines_up:
            self.unit.setFixedWidth(unit)

    @property
    def label_width(self) -> int:
        """What its name needs, in bold as once it is changed; 0 where no label has it."""
        if self.marked_label() is not self.label:
            return 0
        font = self.label.font()
        font.setBold(True)
        return QFontMetrics(font).horizontalAdvance(self.label.text()) + 2

    def named(self, widget: QtWidgets.QWidget, what: str = "", name: str = "") -> None:
        unit = f" in {self.parameter.param.unit}" if self.parameter.param.unit else ""
        widgets.labelled(
            widget, f"{name or 'value'}.{self.parameter.name}", f"{self.title}{unit}{what}"
        )
        widget.setAccessibleDescription(declared_text.about(self.parameter))
        widget.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)  # the field has one

    def follow(self, raw: Any) -> None:
        """Show what the document has; ABSENT is the default."""
        self.stored, self.link = raw is not ABSENT, None
        self._show_problem("")
        self.value = self.parameter.default
        if self.stored:
            try:
                self.value = self.parameter.coerce(thaw(raw))
            except ParameterError as error:
                self.show_unfit(str(raw))
                self.refuse(error.message)
                return
        self._settle()

    def follow_link(self, link: FieldLink) -> None:
        self.stored, self.link = True, link
        self._show_problem("")
        if not link.problem:
            self.value = self.parameter.coerce(link.value)
        self._settle()
        if link.problem:
            self.refuse(link.problem)

    def offer(self, value: object, gesture: object = None) -> None:
        """Give a value to the document if it is allowed, else show why not."""
        try:
            self.put(plain(self.parameter.coerce(value)), gesture)
        except ParameterError as error:
            self.refuse_typed(error)

    def put(self, raw: object, gesture: object = None) -> None:
        self._show_problem("")
        self.node.put(self.parameter.name, raw, gesture)
        self._settle()

    def show_unfit(self, text: str) -> None:
        """Show what the document has but may not have."""

    def refuse(self, problem: str) -> None:
        self._show_problem(problem)

    def refuse_typed(self, error: ParameterError) -> None:
        """Show why what was typed is not taken, and which value counts."""
        still = f" (still {self.standing})" if self.standing else ""
        self.refuse(error.message + still)

    def show_free(self, on: bool) -> None:
        self.label.setText(f"{self.title} · free" if on else self.title)

    def take(self, text: str) -> None:
        """Take the choice or the state of a switch that a text names, else the text itself."""
        if self.parameter.kind == "switch":
            self.offer(_SWITCH.get(text.lower(), text))
            return
        options = choices_of(self.parameter)
        named = (one for one in options if text in (str(one), declared_text.choice_text(one)))
        self.offer(next(named, text))

    def restore(self) -> None:
        self._show_problem("")
        self._settle()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        self.open_menu(event.globalPos())
        event.accept()

    def open_menu(self, at: QPoint) -> None:
        edit = self.focusWidget()
        if isinstance(edit, TypeIn) and edit.hasFocus():
            menu: QtWidgets.QMenu = edit.createStandardContextMenu()
            menu.setParent(self, menu.windowFlags())
            menu.addSeparator()
        else:
            menu = widgets.Menu(self)
        menu.setObjectName("field.menu")
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._fill(menu)
        menu.popup(at)

    def _fill(self, menu: QtWidgets.QMenu) -> None:
        parameter, node = self.parameter, self.node
        if parameter.kind in ("number", "integer"):
            trade_off = partial(node.trade_off_wanted.emit, node.name, parameter.name)
            about = "Plot figures of merit against this parameter"
            widgets.offer(menu, "trade_off", "Trade off…", trade_off, about=about)
            self.add_link_actions(menu)
        default = ""
        if not parameter.required:
            unit = f" {parameter.param.unit}" if parameter.param.unit else ""
            default = f" ({declared_text.shown_value(parameter, parameter.default)}{unit})"
        widgets.offer(menu, "reset", f"Reset to default{default}", self._reset).setEnabled(
            self.stored
        )
        menu.addSeparator()
        clipboard, copied = QGuiApplication.clipboard(), self.copied_text
        about = "Copy the value with its unit, or the expression of a linked value"
        copying = partial(clipboard.setText, copied)
        action = widgets.offer(menu, "copy_value", "Copy value", copying, about=about)
        action.setEnabled(bool(copied))
        about = "Paste a value in any compatible unit"
        pasting = partial(self._paste, clipboard.text())
        action = widgets.offer(menu, "paste_value", "Paste value", pasting, about=about)
        action.setEnabled(bool(clipboard.text().strip()))
        if node.is_there:
            if parameter.kind == "number":
                add_fit_action(menu, node.session, node.name, parameter.name)
            add_macro_actions(menu, node.session, node.name, parameter.name)

    @property
    def copied_text(self) -> str:
        if self.link is not None:
            return f"= {self.link.text}"
        parameter, value = self.parameter, self.value
        if parameter.kind in ("number", "integer") and type(value) in (int, float):
            return f"{declared_text.shown_number(value)} {parameter.param.unit}".strip()
        return "" if value in (None, (), []) else declared_text.shown_value(parameter, value)

    def _paste(self, text: str) -> None:
        """Take a text with a unit, which need not be one that can be typed."""
        discard_typing(self)
        text, unit = text.strip(), self.parameter.param.unit
        is_number = self.parameter.kind in ("number", "integer") and not text.startswith("=")
        self.take(text.removesuffix(f" {unit}") if unit and is_number else text)

    def _reset(self) -> None:
        discard_typing(self)
        self.node.put(self.parameter.name, ABSENT)

    def add_link_actions(self, menu: QtWidgets.QMenu) -> None:
        """Offer to follow other parameters, or to stop; only of numbers."""

    def _settle(self) -> None:
        self.show_value(self.value)
        self._mark_changed()

    def mark_faulty(self, on: bool) -> None:
        """Its name is red while the node's error is about it."""
        self._faulty = on
        self._mark_changed()

    def _mark_changed(self) -> None:
        label = self.marked_label()
        font = label.font()
        if font.bold() != self.changed:
            font.setBold(self.changed)
            label.setFont(font)
        widgets.set_role(label, ERROR if self._faulty else CHANGED if self.changed else TEXT)

    def marked_label(self) -> QtWidgets.QWidget:
        return self.label

    def _show_problem(self, text: str) -> None:
        if text == self.message.text():
            return
        if any(edit.is_left_by_mouse for edit in self.findChildren(TypeIn)):
            # What the mouse has just pressed would slide away below it.
            QTimer.singleShot(_CLICK_MS, self, partial(widgets.show_or_hide, self.message, text))
        else:
            widgets.show_or_hide(self.message, text)


class TextField(Field):
    edit: TypeIn

    def build(self) -> None:
        edit = self.build_edit()
        if self.parameter.empty:
            edit.setPlaceholderText("empty")
        widgets.filled(self.row, self.label, (edit, 1), self.unit)

    def build_edit(self, *, steps: bool = False) -> TypeIn:
        self.edit = TypeIn(self, steps=steps)
        self.named(self.edit)
        self.edit.committed.connect(self.take)
        self.edit.given_up.connect(self.restore)
        self.label.setBuddy(self.edit)
        return self.edit

    def show_value(self, value: Any) -> None:
        self.edit.show_text("" if value is None else str(value))

    def take(self, text: str) -> None:
        self.offer(text)

    def show_unfit(self, text: str) -> None:
        self.edit.show_text(text)

    def refuse(self, problem: str) -> None:
        super().refuse(problem)
        self.edit.mark()


MOST_BUTTONS = 4
MOST_LETTERS = 16


def choices_of(parameter: Parameter) -> tuple[Any, ...]:
    return ((None,) if parameter.empty else ()) + parameter.choices


class ButtonsField(Field):
    def build(self) -> None:
        self.choices = choices_of(self.parameter)
        flow = widgets.filled(widgets.FlowLayout(across=6, down=2), self.label)
        self.row.addLayout(flow, 1)
        self.row.addWidget(self.unit)
        self.unit.setVisible(bool(self.parameter.param.unit))
        self.group = QtWidgets.QButtonGroup(self)
        self.buttons: list[widgets.Radio] = []
        for number, choice in enumerate(self.choices):
            button = widgets.Radio(declared_text.choice_text(choice), self)
            self.named(button, f": {declared_text.choice_text(choice)}", f"choice.{choice}")
            self.group.addButton(button, number)
            self.buttons.append(button)
            flow.addWidget(button)
        self.label.setMinimumHeight(self.buttons[0].sizeHint().height())
        self._offered = self.choices
        self.group.idToggled.connect(self._toggled)

    def show_value(self, value: Any) -> None:
        if value in self.choices:
            button = self.buttons[self.choices.index(value)]
            self.group.blockSignals(True)
            button.setChecked(True)
            self.group.blockSignals(False)
        self._show_offered()

    def narrow(self, offered: tuple[Any, ...]) -> None:
        self._offered = offered
        self._show_offered()

    def _show_offered(self) -> None:
        for choice, button in zip(self.choices, self.buttons, strict=True):
            button.setVisible(choice in self._offered or choice == self.value)

    def _toggled(self, number: int, on: bool) -> None:
        if on:
            self.offer(self.choices[number])


class ChoiceBox(QtWidgets.QComboBox):
    """A list that the wheel scrolls past, unless it has the focus."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        if widgets.takes_wheel(self):
            super().wheelEvent(event)
        else:
            event.ignore()


class ListField(Field):
    def build(self) -> None:
        self.choices = choices_of(self.parameter)
        self.box = ChoiceBox(self)
        self.box.addItems([declared_text.choice_text(choice) for choice in self.choices])
        self.box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.box.setSizeAdjustPolicy(
            QtWidgets.QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon
        )
        longest = max(len(self.box.itemText(n)) for n in range(self.box.count()))
        self.box.setMinimumContentsLength(min(longest, MOST_LETTERS))
        self.box.setSizePolicy(
            QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed
        )
        self.named(self.box)
        self.label.setBuddy(self.box)
        self.box.activated.connect(lambda number: self.offer(self.choices[number]))
        widgets.filled(self.row, self.label, (self.box, 1), self.unit)
        self.lines_up = bool(self.parameter.param.unit)
        self.unit.setVisible(self.lines_up)

    def show_value(self, value: Any) -> None:
        if value in self.choices:
            self.box.setCurrentIndex(self.choices.index(value))


class SwitchField(Field):
    def build(self) -> None:
        self.box = widgets.Check(self.title, self)
        self.named(self.box)
        self.box.clicked.connect(lambda: self.offer(self.box.isChecked()))
        self.label.hide()
        self.unit.hide()
        self.row.addWidget(self.box)
        self.row.addStretch()

    def marked_label(self) -> QtWidgets.QWidget:
        return self.box

    def show_value(self, value: Any) -> None:
        self.box.setChecked(bool(value))


class NumbersField(TextField):
    def build(self) -> None:
        super().build()
        self.edit.setPlaceholderText("none: type numbers, such as 0, 0.1")

    def show_value(self, value: Any) -> None:
        self.edit.show_text(declared_text.shown_numbers(value or ()))

    def take(self, text: str) -> None:
        try:
            numbers = declared_text.numbers_of(text, self.parameter)
        except ParameterError as error:
            self.refuse_typed(error)
            return
        self.offer(numbers)


# What can be done with a parameter beside editing its value: the menu of its field.

_ABOUT_FREE = (
    "A fit to a picture (the Fit dock) determines the free parameters. Parameters stay free "
    "while the network is open; this choice is not saved"
)
_SWITCH = {"on": True, "true": True, "yes": True, "off": False, "false": False, "no": False}


def add_fit_action(menu: QtWidgets.QMenu, session: Session, node: str, parameter: str) -> None:
    is_free = (node, parameter) in [one.place for one in session.free]
    if not is_free and parameter in session.network.nodes[node].linked:
        return  # what it follows can be free
    menu.addSeparator()
    act: Callable[[], object] = partial(session.make_free, FreeNumber(node, parameter))
    name, text = "free", "Free for a fit"
    if is_free:
        act = partial(session.fix, node, parameter)
        name, text = "fix", "Fix (do not fit)"
    action = widgets.offer(menu, name, text, act, about=_ABOUT_FREE)
    action.setStatusTip(_ABOUT_FREE)
    menu.setToolTipsVisible(True)


def add_macro_actions(menu: QtWidgets.QMenu, session: Session, node: str, parameter: str) -> None:
    """Add what a macro can do with a parameter of one of its nodes, or with one that it shows."""
    network = session.document.network
    value_of = session.resolved.value
    if session.network.nodes[node].macro is not None:
        menu.addSeparator()
        hiding = partial(macros.hide, network, node, parameter, value_of)
        widgets.offer(menu, "hide", "Hide from this panel", partial(_do, session, hiding))
        menu.addAction(_naming(menu, session, node, parameter))
        return
    macro = node.removesuffix(SEPARATOR + session.local_name(node))
    if macro == node:  # in no macro
        return
    menu.addSeparator()
    name = exposed_as(network, node, parameter)
    act, begin = partial(macros.expose, network, node, parameter), "Show on"
    if name:
        act, begin = partial(macros.hide, network, macro, name, value_of), "Hide from"
    key = "hide" if name else "expose"
    widgets.offer(menu, key, f"{begin} the panel of {macro}", partial(_do, session, act))


def _do(session: Session, made: Callable[[], Operation]) -> None:
    with messages.told(session.message.emit):
        session.do(made())


def _naming(
    menu: QtWidgets.QMenu, session: Session, macro: str, name: str
) -> QtWidgets.QWidgetAction:
    edit, action = widgets.line_in_menu(menu, "Name", "exposed_name")
    edit.setText(name)
    edit.setAccessibleName(f"name of the parameter {name} on this panel")
    edit.setToolTip("Name of the parameter on this panel; press Enter to apply")

    def take() -> None:
        new = edit.text().strip()
        menu.close()
        if new != name:
            _do(session, lambda: macros.rename_exposed(session.document.network, macro, name, new))

    edit.returnPressed.connect(take)
    action.setObjectName("rename_exposed")
    return action


def copy_values(session: Session, names: Sequence[str]) -> None:
    """Put the values of the last of these nodes on the clipboard, as JSON text."""
    for name in names[-1:]:
        text = copied_values(session.network.nodes[name], session.declared(name))
        QGuiApplication.clipboard().setText(text)
        session.message.emit("note", f"copied the values of {name}")


def paste_values(session: Session, names: Sequence[str]) -> None:
    """Give nodes the clipboard's values, as one step; what is left out is said in one line."""
    text = QGuiApplication.clipboard().text()
    with messages.told(session.message.emit, "no values were pasted: "):
        operation, left_out = pasted_values(text, names, session.declared)
        session.do(operation)
        text = f"pasted values into {named(names)}"
        if left_out:
            more = len(left_out) - _MOST_REASONS
            reasons = "; ".join(left_out[:_MOST_REASONS])
            text += f"; left out: {reasons}{f'; and {more} more' if more > 0 else ''}"
        session.message.emit("note", text)
