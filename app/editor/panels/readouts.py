"""The calculated figures on a panel."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import ClassVar

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QGridLayout, QLabel, QLineEdit, QSizePolicy, QWidget

from app.editor.declared_text import label_of, tip
from app.editor.evaluation.evaluator import Evaluator, Freshness
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.number_text import shown_figure
from app.editor.session import Session
from app.editor.theme import FAINT, TEXT, set_ink
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import labelled, plain_label, steady_width
from core.chain.engine import Plan
from core.modules.declaration import Declaration

NONE = "—"
TITLE = "Read-outs"
OLDER, HELD_BACK = "computed before the last edit", "as last generated"
_BESIDE = 3  # room that a line edit keeps at both ends, and for the cursor


@dataclass(frozen=True)
class ReadoutsQuery(Query):
    """What are the read-outs of that node? Answered in order, with why one has no value."""

    node: str
    urgency: ClassVar[int] = 1

    def key(self, plan: Plan) -> Hashable:
        planned = plan.node(self.node)
        if planned.error is not None:
            return (type(planned.error), str(planned.error))
        wires = (planned.inputs, planned.outputs)
        keys = tuple(
            (name, getattr(value, "key", None), getattr(value, "unit", ""))
            for wire in wires
            for name, value in wire.items()
        )
        return keys, repr(planned.module), planned.node.disabled

    def answer(self, passing: Passing) -> tuple[tuple[str, str, str, str], ...]:
        engine, plan, work = passing.engine, passing.plan, passing.work
        readouts = engine.readouts(plan, self.node, work)
        planned = plan.node(self.node)
        units = {one.name: planned.unit(one) for one in planned.declaration.readouts}
        return tuple(
            (
                name,
                shown_figure(value),
                units[name],
                engine.why_none(plan, self.node, work, name) if value is None else "",
            )
            for name, value in readouts.items()
        )


class ReadoutValue(QLineEdit):
    """Can be selected and copied; a `QLabel` would have the window laid out for each text."""

    _width = 0

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, readOnly=True, frame=False)
        self.setTextMargins(0, 0, 0, 0)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        palette = self.palette()
        palette.setColor(QPalette.ColorRole.Base, Qt.GlobalColor.transparent)
        self.setPalette(palette)
        self.show_text(NONE)

    def show_text(self, text: str) -> None:
        if text != self.text():
            self.setText(text)
            self.setCursorPosition(0)
            self._fit(self._width)

    def sizeHint(self) -> QSize:
        return QSize(self._width + 2 * _BESIDE, self.fontMetrics().height())

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit(0)

    def _fit(self, had: int) -> None:
        width = steady_width(self.text(), self.font(), had)
        if width != self._width:
            self._width = width
            self.updateGeometry()


class ReadoutsView(Viewer):
    """One row for each read-out; queries them while it is visible.

    Values that are of the network before the last edit are drawn faint, and the title says so:
    where a preview of the pictures came first, and where the node is held back.
    """

    _is_held_back = False
    _freshness: Freshness | None = None

    def __init__(
        self,
        declaration: Declaration,
        node: str,
        evaluator: Evaluator | None,
        session: Session,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, f"panel.readouts.{id(self):x}", parent)
        self.setObjectName("readouts")
        self.query = ReadoutsQuery(node)
        self.values: dict[str, ReadoutValue] = {}
        self.units: dict[str, QLabel] = {}
        self._meanings: dict[str, str] = {}
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 2, 0, 2)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(0, 1)
        for row, readout in enumerate(declaration.readouts):
            name = plain_label("", self, label_of(readout.name), role=FAINT)
            value = labelled(ReadoutValue(self), f"readout.{readout.name}")
            unit = plain_label("", self, readout.unit, role=FAINT)
            unit.setWordWrap(False)
            self._meanings[readout.name] = readout.meaning
            for column, widget in enumerate((name, value, unit)):
                widget.setToolTip(tip(readout.meaning))
                grid.addWidget(widget, row, column)
            self.values[readout.name] = value
            self.units[readout.name] = unit
            value.setAccessibleName(_spoken(readout.name, readout.unit))
        self.title = QLabel(TITLE, self)
        self.title.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        if evaluator is not None:
            self._freshness = Freshness(session, evaluator, self)
            self._freshness.changed.connect(self._mark)

    @property
    def is_old(self) -> bool:
        behind = self._freshness is not None and self._freshness.is_old
        return behind or self._is_held_back

    def queries(self) -> tuple[Query, ...]:
        return (self.query,)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "title"):
            self._mark()

    def set_held_back(self, on: bool) -> None:
        self._is_held_back = on
        self._mark()

    def _mark(self, _old: bool = False) -> None:
        ink = self.palette().color(FAINT if self.is_old else TEXT).name()
        for value in self.values.values():
            set_ink(value, ink)
        words = HELD_BACK if self._is_held_back else OLDER
        text = f"{TITLE}: {words}" if self.is_old else TITLE
        if text != self.title.text():
            self.title.setText(text)

    def take(self, answer: Answer) -> None:
        texts, units, reasons = {}, {}, {}
        if answer.error is None:
            texts = {name: text for name, text, _, _ in answer.value}
            units = {name: unit for name, _, unit, _ in answer.value}
            reasons = {name: reason for name, _, _, reason in answer.value}
        else:
            reasons = dict.fromkeys(self.values, str(answer.error))
        for name, value in self.values.items():
            value.show_text(texts.get(name, NONE))
            reason = reasons.get(name, "")
            meaning = self._meanings[name]
            value.setToolTip(tip(f"{reason}\n{meaning}" if reason else meaning))
            value.setAccessibleDescription(reason)
            unit = units.get(name, "")
            if name in units and unit != self.units[name].text():
                self.units[name].setText(unit)  # of the picture that comes in
                value.setAccessibleName(_spoken(name, unit))
        if self._freshness is not None:
            self._freshness.catch_up(answer.generation)


def _spoken(name: str, unit: str) -> str:
    """A read-out's name for who does not see it."""
    return f"{label_of(name)} in {unit}" if unit else label_of(name)
