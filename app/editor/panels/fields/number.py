"""Fields for numbers: type-in and slider."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu

from app.editor.declared_text import about, placeholder_of, shown_value, tip
from app.editor.number_text import shown_number
from app.editor.panels.fields.field import TypedField
from app.editor.panels.fields.slider import Slider
from app.editor.panels.fields.slider_scale import scale_of
from app.editor.theme import Theme, set_ink
from app.editor.typed_number import typed_number
from core.errors import ParameterError
from core.network.linked_values import expression

_HOW_TO_DRAG = "Drag its name sideways to change it: Shift finer, Ctrl coarser"
_SHARES = {False: (5, 4), True: (3, 8)}  # of the row's width, for name and line: of a linked one
_UNLINK = "Type a value to unlink it, or right-click"
_HOW_TO_TYPE = "Type a number, arithmetic (2*0.3), another unit, or = to follow other parameters"


class NumberField(TypedField):
    """A number, whole or not; the slider moves it but never rounds what was typed.

    Where it follows other parameters the line has the expression, and the value stands beside the
    slider, which is disabled.
    """

    lines_up = True

    def build(self) -> None:
        """Make line, unit and slider."""
        self.scale = scale_of(self.parameter)
        edit = self.build_edit(steps=True)
        if self.parameter.empty:
            edit.setPlaceholderText(placeholder_of(self.parameter))
        edit.stepped.connect(self._step_freely)
        edit.step_ended.connect(self._end)
        self.slider = Slider(self.scale.positions, self)
        self.named(self.slider, ", slider", "slider")
        self.slider.moved.connect(self._slide)
        self.slider.stepped.connect(self._step)
        self.slider.finished.connect(self._end)
        self.slider.sliderPressed.connect(self._hold)
        self.linked_value = QLabel(self)
        self.linked_value.setObjectName(f"linked_value.{self.parameter.name}")
        self.linked_value.setTextFormat(Qt.TextFormat.PlainText)
        self.linked_value.hide()
        self.row.addWidget(self.label, _SHARES[False][0])
        self.row.addWidget(edit, _SHARES[False][1])
        self.row.addWidget(self.unit)
        below = QHBoxLayout()
        below.setSpacing(6)
        below.addWidget(self.slider, 1)
        below.addWidget(self.linked_value)
        self.column.addLayout(below)
        self.label.setToolTip(tip(f"{about(self.parameter)}\n{_HOW_TO_DRAG}"))
        self.label.set_drags(True)
        self.label.pressed.connect(self._hold)
        self.label.dragged.connect(self._drag)
        self.label.released.connect(self._end)
        self._gesture: object | None = None
        self._part = 0.0
        self._shows_link: bool | None = None

    def show_value(self, value: Any) -> None:
        """Show a number, all of it; or the expression it follows, and its value beside."""
        self._show_link()
        if self.link is not None:
            self.edit.show_text(f"= {self.link.text}")
        else:
            self.edit.show_text("" if value is None else shown_number(value))
        self.slider.show_position(self.scale.position_of(value))

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        super().set_theme(theme)
        set_ink(self.linked_value, theme.changed)
        self.edit.show_link(self.link is not None, theme.changed)

    def take(self, text: str) -> None:
        """Offer what was typed as a number, or behind = as an expression to follow."""
        text = text.strip()
        if text.startswith("="):
            self._offer_link(text[1:].strip())
            return
        try:
            number = typed_number(text, self.parameter)
        except ParameterError as error:
            self.refuse_typed(error)
            return
        self.offer(number)

    def add_link_actions(self, menu: QMenu) -> None:
        """Follow other parameters, or stop and keep the value."""
        if self.link is None:
            linking = menu.addAction("Link to other parameters…")
            linking.setObjectName("link")
            linking.setToolTip("Type an expression behind =")
            linking.triggered.connect(self._begin_link)
            return
        value = "" if self.link.problem else f", keep {self._shown()}"
        unlinking = menu.addAction(f"Unlink{value}")
        unlinking.setObjectName("unlink")
        unlinking.setEnabled(not self.link.problem)
        unlinking.triggered.connect(self._unlink)

    def _shown(self) -> str:
        unit = f" {self.parameter.param.unit}" if self.parameter.param.unit else ""
        return shown_value(self.parameter, self.value) + unit

    def _show_link(self) -> None:
        link = self.link
        if link is None and self._shows_link is False:
            return  # as with each move of a slider
        self._shows_link = link is not None
        self.edit.show_link(link is not None, self.theme.changed)
        self.slider.setEnabled(link is None)
        self.label.set_drags(link is None)
        self.linked_value.setVisible(link is not None)
        for widget, share in zip((self.label, self.edit), _SHARES[link is not None], strict=True):
            self.row.setStretchFactor(widget, share)
        if link is None:
            self.edit.setToolTip(tip(f"{about(self.parameter)}\n{_HOW_TO_TYPE}"))
            self.slider.setToolTip(tip(about(self.parameter)))
            return
        value = "no value" if link.problem else self._shown()
        self.linked_value.setText(f"= {value}" if not link.problem else value)
        self.linked_value.setAccessibleName(f"value of {self.title}")
        self.edit.setToolTip(tip(f"Linked: = {link.text}\nValue: {value}\n{_UNLINK}"))
        self.slider.setToolTip(tip(f"It follows {link.text}\n{_UNLINK}"))

    def hideEvent(self, event: QHideEvent) -> None:
        """Nothing is held any more."""
        super().hideEvent(event)
        self._end()

    def _begin_link(self) -> None:
        self.edit.setFocus(Qt.FocusReason.OtherFocusReason)
        self.edit.setText("= ")
        self.edit.setModified(True)

    def _unlink(self) -> None:
        self.discard_typing()
        self.unlink_wanted.emit(self.parameter.name)

    def _offer_link(self, text: str) -> None:
        raw = expression(text)
        fault = self.link_fault(self.parameter.name, raw)
        if fault is not None:
            self.refuse_typed(fault)
            return
        self._show_problem("")
        self.edited.emit(self.parameter.name, raw, None)
        self._settle()

    def _slide(self, position: int) -> None:
        self._offer_moved(self.scale.value_at(position))

    def _step(self, steps: int) -> None:
        stepped = self.scale.stepped(self.value, steps)
        self._offer_moved(self.scale.within(stepped, self.value))

    def _step_freely(self, steps: int) -> None:
        if self.link is not None:
            self._show_problem(f"{self.title} follows {self.link.text}: {_UNLINK}")
        elif not self.edit.marked:
            self._offer_moved(self.scale.stepped(self.value, steps))

    def _drag(self, steps: float) -> None:
        """By the label; of whole numbers, parts of a step are gathered."""
        if self.link is not None:
            return
        if self.scale.whole:
            self._part += steps
            steps = int(self._part)
            self._part -= steps
            if not steps:
                return
        if self.edit.unsettled:
            self.edit.give_up()
        self._offer_moved(self.scale.stepped(self.value, steps))

    def _hold(self) -> None:
        self._part = 0.0
        self.held.emit(self.parameter.name, True)

    def _offer_moved(self, number: float) -> None:
        """A step beyond what is allowed ends at the last number that is."""
        param = self.parameter.param
        if param.low is not None and number < param.low:
            number = param.low
        if param.high is not None and number > param.high:
            number = param.high
        try:
            self.parameter.coerce(number)
        except ParameterError:
            return
        if self._gesture is None:
            self._gesture = object()
            self.held.emit(self.parameter.name, True)
        self.offer(number, self._gesture)

    def _end(self) -> None:
        if self._gesture is not None:
            self._gesture = None
            self.gesture_ended.emit()
            self.show_value(self.value)
        self.held.emit(self.parameter.name, False)
