"""Dots of wires: dragged with the mouse, moved by the arrows, put in by double-click or key."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QPointF

from app.editor.canvas.hands.gestures import Gesture, Surface, whole
from app.editor.canvas.items.hits import place_on_wire, wires_near
from app.editor.canvas.items.marks import Marks
from app.editor.canvas.items.wire_item import WireItem
from core.editing.wire_dots import add_dot, move_dot, remove_dot, straighten

_REACH_PX = 12.0


class DragDot(Gesture):
    def __init__(self, surface: Surface, pos: QPoint, wire: WireItem, index: int) -> None:
        super().__init__(surface, pos)
        self._link, self._index = wire.link, index
        self._from = wire.dots[index]

    def drag(self, _pos: QPoint, point: QPointF) -> None:
        at = self._from + point - self.start
        self.surface.content.place_dot(self._link, self._index, at)

    def drop(self, _pos: QPoint, point: QPointF) -> None:
        session, at = self.surface.session, self._from + point - self.start
        session.do(move_dot(session.network, self._link, self._index, whole(at)))

    def leave(self) -> None:
        self.surface.content.restore()


class Dots:
    """What is done at once, without a drag, with dots of the wire that is selected."""

    def __init__(self, surface: Surface, marks: Marks) -> None:
        self._surface = surface
        self._marks = marks

    def add_at(self, wire: WireItem, point: QPointF) -> None:
        index = place_on_wire(wire, point)
        session, link = self._surface.session, wire.link
        if session.do(add_dot(session.network, link, index, whole(point))):
            session.select(())
            self._marks.choose(link, None, index)

    def add(self, pos: QPoint | None) -> None:
        """Put a dot on the wire under the pointer, else in the middle of the selected wire.

        Else of the first wire that leaves the selected node: so it can be done by keys alone.
        """
        surface = self._surface
        if pos is not None:
            point = surface.view.scene_point(pos)
            for wire in wires_near(surface.content, point, _REACH_PX / surface.view.zoom):
                self.add_at(wire, point)
                return
        chosen = self._chosen_wire()
        if chosen is None:
            session = surface.session
            session.message.emit("note", "point at a wire or select one, to bend it with a dot")
            return
        line = chosen.line()
        self.add_at(chosen, line[len(line) // 2])

    def remove(self) -> bool:
        """Take the selected dot away; whether there was one."""
        session, link, dot = self._surface.session, self._marks.link, self._marks.dot
        if link is None or dot is None:
            return False
        self._marks.choose(link, None)
        session.do(remove_dot(session.network, link, dot))
        return True

    def straighten(self) -> None:
        session, link = self._surface.session, self._marks.link
        if link is not None:
            self._marks.choose(link, None)
            session.do(straighten(session.network, (link,), f"Straighten {link}"))

    def nudge(self, by: QPointF) -> bool:
        """Move the selected dot, with others of the same key as one step; whether there is one."""
        session, link, dot = self._surface.session, self._marks.link, self._marks.dot
        if link is None or dot is None:
            return False
        at = self._surface.content.wires[link].dots[dot] + by
        moving = move_dot(session.network, link, dot, (at.x(), at.y()))
        session.do(moving, gesture=("dot", link, dot))
        return True

    def _chosen_wire(self) -> WireItem | None:
        content = self._surface.content
        if self._marks.link is not None:
            return content.wires[self._marks.link]
        for name in self._surface.session.selection[-1:]:
            wires = content.wires_at(name)
            leaving = [wire for wire in wires if wire.link.source == name]
            return next(iter((*leaving, *wires)), None)
        return None
