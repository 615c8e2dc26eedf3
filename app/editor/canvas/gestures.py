"""What is done with a mouse button held down. None touches the document before it ends."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable

from PySide6.QtCore import QObject, QPoint, QPointF, QRect, QRectF, Qt, Signal

from app.editor.canvas.canvas_view import GraphView
from app.editor.canvas.content import Content, Hit, hit, wires_crossed
from app.editor.canvas.wires import LiveWire
from app.editor.session import Level, Session
from core.editing.layout import Point
from core.editing.operations import rewire

DRAG_PX = 4  # what is moved less is a click


class Gesture(ABC):
    """One drag, from the press at a pixel of the view to the release."""

    def __init__(self, surface: Surface, pos: QPoint) -> None:
        self.surface = surface
        self.pressed = pos
        self.start = surface.view.scene_point(pos)
        self.dragging = False

    def to(self, pos: QPoint) -> None:
        if not self.dragging and (pos - self.pressed).manhattanLength() >= DRAG_PX:
            self.dragging = True
        if self.dragging:
            self.drag(pos, self.surface.view.scene_point(pos))

    def release(self, pos: QPoint) -> None:
        self.to(pos)
        point = self.surface.view.scene_point(pos)
        self.leave()
        if self.dragging:
            self.drop(pos, point)
        else:
            self.click()

    @abstractmethod
    def drag(self, pos: QPoint, point: QPointF) -> None:
        """Show its present position."""

    def drop(self, pos: QPoint, point: QPointF) -> None:  # noqa: B027 - a pan has moved the view
        """Do it."""

    @abstractmethod
    def leave(self) -> None:
        """Take away what was only shown; alone, it gives the gesture up."""

    def click(self) -> None:  # noqa: B027 - most gestures have no click
        """It was no drag."""


class Pan(Gesture):
    def __init__(self, surface: Surface, pos: QPoint) -> None:
        super().__init__(surface, pos)
        self._last = pos
        surface.view.viewport().setCursor(Qt.CursorShape.ClosedHandCursor)

    def drag(self, pos: QPoint, _point: QPointF) -> None:
        self.surface.view.pan(QPointF(pos - self._last))
        self._last = pos

    def leave(self) -> None:
        self.surface.view.viewport().unsetCursor()


class RubberBand(Gesture):
    """Select what lies in a frame, in addition to those `already_selected`."""

    def __init__(self, surface: Surface, pos: QPoint, already_selected: Iterable[str] = ()) -> None:
        super().__init__(surface, pos)
        self._already_selected = tuple(already_selected)
        self._inside: tuple[str, ...] = ()

    def drag(self, pos: QPoint, point: QPointF) -> None:
        band = self.surface.view.rubber_band
        band.setGeometry(QRect(self.pressed, pos).normalized())
        band.show()
        area = QRectF(self.start, point).normalized()
        nodes = self.surface.content.nodes
        self._inside = tuple(name for name, item in nodes.items() if item.frame().intersects(area))
        self.surface.content.mark_selected((*self._already_selected, *self._inside))

    def drop(self, _pos: QPoint, _point: QPointF) -> None:
        self.surface.session.select((*self._already_selected, *self._inside))

    def click(self) -> None:
        self.surface.session.select(self._already_selected)

    def leave(self) -> None:
        self.surface.view.rubber_band.hide()
        self.surface.content.mark_selected(self.surface.session.selection)


class Cut(Gesture):
    def drag(self, _pos: QPoint, point: QPointF) -> None:
        self.surface.live.show_cut(self.start, point, self.surface.content.style.error)

    def drop(self, _pos: QPoint, point: QPointF) -> None:
        links = tuple(wire.link for wire in wires_crossed(self.surface.content, self.start, point))
        if links:
            label = f"Cut {links[0]}" if len(links) == 1 else f"Cut {len(links)} wires"
            self.surface.session.do(rewire(remove=links, label=label))

    def leave(self) -> None:
        self.surface.live.setVisible(False)


class Surface(QObject):
    activated = Signal(str)  # (name): a node was double-clicked, or Enter pressed on it
    view_wanted = Signal(str)  # (name): a node was clicked with Ctrl and Shift
    search_wanted = Signal(QPointF)  # (point): a module is to be added at that point of the scene
    title_wanted = Signal(int)  # (index): a backdrop's title is to be edited
    # (paths, point): files were dropped at a point of the scene
    files_dropped = Signal(list, QPointF)
    preset_dropped = Signal(str, QPointF)  # (key, point): a preset of the library was dropped there

    def __init__(
        self, session: Session | Level, view: GraphView, content: Content, parent: QObject
    ) -> None:
        super().__init__(parent)
        self.session, self.view, self.content = session, view, content
        self.live = LiveWire()
        view.scene().addItem(self.live)
        self.pointer: QPoint | None = None
        """The pixel of the view under the mouse."""

    def cursor_point(self) -> Point:
        pos, view = self.pointer, self.view
        return whole(view.visible_rect().center() if pos is None else view.scene_point(pos))

    def hit(self, point: QPointF) -> Hit:
        return hit(self.content, point, self.view.zoom)


def whole(point: QPointF) -> Point:
    """The point in whole units, as a layout has it."""
    return float(round(point.x())), float(round(point.y()))
