"""The calculated figures on a panel."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.wants import Answer, Passing, Want
from app.editor.panels.colours import set_ink
from app.editor.panels.number_text import shown_figure
from app.editor.panels.wording import label_of, tip
from app.editor.theme import Theme
from core.declaration import Declaration
from core.engine import Plan

NONE = "—"


@dataclass(frozen=True)
class ReadoutsWant(Want):
    """What are the read-outs of that node? Answered by their texts in order."""

    node: str
    urgency: ClassVar[int] = 1

    def key(self, plan: Plan) -> Hashable:
        """What comes in, what goes out, and the module's settings."""
        planned = plan.node(self.node)
        if planned.error is not None:
            return (type(planned.error), str(planned.error))
        wires = (planned.inputs, planned.outputs)
        keys = tuple((n, getattr(v, "key", None)) for wire in wires for n, v in wire.items())
        return keys, repr(planned.module), planned.node.disabled

    def answer(self, passing: Passing) -> tuple[tuple[str, str], ...]:
        """Name and text of each."""
        found = passing.engine.readouts(passing.plan, self.node, passing.work)
        return tuple((name, shown_figure(value)) for name, value in found.items())


class ReadoutsView(QWidget):
    """One row for each read-out; asks for them while it is to be seen.

    Parameters
    ----------
    declaration : Declaration
        Of the node's module.
    node : str
        Id of the node.
    evaluator : Evaluator or None
        Whom to ask; without one there are no values.
    theme : Theme
        Colours.
    parent : QWidget, optional
        Its parent.
    """

    def __init__(
        self,
        declaration: Declaration,
        node: str,
        evaluator: Evaluator | None,
        theme: Theme,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setObjectName("readouts")
        self.want = ReadoutsWant(node)
        self._owner = f"panel.readouts.{id(self):x}"
        self._evaluator = evaluator
        self.values: dict[str, QLabel] = {}
        self._quiet: list[QLabel] = []
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 2, 0, 2)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(0, 1)
        for row, readout in enumerate(declaration.readouts):
            name = QLabel(label_of(readout.name), self)
            name.setWordWrap(True)
            value = QLabel(NONE, self)
            value.setObjectName(f"readout.{readout.name}")
            value.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            value.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            unit = QLabel(readout.unit, self)
            value.setAccessibleName(
                f"{name.text()} in {readout.unit}" if readout.unit else name.text()
            )
            for column, label in enumerate((name, value, unit)):
                label.setTextFormat(Qt.TextFormat.PlainText)
                label.setToolTip(tip(readout.meaning))
                grid.addWidget(label, row, column)
            self.values[readout.name] = value
            self._quiet += [name, unit]
        self.set_theme(theme)
        if evaluator is not None:
            evaluator.answered.connect(self._answered)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask."""
        super().showEvent(event)
        if self._evaluator is not None and self.values:
            self._evaluator.ask(self._owner, [self.want])

    def hideEvent(self, event: QHideEvent) -> None:
        """Ask no more."""
        super().hideEvent(event)
        if self._evaluator is not None and self.values:
            self._evaluator.forget(self._owner)

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        for label in self._quiet:
            set_ink(label, theme.faint_text)

    def _answered(self, answer: Any) -> None:
        if not isinstance(answer, Answer) or answer.owner != self._owner:
            return
        texts = dict(answer.value) if answer.error is None else {}
        for name, label in self.values.items():
            label.setText(texts.get(name, NONE))
