"""A node on the canvas."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QPointF, QRectF, QSizeF
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from app.editor.canvas.badge_item import INSET, BadgeItem
from app.editor.canvas.faces import NodeFace, PortFace, Side
from app.editor.canvas.geometry import NodeGeometry, geometry_of
from app.editor.canvas.node_painting import paint_node
from app.editor.canvas.nodegraphqt import AbstractNodeItem, PortItem
from app.editor.canvas.routing import Box
from app.editor.canvas.style import CanvasStyle
from app.editor.evaluation.wants import Badge

_MARGIN = 8.0  # what is drawn around the frame: ports, the mark of the selection


class NodePort(PortItem):
    """Where wires end; drawn by its node, which saves a call for each port.

    Its point is its centre. `fits` says whether a wire that is being drawn may end here, None
    while there is none.
    """

    def __init__(self, face: PortFace, parent: NodeItem) -> None:
        super().__init__(parent)
        self.face = face
        self.name = face.name
        self.port_type = "in" if face.side == "input" else "out"
        self.fits: bool | None = None
        self.hovered = False
        self.wires = 0
        self.setCacheMode(QGraphicsItem.CacheMode.NoCache)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents, True)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemSendsScenePositionChanges, False)
        self.setAcceptHoverEvents(False)
        self.setToolTip(face.tooltip)

    def boundingRect(self) -> QRectF:
        """Where the pointer meets it."""
        return _PORT_RECT

    def centre(self) -> QPointF:
        """Its point in the scene."""
        return self.scenePos()


class NodeItem(AbstractNodeItem):
    """A node drawn from its face.

    Parameters
    ----------
    face : NodeFace
        What it shows.
    style : CanvasStyle
        What it is drawn with.
    """

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
        self._bounds = self.geometry.frame.adjusted(-_MARGIN, -_MARGIN, _MARGIN, _MARGIN)
        self.ports: dict[tuple[Side, str], NodePort] = {}
        for port in (*face.inputs, *face.outputs):
            item = NodePort(port, self)
            item.setPos(self.geometry.ports[port.side, port.name])
            self.ports[port.side, port.name] = item
        self._badge: BadgeItem | None = None
        self.setToolTip(face.tooltip)

    def boundingRect(self) -> QRectF:
        """The frame with what stands out from it."""
        return self._bounds

    def frame(self) -> QRectF:
        """The frame in the scene."""
        return QRectF(self.pos(), QSizeF(self._width, self._height))

    def box(self) -> Box:
        """The frame in the scene, as plain numbers."""
        x, y = self.x(), self.y()
        return x, y, x + self._width, y + self._height

    def paint(
        self,
        painter: QPainter,
        _option: QStyleOptionGraphicsItem,
        _widget: QWidget | None = None,
    ) -> None:
        """Draw the node with its ports."""
        paint_node(painter, self)

    @property
    def badge(self) -> Badge | None:
        """What the node's corner tells of its state."""
        return self._badge.badge if self._badge is not None else None

    def set_badge(self, badge: Badge | None) -> None:
        """Show a badge in the corner, or none."""
        if badge == self.badge:
            return
        if badge is None:
            assert self._badge is not None
            self._drop(self._badge)
            self._badge = None
        elif self._badge is None:
            self._badge = BadgeItem(badge, self.style, self)
            self._badge.setPos(self._width - INSET, INSET)
        else:
            self._badge.show_badge(badge)

    def take_face(self, face: NodeFace) -> bool:
        """Show another face, if it has the same texts and ports; whether it has."""
        shown = self.face
        if replace(face, disabled=shown.disabled, output=shown.output) != shown:
            return False
        if face != self.face:
            self.face = face
            self.disabled = face.disabled
            self.setToolTip(face.tooltip)
            self.update()
        return True

    def set_style(self, style: CanvasStyle) -> None:
        """Draw it in other colours."""
        self.style = style
        if self._badge is not None:
            self._badge.style = style
        self.update()

    def _drop(self, child: QGraphicsItem) -> None:
        self.scene().removeItem(child)  # which takes it from this item, too


_PORT_RECT = QRectF(-8, -7, 16, 14)
