"""The controls above the charts of a trade-off, and the list of figures that opens there."""

from __future__ import annotations

import math

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QLabel, QLineEdit, QSpinBox, QWidget, QWidgetAction

from app.editor.docks.tradeoff_ranges import LEAST_COUNT, MOST_COUNT, ParameterChoice, Span
from app.editor.number_text import shown_number
from app.editor.panels.fields.type_in import TypeIn
from app.editor.session import Session
from app.editor.viewers.plot.curve_list import CurveList
from app.editor.widgets import Check, FlowLayout, Menu, filled, menu_button, named

_ROWS = 16  # of figures that are seen at once, at most


class TradeOffBar(QWidget):
    """What is varied, from where to where, and in how many steps."""

    span_chosen = Signal(object)  # (span): another range
    refused = Signal(str)  # (text): why what was typed is no range

    def __init__(self, session: Session, parent: QWidget) -> None:
        super().__init__(parent)
        self._span: Span | None = None
        self.parameter = ParameterChoice(session, self)
        self.parameter.setObjectName("tradeoff.parameter")
        self.parameter.setAccessibleName("Parameter to vary")
        self.low = self._edit("low", "From")
        self.high = self._edit("high", "To")
        self.log = Check("log", self)
        self.log.setObjectName("tradeoff.log")
        self.log.setAccessibleName("Equal factors instead of equal steps")
        self.log.setToolTip("Equal factors instead of equal steps")
        self.count = named(QSpinBox(self), "tradeoff.count", "Number of points", "Number of points")
        self.count.setSuffix(" points")
        self.count.setRange(LEAST_COUNT, MOST_COUNT)
        self.count.setKeyboardTracking(False)
        self.figures = menu_button("tradeoff.choose", "Figures", "Choose the figures to show", self)
        self.choice = FigureMenu(self.figures)
        self.figures.setMenu(self.choice)
        filled(
            FlowLayout(self, across=4, down=2),
            self.parameter,
            self._word("from"),
            self.low,
            self._word("to"),
            self.high,
            self.log,
            self.count,
            self.figures,
            margins=(2, 2, 2, 0),
        )
        self.low.committed.connect(self._typed)
        self.high.committed.connect(self._typed)
        self.low.given_up.connect(self._show)
        self.high.given_up.connect(self._show)
        self.log.clicked.connect(self._typed)
        self.count.valueChanged.connect(self._typed)
        self.show_span(None)

    def show_span(self, span: Span | None) -> None:
        self._span = span
        self._show()

    def _show(self) -> None:
        span = self._span
        for widget in (self.low, self.high, self.log, self.count):
            widget.setEnabled(span is not None)
            widget.blockSignals(True)
        self.low.show_text("" if span is None else shown_number(span.low))
        self.high.show_text("" if span is None else shown_number(span.high))
        if span is not None:
            self.log.setChecked(span.log)
            self.count.setValue(span.count)
        for widget in (self.low, self.high, self.log, self.count):
            widget.blockSignals(False)

    def _word(self, text: str) -> QLabel:
        """In the middle of its line."""
        word = QLabel(text, self)
        word.setMinimumHeight(self.low.sizeHint().height())
        return word

    def _edit(self, name: str, description: str) -> TypeIn:
        edit = TypeIn(self, characters=7)
        edit.setFixedWidth(edit.minimumWidth())
        edit.setObjectName(f"tradeoff.{name}")
        edit.setAccessibleName(f"{description}, end of the range")
        edit.setToolTip(f"{description} this value")
        return edit

    def _typed(self, *_: object) -> None:
        if self._span is None:
            return
        low, high = (_number(edit.text()) for edit in (self.low, self.high))
        for edit, number in ((self.low, low), (self.high, high)):
            if number is None:
                edit.mark()
                self.refused.emit(f"{edit.text()!r:.40} is not a number")
                return
        assert low is not None
        assert high is not None
        log = self.log.isChecked()
        if not low < high or (log and low <= 0):
            self.low.mark()
            self.refused.emit(
                f"from {shown_number(low)} to {shown_number(high)}: the first number must be "
                + ("above 0 for equal factors" if low < high else "below the second")
            )
            return
        self.show_span(Span(low, high, log, self._span.whole, self.count.value()))
        self.span_chosen.emit(self._span)


# All figures, to be ticked: those in whose names what is typed occurs.


class FigureMenu(Menu):
    """A line to search in, and the list; wide enough for every name."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.search = named(QLineEdit(self), "tradeoff.search", "Search figures")
        self.search.setPlaceholderText("Search figures")
        self.search.setClearButtonEnabled(True)
        self.list = named(CurveList(self), "tradeoff.figures", "Figures to show")
        for widget in (self.search, self.list):
            action = QWidgetAction(self)
            action.setDefaultWidget(widget)
            self.addAction(action)
        self.search.textChanged.connect(self.narrow)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self.setActiveAction(self.actions()[0])  # from which Tab goes on to the list
        self.search.setFocus(Qt.FocusReason.PopupFocusReason)

    def fit(self) -> None:
        """Have room for the longest name, and for many of them."""
        frame, bar = 2 * self.list.frameWidth(), self.list.verticalScrollBar().sizeHint().width()
        rows = min(self.list.count(), _ROWS) * max(self.list.sizeHintForRow(0), 1)
        self.list.setFixedSize(self.list.sizeHintForColumn(0) + frame + bar + 4, rows + frame)
        self.narrow()

    def narrow(self) -> None:
        words = self.search.text().casefold().split()
        for item in map(self.list.item, range(self.list.count())):
            item.setHidden(not all(word in item.text().casefold() for word in words))
        if words:
            self.list.scrollToTop()


def _number(text: str) -> float | None:
    """A number as people type it; None where it is none."""
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    if text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")
    try:
        number = float(text) if "_" not in text else math.nan
    except ValueError:
        return None
    return number if math.isfinite(number) else None
