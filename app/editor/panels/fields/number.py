"""Fields for numbers: type-in and slider."""

from __future__ import annotations

from typing import Any

from app.editor.declared_text import placeholder_of
from app.editor.number_text import number_of, shown_number
from app.editor.panels.fields.field import TypedField
from app.editor.panels.fields.slider import Slider
from app.editor.panels.fields.slider_scale import scale_of
from core.errors import ParameterError


class NumberField(TypedField):
    """A number, whole or not; the slider moves it but never rounds what was typed."""

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
        self.row.addWidget(self.label, 5)
        self.row.addWidget(edit, 4)
        self.row.addWidget(self.unit)
        self.column.addWidget(self.slider)
        self._gesture: object | None = None

    def show_value(self, value: Any) -> None:
        """Show a number, all of it."""
        self.edit.show_text("" if value is None else shown_number(value))
        self.slider.show_position(self.scale.position_of(value))

    def take(self, text: str) -> None:
        """Offer what was typed as a number."""
        try:
            number = number_of(text, self.parameter)
        except ParameterError as error:
            self.refuse(error)
            return
        self.offer(number)

    def _slide(self, position: int) -> None:
        self._offer_moved(self.scale.value_at(position))

    def _step(self, steps: int) -> None:
        stepped = self.scale.stepped(self.value, steps)
        self._offer_moved(self.scale.within(stepped, self.value))

    def _step_freely(self, steps: int) -> None:
        if not self.edit.marked:
            self._offer_moved(self.scale.stepped(self.value, steps))

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
        self.offer(number, self._gesture)

    def _end(self) -> None:
        if self._gesture is not None:
            self._gesture = None
            self.gesture_ended.emit()
            self.show_value(self.value)
