"""Nodes and backdrops, as they are drawn on the canvas."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsItem

from app.editor.canvas.canvas_style import (
    BADGE_ROOM,
    INPUT,
    OUTPUT,
    PORT_RADIUS,
    CanvasStyle,
    NodeFace,
    NodeGeometry,
    Side,
    TextRole,
    geometry_of,
    label_room,
)
from app.editor.canvas.nodegraphqt import AbstractNodeItem
from app.editor.evaluation.queries import Badge, BadgeKind
from core.editing.backdrops import Backdrop
from core.editing.layout import Box
from core.modules.declaration import Port
from core.records import replace

GAP_BESIDE = 72.0  # at most, that a title takes of the ground between its node and another
_TITLE_FROM = 0.92  # of the natural zoom; below, titles are drawn as large as there
OVERVIEW = 0.62  # of the natural zoom: below, a node shows its name alone
_PORTS_NAMED_FROM = 0.97  # of the natural zoom: below, the names of ports cannot be read
_SUBTITLE_FROM = 0.74  # of the natural zoom: below, a readable module's title has no room
_ROUND = 5.0
_LEFT = 9.0
_READABLE_PX = 12.0  # of the window's font at its usual 12
_LEAST_PX = 12.0  # on the screen, 9 points
_PORTS_FROM = 0.2
_PLATE = 14.0  # height of the output's mark, half of it below the node
OUTPUT_MARK = "output"
_MARGIN = 8.0  # what is drawn around the frame: ports, the mark of the selection
_BESIDE = 10.0  # left and right of a title together, at least
_APART_PX = 3.0  # on the screen, between two stages at least: a wire is seen there
_PORTS_BESIDE = 18.0  # where there is room: the title stands clear of the ports
_AROUND = 7.0  # above and below a title together
_TALLER = 38.0  # the title of a small node may be, above its frame


class NodePort(QGraphicsItem):
    """Where wires end, drawn by its node; `fits`: a wire that is being drawn may end here."""

    def __init__(self, port: Port, side: Side, parent: NodeItem) -> None:
        super().__init__(parent)
        self.name, self.types, self.side = port.name, port.types, side
        self.fits: bool | None = None
        self.hovered = False
        self.wires = 0
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents, True)
        kinds = " or ".join(port.types)
        need = "" if side == "output" else ", required" if port.required else ", optional"
        about = f"{side}, {kinds}{need}" if kinds else f"{side} of an unknown type"
        self.setToolTip(f"{port.name}: {about}")

    def boundingRect(self) -> QRectF:
        return _PORT_RECT

    @property
    def node(self) -> NodeItem:
        node = self.parentItem()
        assert isinstance(node, NodeItem)
        return node

    def centre(self) -> QPointF:
        return self.scenePos()


class NodeItem(AbstractNodeItem):
    def __init__(self, face: NodeFace, style: CanvasStyle) -> None:
        super().__init__(face.id)
        self.id = face.id
        self.face = face
        self.style = style
        self.disabled = face.disabled
        self.setCacheMode(QGraphicsItem.CacheMode.NoCache)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIsMovable, False)
        self.geometry: NodeGeometry = geometry_of(face, style)
        self._width, self._height = self.geometry.width, self.geometry.height
        beside, above = GAP_BESIDE / 2 + _MARGIN, _TALLER + _MARGIN
        self._bounds = self.geometry.frame.adjusted(-beside, -above, beside, above)
        self.title_room = self._width
        """How wide the title may be where the node is small: into the gaps beside it."""
        self.ports: dict[tuple[Side, str], NodePort] = {}
        for side in (INPUT, OUTPUT):
            for port in face.ports(side):
                item = self.ports[side, port.name] = NodePort(port, side, self)
                item.setPos(self.geometry.ports[side, port.name])
        self._badge: BadgeItem | None = None
        self._title: tuple[tuple[float, float, CanvasStyle], Fitted | None] | None = None
        self.setToolTip(face.tooltip)

    def boundingRect(self) -> QRectF:
        return self._bounds

    def frame(self) -> QRectF:
        return QRectF(self.pos(), QSizeF(self._width, self._height))

    def box(self) -> Box:
        x, y = self.x(), self.y()
        return x, y, x + self._width, y + self._height

    def paint(self, painter: QPainter, *_: Any) -> None:
        zoom = max(painter.worldTransform().m11(), 1e-3)
        relative = zoom / self.style.natural_zoom
        if not self.face.known:
            painter.setOpacity(0.9)
        frame = self.plate(zoom) if relative < OVERVIEW else self.geometry.frame
        if relative < OVERVIEW:
            _paint_overview(painter, self, zoom, frame)
        else:
            _paint_full(painter, self, relative)
        _paint_border(painter, self, zoom, frame)
        if self.face.output:
            _paint_output_mark(painter, self, with_text=relative >= OVERVIEW)
        if relative >= _PORTS_FROM:
            for port in self.ports.values():
                x = frame.left() if port.side == INPUT else frame.right()
                _paint_port(painter, port, self.style, QPointF(x, port.y()))
        painter.setOpacity(1.0)

    @property
    def badge(self) -> Badge | None:
        return self._badge.badge if self._badge is not None else None

    def set_badge(self, badge: Badge | None) -> None:
        if badge == self.badge:
            return
        if self._badge is not None:
            self.scene().removeItem(self._badge)  # which takes it from this item, too
            self._badge = None
        if badge is not None:
            self._badge = BadgeItem(badge, self.style, self)
            self._badge.setPos(self._width - INSET, INSET)

    def title_at(self, zoom: float) -> Fitted | None:
        """The title as it is drawn in the overview; measured once for a zoom."""
        made_for = zoom, self.title_room, self.style
        if self._title is None or self._title[0] != made_for:
            high = self._height + _TALLER - _AROUND
            less = _beside(zoom), max(_BESIDE, 2 * _APART_PX / zoom)
            rooms = [QSizeF(self.title_room - beside, high) for beside in less]
            self._title = made_for, fitted(self.face, rooms, zoom, self.style)
        return self._title[1]

    def plate(self, zoom: float) -> QRectF:
        frame, title = self.geometry.frame, self.title_at(zoom)
        if title is None:
            return frame
        wide = min(title.size.width() + _beside(zoom), self.title_room - _APART_PX / zoom)
        beside = max(0.0, wide - frame.width()) / 2
        above = max(0.0, title.size.height() + _AROUND - frame.height())
        return frame.adjusted(-beside, -above, beside, 0)

    def take_face(self, face: NodeFace) -> bool:
        """Show another face, if it has the same texts and ports; whether it has."""
        shown = self.face
        same = {name: getattr(shown, name) for name in ("disabled", "output", "colour")}
        if replace(face, **same) != shown:
            return False
        if face != shown:
            self.face, self.disabled = face, face.disabled
            self.setToolTip(face.tooltip)
            self.update()
        return True

    def set_style(self, style: CanvasStyle) -> None:
        self.style = style
        if self._badge is not None:
            self._badge.style = style
        self.update()


_GAP = 4.0  # between the two frames of a macro
_PORT_RECT = QRectF(-8, -7, 16, 14)


def head_colour(item: NodeItem) -> QColor:
    return item.style.tint(item.face.colour) or item.style.head(item.face.group)


def _paint_full(painter: QPainter, item: NodeItem, relative: float) -> None:
    style, face, geometry = item.style, item.face, item.geometry
    frame = geometry.frame
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(style.node)
    painter.drawRoundedRect(frame, _ROUND, _ROUND)
    painter.setBrush(head_colour(item))
    painter.drawPath(_head(frame.width(), geometry.head))
    _veil_disabled(painter, item)
    room = frame.width() - 2 * _LEFT - (BADGE_ROOM if item.badge else 0.0)
    painter.setPen(style.text)
    _write(painter, style, ("title", face.id), QPointF(_LEFT, 17), room, _TITLE_FROM / relative)
    if face.subtitle and relative >= _SUBTITLE_FROM:
        painter.setOpacity(painter.opacity() * 0.8)
        room = frame.width() - 2 * _LEFT
        _write(painter, style, ("id", face.subtitle), QPointF(_LEFT, 33), room, 1.0 / relative)
        painter.setOpacity(painter.opacity() / 0.8)
    if relative < _PORTS_NAMED_FROM:
        return
    painter.setFont(style.font("port"))
    for side, other in ((INPUT, OUTPUT), (OUTPUT, INPUT)):
        for row, port in enumerate(face.ports(side)):
            at = geometry.ports[side, port.name]
            room = label_room(geometry, row, face.ports(other))
            text = style.elided("port", port.name, room)
            x = _LEFT if side == INPUT else at.x() - _LEFT - style.width("port", text)
            painter.setPen(style.text if port.required else style.faint)
            painter.drawText(QPointF(x, at.y() + 4), text)


def _write(
    painter: QPainter,
    style: CanvasStyle,
    words: tuple[TextRole, str],
    at: QPointF,
    room: float,
    larger: float,
) -> None:
    """Write a line, larger where the zoom would make it too small to read."""
    larger = max(1.0, larger)
    painter.save()
    painter.scale(larger, larger)
    painter.setFont(style.font(words[0]))
    painter.drawText(at / larger, style.elided(*words, room / larger))
    painter.restore()


def _paint_overview(painter: QPainter, item: NodeItem, zoom: float, plate: QRectF) -> None:
    style = item.style
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(head_colour(item))
    painter.drawRoundedRect(plate, _ROUND, _ROUND)
    _veil_disabled(painter, item)
    title = item.title_at(zoom)
    if title is not None:
        painter.setPen(style.text)
        painter.setFont(title.font)
        painter.drawText(plate, _CENTRED, title.text)


def _paint_border(painter: QPainter, item: NodeItem, zoom: float, frame: QRectF) -> None:
    style = item.style
    if item.selected:
        pen = QPen(style.accent, max(2.2, 2.0 / zoom))
    elif not item.face.known:
        pen = style.dashed
    elif item.face.output:
        pen = QPen(style.port(("image",)), max(2.2, 2.0 / zoom))
    else:
        pen = style.border
    painter.setPen(pen)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRoundedRect(frame, _ROUND, _ROUND)
    if item.face.macro:  # a second frame around it, as of cards that lie on each other
        painter.setBrush(Qt.BrushStyle.NoBrush)
        gap = min(max(_GAP, 3.0 / zoom), _MARGIN - 1.0)
        around = frame.adjusted(-gap, -gap, gap, gap)
        painter.drawRoundedRect(around, _ROUND + gap, _ROUND + gap)


def _veil_disabled(painter: QPainter, item: NodeItem) -> None:
    if not item.disabled:
        return
    veil = QColor(item.style.theme.canvas)
    veil.setAlpha(_VEIL)
    for brush in (QBrush(veil), _HATCHED):
        painter.setBrush(brush)
        painter.drawRoundedRect(item.geometry.frame, _ROUND, _ROUND)


def _paint_output_mark(painter: QPainter, item: NodeItem, *, with_text: bool) -> None:
    """A plate on the lower border, in the colour of pictures; where it is small, a corner."""
    style, frame = item.style, item.geometry.frame
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(style.port(("image",)))
    if not with_text:
        side = min(frame.height() / 4, frame.width() / 8)
        out = min(side / 2, _MARGIN - 1)  # half beside the frame, clear of the name
        corner = frame.bottomRight() + QPointF(out, out)
        painter.drawPolygon(
            [corner, QPointF(corner.x() - side, corner.y()), QPointF(corner.x(), corner.y() - side)]
        )
        return
    width = style.width("id", OUTPUT_MARK) + 2 * _ROUND
    plate = QRectF(frame.right() - width - _LEFT, frame.bottom() - _PLATE / 2, width, _PLATE)
    painter.drawRoundedRect(plate, _ROUND, _ROUND)
    painter.setPen(style.node.color())
    painter.setFont(style.font("id"))
    painter.drawText(plate, _CENTRED, OUTPUT_MARK)


def _paint_port(painter: QPainter, port: NodePort, style: CanvasStyle, at: QPointF) -> None:
    colour = style.port(port.types)
    before = painter.opacity()
    if port.fits is False:
        painter.setOpacity(0.2)
    painter.setPen(QPen(colour, 1.8))
    painter.setBrush(colour if port.wires or port.hovered else style.node)
    radius = PORT_RADIUS + (1.5 if port.hovered or port.fits else 0.0)
    painter.drawEllipse(at, radius, radius)
    if port.fits or port.hovered:
        painter.setPen(QPen(style.accent, 1.4))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(at, radius + 1.6, radius + 1.6)
    painter.setOpacity(before)


def _head(width: float, height: float) -> QPainterPath:
    path = QPainterPath()
    path.setFillRule(Qt.FillRule.WindingFill)
    path.addRoundedRect(QRectF(0, 0, width, height), _ROUND, _ROUND)
    path.addRect(QRectF(0, height - _ROUND, width, _ROUND))
    return path


def _beside(zoom: float) -> float:
    """The room left and right of a title: as wide on the screen at every zoom."""
    return max(_PORTS_BESIDE, 10.0 / zoom)


class Fitted(NamedTuple):
    text: str
    font: QFont
    size: QSizeF


def fitted(
    face: NodeFace, rooms: Sequence[QSizeF], zoom: float, style: CanvasStyle
) -> Fitted | None:
    """A title in the largest font that fits and can be read: in lines, divided, else elided.

    The first of the rooms that holds it; None where not even five letters of it would be seen.
    """
    text = re.sub("([_-])", "\\1\N{ZERO WIDTH SPACE}", face.id)
    for divide in (False, True):
        if divide:
            text = re.sub("([^_\N{ZERO WIDTH SPACE}-]{4,}?)(\\w{4,7})\\b", "\\1-\n\\2", text)
        for room in rooms:
            size = math.ceil(_READABLE_PX * style.natural_zoom / zoom)
            while size * zoom >= _LEAST_PX:
                needed = style.metrics(size).boundingRect(QRectF(QPointF(), room), _CENTRED, text)
                if needed.width() <= room.width() and needed.height() <= room.height():
                    return Fitted(text, style.sized(size), needed.size())
                size -= max(1, size // 16)
    size, room = math.ceil(_LEAST_PX / zoom), rooms[-1]
    metrics = style.metrics(size)
    text = metrics.elidedText(face.id, Qt.TextElideMode.ElideRight, room.width())
    if len(text) <= 5 < len(face.id) or metrics.height() > room.height():
        return None
    return Fitted(text, style.sized(size), QSizeF(room.width(), metrics.height()))


_CENTRED = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextDontClip | Qt.TextFlag.TextWordWrap)
_HATCHED = QBrush(QColor(128, 128, 128, 64), Qt.BrushStyle.BDiagPattern)
_VEIL = 130  # of 255, the opacity of the ground that fades a disabled node


# The mark of a node's state in its corner: by form as well as by colour.

_RADIUS = 7.5
INSET = 12.0  # of its centre, from the node's corner
_SMALLEST_PX = 4.5  # radius on the screen, however small the node
_LARGEST = 3.0  # times the normal size


class BadgeItem(QGraphicsItem):
    def __init__(self, badge: Badge, style: CanvasStyle, parent: QGraphicsItem) -> None:
        super().__init__(parent)
        self.badge, self.style = badge, style
        self.setZValue(3)
        self.setToolTip(badge.text)

    def boundingRect(self) -> QRectF:
        return _BOUNDS

    def paint(self, painter: QPainter, *_: Any) -> None:
        zoom = max(painter.worldTransform().m11(), 1e-3)
        painter.save()
        scale = min(max(1.0, _SMALLEST_PX / (_RADIUS * zoom)), _LARGEST)
        if scale > 1:  # on the very corner, where it hides little of the title
            painter.translate(INSET, -INSET - _RADIUS * (scale - 1) / 2)
        painter.scale(scale, scale)
        colour = QColor(self.style.theme.badges[self.badge.kind])
        ground = QColor(self.style.theme.node)
        painter.setPen(QPen(ground, 1.5))
        painter.setBrush(colour)
        if self.badge.kind == "warning":
            painter.drawPolygon(_TRIANGLE)
        else:
            painter.drawEllipse(QPointF(), _RADIUS, _RADIUS)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(ground, 1.9, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        _draw_sign(painter, self.badge.kind)
        painter.restore()


def _draw_sign(painter: QPainter, kind: BadgeKind) -> None:
    point = QPointF
    if kind in ("error", "warning"):  # a warning's stands in a triangle
        painter.drawLine(point(0, -4), point(0, 0.8))
        painter.drawPoint(point(0, 4))
    elif kind == "stale":  # a clock
        painter.drawLine(point(0, -4), point(0, 0))
        painter.drawLine(point(0, 0), point(3, 2))
    elif kind == "running":
        painter.drawArc(QRectF(-3.6, -3.6, 7.2, 7.2), 60 * 16, 270 * 16)
    elif kind == "skipped":
        for x in (-3.2, 0.6):
            painter.drawPolyline([point(x, -3), point(x + 2.8, 0), point(x, 3)])
    elif kind == "disabled":
        painter.drawLine(point(-3.2, 3.2), point(3.2, -3.2))
    else:  # incomplete: an open plug
        for x in (-3.4, 0, 3.4):
            painter.drawPoint(point(x, 0))


_TRIANGLE = [QPointF(0, -10), QPointF(9.5, 7), QPointF(-9.5, 7)]
_BOUNDS = QRectF(-20, -40, 60, 60)


HEAD = 26.0
HANDLE = 16.0
SMALLEST = QSizeF(96, 64)
_READABLE_TITLE_PX = 12.0
_HIGHEST = 190.0  # of a title, in units
_NOTE_TINT = "yellow"
_TEXT, _INSET = 12, 8.0  # units: a note's letters at least, and the space round them
_WRAPPED = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)


def rect_of(backdrop: Backdrop) -> QRectF:
    return QRectF(backdrop.x, backdrop.y, backdrop.width, backdrop.height)


class BackdropItem(AbstractNodeItem):
    """A backdrop. `index` is its place in the document's list."""

    def __init__(self, index: int, shown: Backdrop, style: CanvasStyle) -> None:
        super().__init__(shown.title)
        self.index = index
        self.shown = shown
        self.style = style
        self.setCacheMode(QGraphicsItem.CacheMode.NoCache)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIsMovable, False)
        self.setZValue(-2)
        self.setToolTip("")
        self.place(rect_of(shown))

    @property
    def title(self) -> str:
        return self.shown.title

    def place(self, rect: QRectF) -> None:
        self.prepareGeometryChange()
        self.setPos(rect.topLeft())
        self._width, self._height = rect.width(), rect.height()
        self.update()

    def frame(self) -> QRectF:
        return QRectF(self.pos(), QSizeF(self._width, self._height))

    def head(self, zoom: float) -> QRectF:
        """Where its title is, to be dragged by; of a note, all of it."""
        if self.shown.note:
            return self.frame()
        return self._head(zoom).translated(self.pos())

    def handle(self) -> QRectF:
        corner = self.frame().bottomRight()
        return QRectF(corner - QPointF(HANDLE, HANDLE), corner)

    def boundingRect(self) -> QRectF:
        return QRectF(-2, -_HIGHEST, self._width + 4, self._height + _HIGHEST + 2)

    def set_style(self, style: CanvasStyle) -> None:
        self.style = style
        self.update()

    def paint(self, painter: QPainter, *_: Any) -> None:
        zoom = max(painter.worldTransform().m11(), 1e-3)
        style = self.style
        frame = QRectF(0, 0, self._width, self._height)
        tint = style.tint(self.shown.colour or (_NOTE_TINT if self.shown.note else ""))
        ground = QColor(style.theme.raised) if tint is None else tint
        ground.setAlpha(255 if self.shown.note else 130)
        border = style.accent if self.selected else QColor(style.theme.line)
        painter.setPen(QPen(border, max(1.4, (2.0 if self.selected else 1.0) / zoom)))
        painter.setBrush(ground)
        painter.drawRoundedRect(frame, 6, 6)
        painter.setPen(QPen(style.faint, 1.4))
        corner = frame.bottomRight()
        for step in (5.0, 10.0):
            painter.drawLine(corner - QPointF(step, 3), corner - QPointF(3, step))
        if self.shown.note:
            self._text(painter, frame.adjusted(_INSET, _INSET, -_INSET, -_INSET), zoom)
            return
        head = self._head(zoom)
        painter.setPen(style.text)
        room = head.adjusted(10, 0, -10, 0) if head.top() >= 0 else head
        size = math.ceil(head.height() * 0.58)
        bold = style.metrics(size, bold=True).horizontalAdvance(self.title) <= room.width()
        painter.setFont(style.sized(size, bold=bold))
        text = painter.fontMetrics().elidedText(
            self.title, Qt.TextElideMode.ElideRight, math.ceil(room.width())
        )
        painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, text)

    def _text(self, painter: QPainter, area: QRectF, zoom: float) -> None:
        readable = round(_READABLE_TITLE_PX * self.style.natural_zoom / zoom)
        painter.setPen(self.style.text)
        for size in range(max(_TEXT, readable), _TEXT - 1, -1):
            painter.setFont(self.style.sized(size))
            if painter.boundingRect(area, _WRAPPED, self.title).height() <= area.height():
                break
        painter.drawText(area, _WRAPPED, self.title)

    def _head(self, zoom: float) -> QRectF:
        """On the ground; or, where letters of that size are too small, larger and above it."""
        height = min(1.7 * _READABLE_TITLE_PX / zoom, _HIGHEST)
        if height <= HEAD:
            return QRectF(0, 0, self._width, HEAD)
        return QRectF(0, -height, self._width, height)
