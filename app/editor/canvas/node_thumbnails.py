"""Keeps a thumbnail below every node that gives something to be drawn."""

from __future__ import annotations

from collections.abc import Hashable
from contextlib import suppress
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene

from app.editor.canvas.canvas_style import CanvasStyle
from app.editor.canvas.content import Content
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.transfer_preview import transfer_lines
from app.editor.session import Level
from app.editor.viewers.picture.picture_facts import between_ends, grey_levels, shrunk
from core.chain.engine import Plan
from core.chain.wires import Image, Pupil
from core.editing.operations import picture_node
from core.errors import ImagechainError, NetworkError
from core.evaluation.recipes import number_bits
from core.records import dataclass
from core.transfer.factors import Part

_OWNER = "canvas.thumbnails"


class NodeThumbnails(QObject):
    """Posts a query for each node, answered once all else is, and shows the answers."""

    def __init__(
        self, session: Level, evaluator: Evaluator, scene: QGraphicsScene, content: Content
    ) -> None:
        super().__init__(session)
        self._session, self._evaluator = session, evaluator
        self._scene, self._content = scene, content
        self.on = True
        self.items: dict[str, ThumbnailItem] = {}
        self._shown_by: dict[str, str] = {}
        evaluator.answered.connect(self._take)
        session.opened.connect(self._opened)
        session.changed.connect(self._changed)
        content.on_placed = self._follow_places
        self._ask()

    def toggle(self) -> None:
        self.on = not self.on
        self._opened()

    def set_style(self, style: CanvasStyle) -> None:
        for item in self.items.values():
            item.style = style
            item.update()

    def _ask(self) -> None:
        self._shown_by = self._sources() if self.on else {}
        self._evaluator.ask(_OWNER, [NodeThumbnailQuery(name) for name in self._shown_by])

    def _sources(self) -> dict[str, str]:
        """By the node in the whole network whose output is drawn, the one here that shows it."""
        session, sources = self._session, {}
        for name, node in session.network.nodes.items():
            with suppress(NetworkError):  # a macro that shows no picture
                sources[session.head + picture_node(node, session.library)] = name
        return sources

    def _opened(self) -> None:
        for name in list(self.items):
            self._drop(name)
        self._evaluator.forget(_OWNER)  # a query that stays would not be answered again
        self._ask()

    def _changed(self, before: Any, after: Any) -> None:
        if before.nodes.keys() != after.nodes.keys():
            for name in self.items.keys() - after.nodes.keys():
                self._drop(name)
            self._ask()
        elif self.on and self._sources() != self._shown_by:
            self._evaluator.forget(_OWNER)
            self._ask()

    def heights(self) -> dict[str, float]:
        return {name: item.boundingRect().bottom() for name, item in self.items.items()}

    def node_at(self, point: QPointF) -> str | None:
        at = (name for name, item in self.items.items() if item.frame().contains(point))
        return next(at, None)

    def bounds(self) -> QRectF:
        whole = QRectF()
        for item in self.items.values():
            whole |= item.frame()
        return whole

    def _take(self, answer: Any) -> None:
        if answer.owner != _OWNER:
            return
        name = self._shown_by.get(getattr(answer.query, "node", ""), "")
        self._drop(name)
        if self.on and answer.value is not None and name in self._content.nodes:
            node = self._content.nodes[name]
            item = ThumbnailItem(answer.value, node.frame().width(), self._content.style)
            item.setPos(node.frame().bottomLeft())
            self.items[name] = item
            self._scene.addItem(item)

    def _follow_places(self) -> None:
        for name, item in self.items.items():
            if name in self._content.nodes:
                item.setPos(self._content.nodes[name].frame().bottomLeft())

    def _drop(self, name: str) -> None:
        if name in self.items:
            self._scene.removeItem(self.items.pop(name))


# A thumbnail on the canvas, below its node.

HIGHEST, CURVE_HEIGHT = 104.0, 44.0
GAP = 4.0  # below the node
Z_THUMBNAIL = -1.5  # above backdrops, below wires and nodes
_LEAST_PX = 4.0  # on the screen; a lower one shows nothing but its ground
_LEAST_SHARE = 0.35  # of the node's width, of a picture that is very high


class ThumbnailItem(QGraphicsItem):
    def __init__(self, small: Small, width: float, style: CanvasStyle) -> None:
        super().__init__()
        self.small, self.style = small, style
        self.setZValue(Z_THUMBNAIL)
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)
        self._box = box_of(small, width)
        self._image = QImage()
        if isinstance(small, SmallPicture):
            high, wide = small.grey.shape
            grey = QImage(small.grey.data, wide, high, wide, QImage.Format.Format_Grayscale8)
            self._image = grey.copy()  # Qt's own: the array may go
        else:
            inner = self._box.adjusted(3, 3, -3, -3)
            across = inner.left() + np.linspace(0.0, 1.0, len(small.values)) * inner.width()
            scale = inner.height() / ((small.high - small.low) or 1.0)
            self._zero = inner.bottom() + small.low * scale
            points = map(QPointF, across.tolist(), (self._zero - small.values * scale).tolist())
            self._curve = QPolygonF(list(points))

    def boundingRect(self) -> QRectF:
        return self._box.adjusted(-1, -1, 1, 1)

    def frame(self) -> QRectF:
        return self._box.translated(self.pos())

    def paint(self, painter: QPainter, *_: Any) -> None:
        style, box = self.style, self._box
        painter.fillRect(box, QColor(style.theme.base))
        if box.height() * painter.worldTransform().m11() < _LEAST_PX:
            return
        if isinstance(self.small, SmallPicture):
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(box, self._image)
        else:
            if self.small.low < 0:
                painter.setPen(QPen(QColor(style.theme.line), 1.0))
                zero, left, right = self._zero, box.left() + 3, box.right() - 3
                painter.drawLine(QPointF(left, zero), QPointF(right, zero))
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(QPen(QColor(style.theme.curves[0]), 2.0))
            painter.drawPolyline(self._curve)
        painter.setPen(style.border)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(box)


def box_of(small: Small, width: float) -> QRectF:
    """Where it stands below the upper left corner of the room below its node."""
    if not isinstance(small, SmallPicture):
        return QRectF(0, GAP, width, CURVE_HEIGHT)
    shape = small.height / small.width if small.width > 0 else 1.0
    high = max(min(width * shape, HIGHEST), 8.0)
    wide = min(max(high / shape, _LEAST_SHARE * width), width)
    return QRectF((width - wide) / 2, GAP, wide, high)


# The query for what comes out of a node, small: its picture, or its transfer function's curve.

MOST_SAMPLES = 192  # across or along a thumbnail
LARGEST_COMPUTED = 1 << 20  # samples; a larger picture is taken only where it is there already
_DARKEST, _BRIGHTEST = 0.005, 0.995  # quantiles, as the viewers have them at first
_POINTS = 64


@dataclass(frozen=True, eq=False)
class SmallPicture:
    """A picture made small, (high, wide); `width` and `height` are its shape as it is seen."""

    grey: NDArray[np.uint8]
    width: float
    height: float


@dataclass(frozen=True, eq=False)
class SmallCurve:
    values: NDArray[np.float64]  # at even places, from no frequency to Nyquist
    low: float
    high: float


Small = SmallPicture | SmallCurve


@dataclass(frozen=True)
class NodeThumbnailQuery(Query):
    """A node's first output that can be drawn, once edits pause: it costs a pass nothing."""

    urgency: ClassVar[int] = 2
    waits: ClassVar[bool] = True

    node: str

    def key(self, plan: Plan) -> Hashable:
        planned = plan.node(self.node)
        if planned.error is not None:
            return str(planned.error)
        port, value = _drawn(plan, self.node)
        return port, getattr(value, "key", None), planned.node.disabled

    def answer(self, passing: Passing) -> Small | None:
        try:
            port, value = _drawn(passing.plan, self.node)
        except ImagechainError:
            return None  # the badge says what is wrong
        if isinstance(value, Image):
            return _small_picture(passing, value)
        if isinstance(value, Pupil):
            samples = np.abs(np.asarray(passing.work.value(value.samples)))
            return _shown(samples, 1.0, 1.0)
        return _small_curve(passing, self.node, "mtf" if port == "mtf" else "ptf") if port else None


def _drawn(plan: Plan, node: str) -> tuple[str, Any]:
    """The output that is drawn, and its value; empty and None where there is none."""
    planned = plan.node(node)
    if planned.node.disabled:
        return "", None
    for port in planned.declaration.outputs:
        if port.types[0] in ("image", "pupil"):
            return port.name, plan.output(f"{node}.{port.name}")
    for curve in ("mtf", "ptf"):
        if planned.declaration.output(curve) is not None:
            return curve, plan.output(f"{node}.{curve}")
    return "", None


def _small_picture(passing: Passing, image: Image) -> SmallPicture | None:
    work = passing.work
    if image.rows * image.columns > LARGEST_COMPUTED and not work.has(image.recipe):
        return None
    samples = np.asarray(work.value(image.recipe))
    x, y = image.interval_x_mrad or 1.0, image.interval_y_mrad or 1.0
    return _shown(samples, image.columns * x, image.rows * y, number_bits(image.recipe))


def _shown(
    samples: NDArray[Any], width: float, height: float, bits: int | None = None
) -> SmallPicture | None:
    small = shrunk(samples, MOST_SAMPLES)
    finite = small[np.isfinite(small)]
    if not finite.size:
        return None
    low, high = (float(value) for value in np.quantile(finite, [_DARKEST, _BRIGHTEST]))
    return SmallPicture(grey_levels(small, *between_ends(low, high, bits)), width, height)


def _small_curve(passing: Passing, node: str, port: Part) -> SmallCurve:
    line, _ = transfer_lines(passing, node, port)
    end = float(line.nyquist) or 1.0
    places = np.linspace(0.0, 1.0, _POINTS)
    values = np.interp(places * end, line.frequency, line.values)
    if port == "mtf":
        return SmallCurve(values, min(0.0, float(values.min())), 1.0)
    reach = max(float(np.abs(values).max()), 1e-9)
    return SmallCurve(values, -reach, reach)
