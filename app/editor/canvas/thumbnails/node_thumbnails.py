"""Keeps a thumbnail below every node that gives something to be drawn."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QPointF, QRectF
from PySide6.QtWidgets import QGraphicsScene

from app.editor.canvas.items.canvas_style import CanvasStyle
from app.editor.canvas.items.content import Content
from app.editor.canvas.thumbnails.node_thumbnail_query import NodeThumbnailQuery, Small
from app.editor.canvas.thumbnails.thumbnail_item import ThumbnailItem
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer
from app.editor.level import Level
from app.editor.session import Session
from core.editing.operations import picture_node
from core.errors import NetworkError

_OWNER = "canvas.thumbnails"


class NodeThumbnails(QObject):
    """Posts a query for each node, and shows the answers.

    Parameters
    ----------
    session : Session or Level
        The document, or what of it is shown.
    evaluator : Evaluator
        Answers the queries, once all else is answered.
    scene : QGraphicsScene
        What holds the items.
    content : Content
        The nodes on it.
    """

    def __init__(
        self,
        session: Session | Level,
        evaluator: Evaluator,
        scene: QGraphicsScene,
        content: Content,
    ) -> None:
        super().__init__(session)
        self._session, self._evaluator = session, evaluator
        self._scene, self._content = scene, content
        self._on = True
        self.items: dict[str, ThumbnailItem] = {}
        self._shown_by: dict[str, str] = {}
        evaluator.answered.connect(self._take)
        session.opened.connect(self._opened)
        session.changed.connect(self._changed)
        content.on_placed = self._follow_places
        self._ask()

    @property
    def on(self) -> bool:
        """Whether they are shown."""
        return self._on

    def toggle(self) -> None:
        """Show them, or none."""
        self._on = not self._on
        if not self._on:
            self._clear()
        self._ask()

    def set_style(self, style: CanvasStyle) -> None:
        """Draw them in other colours."""
        for item in self.items.values():
            item.style = style
            item.update()

    def _ask(self) -> None:
        self._shown_by = self._sources() if self._on else {}
        self._evaluator.ask(_OWNER, [NodeThumbnailQuery(name) for name in self._shown_by])

    def _sources(self) -> dict[str, str]:
        """By the node in the whole network whose output is drawn, the one here that shows it."""
        session, sources = self._session, {}
        for name, node in session.network.nodes.items():
            try:
                inner = picture_node(node, session.library)
            except NetworkError:  # a macro that shows no picture
                continue
            sources[session.head + inner] = name
        return sources

    def _opened(self) -> None:
        self._clear()
        self._evaluator.forget(_OWNER)  # a query that stays would not be answered again
        self._ask()

    def _changed(self, before: Any, after: Any) -> None:
        if before.nodes.keys() != after.nodes.keys():
            for name in [name for name in self.items if name not in after.nodes]:
                self._drop(name)
            self._ask()
        elif self._on and self._sources() != self._shown_by:
            self._evaluator.forget(_OWNER)
            self._ask()

    def heights(self) -> dict[str, float]:
        """How much room each node's thumbnail takes below it."""
        return {name: item.boundingRect().bottom() for name, item in self.items.items()}

    def node_at(self, point: QPointF) -> str | None:
        """The node whose thumbnail is at a point of the scene."""
        at = (name for name, item in self.items.items() if item.frame().contains(point))
        return next(at, None)

    def bounds(self) -> QRectF:
        """What they take up; null where there are none."""
        whole = QRectF()
        for item in self.items.values():
            whole = whole.united(item.frame())
        return whole

    def _take(self, answer: Any) -> None:
        if (
            not isinstance(answer, Answer)
            or answer.owner != _OWNER
            or not isinstance(answer.query, NodeThumbnailQuery)
        ):
            return
        name, small = self._shown_by.get(answer.query.node, ""), answer.value
        if not self._on or small is None or name not in self._content.nodes:
            self._drop(name)
            return
        self._show(name, small)

    def _show(self, name: str, small: Small) -> None:
        node = self._content.nodes[name]
        item = self.items.get(name)
        if item is None:
            item = ThumbnailItem(small, node.frame().width(), self._content.style)
            self.items[name] = item
            self._scene.addItem(item)
        else:
            item.show_small(small)
        item.setPos(node.frame().bottomLeft())

    def _follow_places(self) -> None:
        for name, item in self.items.items():
            if name in self._content.nodes:
                item.setPos(self._content.nodes[name].frame().bottomLeft())

    def _drop(self, name: str) -> None:
        item = self.items.pop(name, None)
        if item is not None:
            self._scene.removeItem(item)

    def _clear(self) -> None:
        for name in list(self.items):
            self._drop(name)
