"""What the mouse does: which gesture begins where; none touches the document before it ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, QSizeF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QToolTip

from app.editor.canvas.content import (
    Hit,
    Marks,
    node_at,
    place_on_wire,
    port_near,
    wires_crossed,
    wires_near,
)
from app.editor.canvas.node_item import SMALLEST, BackdropItem, NodePort
from app.editor.canvas.placing import Surface, insertion_at, whole, with_way_made
from app.editor.canvas.wires import WireItem
from core.editing import backdrops
from core.editing.backdrops import Backdrop
from core.editing.operations import Operation, rewire, together
from core.editing.wiring import refusal
from core.network.network import Link, Network
from core.records import replace

DRAG_PX = 4  # what is moved less is a click


class Gesture:
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

    def drag(self, pos: QPoint, point: QPointF) -> None:
        """Show its present position."""

    def drop(self, pos: QPoint, point: QPointF) -> None:
        """Do it."""

    def leave(self) -> None:
        """Take away what was only shown; alone, it gives the gesture up."""

    def click(self) -> None:
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


_LEFT, _MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton
_ALT, _SHIFT = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ShiftModifier
_CTRL = Qt.KeyboardModifier.ControlModifier
_VIEWING = _CTRL | _SHIFT


class Mouse:
    """Begins gestures, leads them and ends them. `dropped` is called for wires on empty ground."""

    def __init__(self, surface: Surface, marks: Marks, dots: Dots, dropped: Dropped) -> None:
        self._dots, self._dropped = dots, dropped
        self._surface, self._marks = surface, marks
        self._gesture: Gesture | None = None
        self._button = Qt.MouseButton.NoButton

    @property
    def busy(self) -> bool:
        return self._gesture is not None

    def press(self, event: QMouseEvent) -> None:
        self._surface.pointer = event.position().toPoint()
        self._surface.view.setFocus(Qt.FocusReason.MouseFocusReason)
        if self._gesture is not None:
            return
        self._marks.hover(Hit())
        self._gesture = self._begun(event, event.position().toPoint())
        self._button = event.button()

    def move(self, event: QMouseEvent) -> None:
        self._surface.pointer = pos = event.position().toPoint()
        if self._gesture is not None:
            self._gesture.to(pos)
        elif event.buttons() == Qt.MouseButton.NoButton:
            self._marks.hover(self._surface.hit(self._surface.view.scene_point(pos)))

    def release(self, event: QMouseEvent) -> None:
        self._surface.pointer = pos = event.position().toPoint()
        if self._gesture is not None and event.button() == self._button:
            gesture, self._gesture = self._gesture, None
            gesture.release(pos)

    def cancel(self) -> None:
        if self._gesture is not None:
            gesture, self._gesture = self._gesture, None
            gesture.leave()

    def leave(self) -> None:
        self._surface.pointer = None
        if self._gesture is None:
            self._marks.hover(Hit())

    def double_click(self, event: QMouseEvent) -> None:
        if event.button() != _LEFT or self._gesture is not None:
            return
        point = self._surface.view.scene_point(event.position())
        hit = self._surface.hit(point)
        if hit.node is not None:
            self._surface.activated.emit(hit.node.id)
        elif hit.backdrop is not None:
            self._surface.title_wanted.emit(hit.backdrop.index)
        elif hit.wire is None:
            self._surface.search_wanted.emit(point)
        elif hit.dot is None:
            self._dots.add_at(hit.wire, point)

    def _begun(self, event: QMouseEvent, pos: QPoint) -> Gesture | None:
        surface, keys = self._surface, event.modifiers()
        if event.button() == _MIDDLE or (event.button() == _LEFT and keys & _ALT):
            cutting = event.button() == _LEFT and keys & _SHIFT
            return Cut(surface, pos) if cutting else Pan(surface, pos)
        if event.button() != _LEFT:
            return None
        hit = surface.hit(surface.view.scene_point(pos))
        adding = bool(keys & (_SHIFT | _CTRL))
        if hit.port is not None:
            return DragWire(surface, pos, hit.port, self._dropped)
        if hit.node is not None:
            return self._on_node(hit.node.id, pos, adding, showing=keys == _VIEWING)
        self._marks.choose(hit.wire.link if hit.wire else None, hit.backdrop, hit.dot)
        if hit.wire is not None:
            surface.session.select(())
            return None if hit.dot is None else DragDot(surface, pos, hit.wire, hit.dot)
        if hit.backdrop is not None:
            surface.session.select(())
            if hit.handle:
                return ResizeBackdrop(surface, pos, hit.backdrop)
            names = backdrops.nodes_on(
                surface.session.network, hit.backdrop.index, surface.content.sizes()
            )
            return DragNodes(surface, pos, names, hit.backdrop)
        return RubberBand(surface, pos, surface.session.selection if adding else ())

    def _on_node(self, name: str, pos: QPoint, adding: bool, *, showing: bool) -> Gesture | None:
        session = self._surface.session
        self._marks.choose(None, None)
        selected = session.selection
        if showing:
            session.select([name])
            self._surface.view_wanted.emit(name)
            return None
        if adding:
            others = tuple(other for other in selected if other != name)
            session.select(others if name in selected else (*selected, name))
            if name in selected:
                return None
        elif name not in selected:
            session.select([name])
        grabbed = "" if adding else name
        return DragNodes(self._surface, pos, session.selection, grabbed=grabbed)


# Drawing a wire with the mouse, from a port to another one or to empty ground.

# What is done with a wire that ends on empty ground: its fixed end, the wire it was before, where.
Dropped = Callable[[NodePort, Link | None, QPoint], None]


class DragWire(Gesture):
    """Draw a wire from a port, or pick one up at an input; `dropped` ends it on empty ground."""

    def __init__(self, surface: Surface, pos: QPoint, port: NodePort, dropped: Dropped) -> None:
        super().__init__(surface, pos)
        at_input = surface.content.wires_at(port.node.id) if port.side == "input" else ()
        self._carried = next((wire for wire in at_input if wire.input_port is port), None)
        self._fixed: NodePort = self._carried.output_port if self._carried else port
        self._dropped = dropped
        self._network = surface.session.network
        if self._carried is not None:
            self._network = rewire(remove=(self._carried.link,)).apply(self._network)
        self._begun = False

    def drag(self, pos: QPoint, point: QPointF) -> None:
        surface = self.surface
        if self._carried is not None:
            self._carried.setVisible(False)
        if not self._begun:
            self._mark(lambda port: None if port is self._fixed else not self._refusal(port))
        port, refused = self._target(point)
        end = port.centre() if port is not None and not refused else point
        ends = (self._fixed.centre(), end)
        if self._fixed.side == "input":
            ends = (end, self._fixed.centre())
        style = surface.content.style
        colour = style.error if refused else style.port(self._fixed.types)
        surface.live.show_wire(*ends, colour)
        viewport = surface.view.viewport()
        QToolTip.showText(viewport.mapToGlobal(pos), refused or "", viewport)
        shape = Qt.CursorShape.ForbiddenCursor if refused else Qt.CursorShape.CrossCursor
        viewport.setCursor(shape)

    def drop(self, pos: QPoint, point: QPointF) -> None:
        session = self.surface.session
        old = self._carried.link if self._carried is not None else None
        port, refused = self._target(point)
        if refused:
            session.message.emit("error", refused)
        elif port is not None:
            new = link_between(self._fixed, port)
            session.do(rewire(add=(new,), remove=(old,) if old else (), label=f"Connect {new}"))
        else:
            self._dropped(self._fixed, old, pos)

    def leave(self) -> None:
        surface = self.surface
        surface.live.setVisible(False)
        QToolTip.hideText()
        surface.view.viewport().unsetCursor()
        if self._carried is not None:
            self._carried.setVisible(True)
        self._mark(lambda _: None)

    def _mark(self, fits: Callable[[NodePort], bool | None]) -> None:
        self._begun = True
        for item in self.surface.content.nodes.values():
            for port in item.ports.values():
                port.fits = fits(port)
            item.update()

    def _target(self, point: QPointF) -> tuple[NodePort | None, str | None]:
        content = self.surface.content
        port = port_near(content, point, self.surface.view.zoom)
        if port is self._fixed:
            return None, None
        if port is not None:
            return port, self._refusal(port)
        node = node_at(content, point)
        if node is None or node is self._fixed.node:
            return None, None
        if self._carried is not None and node is self._carried.input_port.node:
            return self._carried.input_port, None
        others = [other for other in node.ports.values() if other.side != self._fixed.side]
        fitting = [other for other in others if self._refusal(other) is None]
        free = [other for other in fitting if not (other.wires and other.side == "input")]
        if fitting:
            return (free or fitting)[0], None
        side = "input" if self._fixed.side == "output" else "output"
        kinds = " or ".join(self._fixed.types) or "this wire"
        return None, f"{node.id} has no {side} for {kinds}"

    def _refusal(self, port: NodePort) -> str | None:
        if port.side == self._fixed.side:
            return f"a wire connects an output to an input; {port.name} is another {port.side}"
        link = link_between(self._fixed, port)
        return refusal(self._network, self.surface.session.library, link)


def link_between(one: NodePort, other: NodePort) -> Link:
    output, entry = (one, other) if one.side == "output" else (other, one)
    return Link(output.node.id, output.name, entry.node.id, entry.name)


# Moving nodes and backdrops with the mouse.


class DragNodes(Gesture):
    """Move nodes, or a backdrop with its nodes; a click selects the node `grabbed` alone."""

    def __init__(
        self,
        surface: Surface,
        pos: QPoint,
        names: Iterable[str],
        backdrop: BackdropItem | None = None,
        grabbed: str = "",
    ) -> None:
        super().__init__(surface, pos)
        nodes = surface.content.nodes
        self._from = {name: nodes[name].pos() for name in names if name in nodes}
        self._backdrop = backdrop
        self._frame = backdrop.frame() if backdrop is not None else QRectF()
        self._grabbed = grabbed
        self._target: WireItem | None = None
        self._inserting: Operation | None = None

    def drag(self, _pos: QPoint, point: QPointF) -> None:
        by = point - self.start
        self.surface.content.place({name: at + by for name, at in self._from.items()})
        if self._backdrop is not None:
            self._backdrop.place(self._frame.translated(by))
        elif len(self._from) == 1:
            (name,) = self._from
            wire, self._inserting = insertion_at(self.surface, name, point) or (None, None)
            self._mark(wire)

    def drop(self, _pos: QPoint, point: QPointF) -> None:
        by = point - self.start
        session = self.surface.session
        places = {name: at + by for name, at in self._from.items()}
        if self._backdrop is not None:
            frame = self._frame.translated(by)
            operation = moved_together(session.network, self._backdrop, frame, places)
        else:
            operation = moved(session.network, places)
        if self._inserting is not None:
            operation = together((operation, self._inserting), self._inserting.text)
            (name,) = self._from
            operation = with_way_made(self.surface, operation, name)
        session.do(operation)

    def click(self) -> None:
        """Of several selected nodes the clicked one stays."""
        if self._grabbed:
            self.surface.session.select([self._grabbed])

    def leave(self) -> None:
        self._mark(None)
        self.surface.content.restore()

    def _mark(self, wire: WireItem | None) -> None:
        if self._target is not None:
            self._target.set_state(target=False)
        self._target = wire
        if wire is not None:
            wire.set_state(target=True)


class ResizeBackdrop(Gesture):
    def __init__(self, surface: Surface, pos: QPoint, backdrop: BackdropItem) -> None:
        super().__init__(surface, pos)
        self._backdrop = backdrop
        self._frame = backdrop.frame()

    def drag(self, _pos: QPoint, point: QPointF) -> None:
        self._backdrop.place(self._resized(point))

    def drop(self, _pos: QPoint, point: QPointF) -> None:
        session = self.surface.session
        changed = backdrop_at(self._backdrop.shown, self._resized(point))
        session.do(backdrops.change(session.network, self._backdrop.index, changed))

    def leave(self) -> None:
        self.surface.content.restore()

    def _resized(self, point: QPointF) -> QRectF:
        by = point - self.start
        size = QSizeF(self._frame.width() + by.x(), self._frame.height() + by.y())
        return QRectF(self._frame.topLeft(), size.expandedTo(SMALLEST))


def moved_together(
    network: Network, backdrop: BackdropItem, frame: QRectF, places: Mapping[str, QPointF]
) -> Operation:
    ground = backdrops.change(network, backdrop.index, backdrop_at(backdrop.shown, frame))
    return together((ground, moved(network, places)), f"Move {backdrop.title or 'backdrop'}")


def moved(network: Network, places: Mapping[str, QPointF]) -> Operation:
    return backdrops.moved_with_dots(network, {name: whole(at) for name, at in places.items()})


def backdrop_at(backdrop: Backdrop, frame: QRectF) -> Backdrop:
    x, y = whole(frame.topLeft())
    size = frame.size().expandedTo(SMALLEST)
    width, height = float(round(size.width())), float(round(size.height()))
    return replace(backdrop, x=x, y=y, width=width, height=height)


# Dots of wires: dragged with the mouse, moved by the arrows, put in by double-click or key.

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
        session.do(backdrops.move_dot(session.network, self._link, self._index, whole(at)))

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
        if session.do(backdrops.add_dot(session.network, link, index, whole(point))):
            session.select(())
            self._marks.choose(link, None, index)

    def add(self, pos: QPoint | None) -> None:
        """Bend the wire at a pixel, else the selected one, else the first at the selected node."""
        surface = self._surface
        if pos is not None:
            point = surface.view.scene_point(pos)
            for wire in wires_near(surface.content, point, _REACH_PX / surface.view.zoom):
                self.add_at(wire, point)
                return
        chosen = self._marks.wire
        if chosen is None:
            for name in surface.session.selection[-1:]:
                wires = surface.content.wires_at(name)
                chosen = min(wires, key=lambda wire: wire.link.source != name, default=None)
        if chosen is None:
            text = "point at a wire or select one to bend it with a dot"
            surface.session.message.emit("note", text)
            return
        line = chosen.line()
        self.add_at(chosen, line[len(line) // 2])

    def remove(self) -> bool:
        """Take the selected dot away; whether there was one."""
        session, link, dot = self._surface.session, self._marks.link, self._marks.dot
        if link is not None and dot is not None:
            self._marks.choose(link, None)
            session.do(backdrops.remove_dot(session.network, link, dot))
        return dot is not None

    def nudge(self, by: QPointF) -> bool:
        """Move the selected dot, with others of the same key as one step; whether there is one."""
        session, wire, dot = self._surface.session, self._marks.wire, self._marks.dot
        if wire is not None and dot is not None:
            moving = backdrops.move_dot(session.network, wire.link, dot, whole(wire.dots[dot] + by))
            session.do(moving, gesture=("dot", wire.link, dot))
        return dot is not None
