"""What all illustrations have: an area that grows with the font, a question, a message."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontInfo, QHideEvent, QPainter, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.editor.declared_text import breakable, error_text, tip
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.theme import Theme, theme_of
from app.editor.widgets import require_defined
from core.errors import ImagechainError, UnconnectedError
from core.network.network import Node

NO_EVALUATION = "nothing is computed here"
DISABLED = "disabled: passes its input on unchanged"

_SIZES = (1.0, 0.9, 0.8, 0.7)
_WRAPPED = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)


class Illustration(QWidget):
    """A picture of what a node does, drawn from answers; it holds no part of the document.

    Without an evaluator nothing computed is shown.
    """

    lines = 11.5
    """Height in lines of text."""

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        node: str,
        parent: QWidget | None = None,
    ) -> None:
        asks = type(self).queries is not Illustration.queries
        require_defined(type(self), Illustration, "draw", *(("take",) if asks else ()))
        super().__init__(parent)
        self.setObjectName("illustration")
        self.session = session
        self.node = node
        self.problem = ""
        self._owner = f"panel.illustration.{id(self):x}"
        self._evaluator = evaluator
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        declared = session.declared(node)
        self.title = declared.title if declared is not None else node
        self._module = session.network.nodes[node].module if node in session.network.nodes else ""
        self.setAccessibleName(f"illustration of {node}: {self.title}")
        if evaluator is not None:
            evaluator.answered.connect(self._answered)
        self._waits = bool(self.queries())
        if self._waits and evaluator is None:
            self.show_problem(NO_EVALUATION)

    def present_node(self) -> Node | None:
        """The node with its values, as long as it is of the module that this was made for.

        Another document may have another module under the same name before its panel is closed.
        """
        node = self.session.resolved.node(self.node)
        return node if node is not None and node.module == self._module else None

    def queries(self) -> Sequence[Query]:
        """The queries it shows answers of."""
        return ()

    def take(self, value: Any) -> str:
        """Keep an answer; what it shows, in words. One with queries overrides it."""
        return str(value)

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint the picture; called only where there is one."""

    @property
    def theme(self) -> Theme:
        """Colours."""
        return theme_of(self)

    def write(self, painter: QPainter, area: QRectF, lines: Sequence[str]) -> None:
        """Write lines from the top left, smaller where they would not all be seen."""
        text, font = "\n".join(lines), painter.font()
        size = QFontInfo(font).pointSizeF()  # of the font itself, it may be unknown
        painter.save()
        for share in _SIZES:
            font.setPointSizeF(size * share)
            painter.setFont(font)
            if painter.boundingRect(area, _WRAPPED, text).height() <= area.height():
                break
        painter.setPen(QColor(self.theme.text))
        painter.drawText(area, _WRAPPED, text)
        painter.restore()

    def describe(self, text: str) -> None:
        """Set in words what is shown."""
        if text != self.accessibleDescription():
            self.setAccessibleDescription(text)
            self.setToolTip(tip(text))

    def show_problem(self, problem: str) -> None:
        """Show a line of text in the place of the picture; the picture for none."""
        self.problem = problem
        if problem:
            self.describe(problem)
        self.update()

    def sizeHint(self) -> QSize:
        """As high as its lines of text."""
        line = self.fontMetrics().height()
        return QSize(line * 20, round(line * self.lines))

    def minimumSizeHint(self) -> QSize:
        """Narrower, but not lower."""
        line = self.fontMetrics().height()
        return QSize(line * 14, round(line * self.lines))

    def showEvent(self, event: QShowEvent) -> None:
        """Post the queries."""
        super().showEvent(event)
        if self._evaluator is not None and self.queries():
            self._evaluator.ask(self._owner, self.queries())

    def hideEvent(self, event: QHideEvent) -> None:
        """Withdraw the queries."""
        super().hideEvent(event)
        if self._evaluator is not None and self.queries():
            self._evaluator.forget(self._owner)

    def prepare(self) -> None:
        """Look at the document before painting, for those that need no answer."""

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the picture, or the line that stands in its place."""
        self.prepare()
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            area = QRectF(self.rect())
            painter.fillRect(area, QColor(self.theme.base))
            inner = area.adjusted(4, 3, -4, -3)
            if self.problem:
                painter.setPen(QColor(self.theme.faint_text))
                wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
                painter.drawText(inner, int(wrapped), breakable(self.problem))
            elif not self._waits:
                self.draw(painter, inner)

    def _answered(self, answer: Any) -> None:
        if not isinstance(answer, Answer) or answer.owner != self._owner:
            return
        self._waits = False
        if answer.error is not None:
            self.show_problem(self.in_short(answer.error))
            return
        self.describe(self.take(answer.value))
        self.show_problem("")

    def in_short(self, error: ImagechainError) -> str:
        """Why there is no picture, in a line."""
        if error.node is not None and error.node != self.node:
            return f"waits for {error.node}: {error_text(error, on_node=True)}"
        missing = self.missing_inputs()
        if isinstance(error, UnconnectedError) and missing:
            return f"not connected yet: {', '.join(missing)}"
        return error_text(error, on_node=True)

    def missing_inputs(self) -> tuple[str, ...]:
        """Inputs that the node needs and that have no wire."""
        declared = self.session.declared(self.node)
        linked = {link.input for link in self.session.network.links_into(self.node)}
        ports = declared.inputs if declared is not None else ()
        return tuple(p.name for p in ports if p.required and p.name not in linked)
