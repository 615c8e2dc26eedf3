"""What all illustrations have: an area that grows with the font, a question, a message."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontInfo, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.editor.declared_text import breakable, error_text, tip
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.session import Session
from app.editor.viewers.viewer import Viewer
from core.chain.engine import Plan, PlannedNode
from core.errors import ImagechainError, UnconnectedError
from core.network.network import Node

NO_EVALUATION = "nothing is computed here"
DISABLED = "disabled: passes its input on unchanged"

_SIZES = (1.0, 0.9, 0.8, 0.7)
_WRAPPED = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)
_CENTRED = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)


@dataclass(frozen=True)
class NodeQuery(Query):
    """What `made` makes of a planned node; None of a disabled one.

    It is asked again when the module's settings change, or what is on one of the `ports`.
    """

    urgency: ClassVar[int] = 1

    node: str
    made: Callable[[PlannedNode, Passing], Any]
    ports: tuple[str, ...]

    def key(self, plan: Plan) -> Hashable:
        """What is on the ports, and the settings."""
        planned = sound_node(plan, self.node)
        wires = {**planned.inputs, **planned.outputs}
        keys = tuple(getattr(wires.get(port), "key", None) for port in self.ports)
        return keys, repr(planned.module), planned.node.disabled

    def answer(self, passing: Passing) -> Any:
        planned = sound_node(passing.plan, self.node)
        return None if planned.node.disabled else self.made(planned, passing)


def sound_node(plan: Plan, name: str) -> PlannedNode:
    """A node that could be planned; what is wrong with it is raised."""
    planned = plan.node(name)
    if planned.error is not None:
        raise planned.error
    return planned


class Illustration(Viewer):
    """A picture of what a node does, drawn from answers; it holds no part of the document.

    Kinds of it say in `queries` what they ask, keep an answer in `keep` and paint it in `draw`.
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
        super().__init__(session, evaluator, f"panel.illustration.{id(self):x}", parent)
        self.setObjectName("illustration")
        self.node = node
        self.problem = ""
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        declared = session.declared(node)
        title = declared.title if declared is not None else node
        self._module = session.network.nodes[node].module if node in session.network.nodes else ""
        self.setAccessibleName(f"illustration of {node}: {title}")
        self._waits = bool(self.queries())
        if self._waits and evaluator is None:
            self.show_problem(NO_EVALUATION)

    def present_node(self) -> Node | None:
        """The node with its values, as long as it is of the module that this was made for.

        Another document may have another module under the same name before its panel is closed.
        """
        node = self.session.resolved.node(self.node)
        return node if node is not None and node.module == self._module else None

    def keep(self, value: Any) -> str:
        """Keep an answer; what it shows, in words."""
        raise NotImplementedError

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint the picture; called only where there is one."""
        raise NotImplementedError

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
                painter.drawText(inner, _CENTRED, breakable(self.problem))
            elif not self._waits:
                self.draw(painter, inner)

    def take(self, answer: Answer) -> None:
        """Show an answer, or why there is none."""
        self._waits = False
        if answer.error is not None:
            self.show_problem(self.in_short(answer.error))
        elif answer.value is None:
            self.show_problem(DISABLED)
        else:
            self.describe(self.keep(answer.value))
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


class DocumentIllustration(Illustration):
    """Drawn straight from the document's parameters, without waiting for an answer.

    Kinds of it take the node in `look` when it has changed.
    """

    seen: Node | None = None

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        node: str,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, node, parent)
        self._waits = False
        self.prepare()

    def prepare(self) -> None:
        """Look at the node, if it has changed since."""
        node = self.present_node()
        if node is None or node is self.seen:
            return
        self.seen = node
        try:
            self.look(node)
        except ImagechainError as error:
            self.show_problem(error.message)

    def look(self, node: Node) -> None:
        """Show the node; what is wrong with it is raised."""
        raise NotImplementedError

    def follow(self, *_: object) -> None:
        if self.session.resolved.node(self.node) is not self.seen:
            self.update()
