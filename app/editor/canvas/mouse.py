"""What the mouse does: which gesture begins where; none touches the document before it ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, QSizeF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QToolTip

from app.editor.canvas.content import (
    Hit,
    node_at,
    place_on_wire,
    port_near,
    wires_crossed,
    wires_near,
)
from app.editor.canvas.node_item import SMALLEST, BackdropItem, NodePort
from app.editor.canvas.placing import Surface, insertion_at, whole, with_way_made
from app.editor.canvas.wires import WireItem
from core.editing import backdrops, wiring
from core.editing.operations import Operation, rewire, together
from core.network.network import Link, Network
from core.records import replace

DRAG_PX = 4  # what is moved less is a click


Move = Callable[[QPoint, QPointF], object]
Act = Callable[[], object]


class Gesture:
    """One drag, from the press at a pixel of the view to the release.

    `drag` shows its present position, `drop` does it; `leave` takes away what was only shown, and
    alone gives the gesture up; `click` follows where it was no drag.
    """

    def __init__(
        self,
        surface: Surface,
        pos: QPoint,
        drag: Move,
        drop: Move | None = None,
        leave: Act | None = None,
        click: Act | None = None,
    ) -> None:
        self._point, self._pressed, self._dragging = surface.view.scene_point, pos, False
        self._drag, self._drop, self._leave, self._click = drag, drop, leave, click

    def to(self, pos: QPoint) -> None:
        if (pos - self._pressed).manhattanLength() >= DRAG_PX:
            self._dragging = True
        if self._dragging:
            self._drag(pos, self._point(pos))

    def release(self, pos: QPoint) -> None:
        self.to(pos)
        point = self._point(pos)
        self.leave()
        if self._dragging and self._drop is not None:
            self._drop(pos, point)
        elif not self._dragging and self._click is not None:
            self._click()

    def leave(self) -> None:
        if self._leave is not None:
            self._leave()


def _pan(surface: Surface, pos: QPoint) -> Gesture:
    viewport, last = surface.view.viewport(), pos
    viewport.setCursor(Qt.CursorShape.ClosedHandCursor)

    def drag(now: QPoint, _point: QPointF) -> None:
        nonlocal last
        surface.view.pan(QPointF(now - last))
        last = now

    return Gesture(surface, pos, drag, leave=viewport.unsetCursor)


def _rubber_band(surface: Surface, pos: QPoint, selected: tuple[str, ...]) -> Gesture:
    """Select what lies in a frame, in addition to those that are `selected`."""
    session, content, band = surface.session, surface.content, surface.view.rubber_band
    start, inside = surface.view.scene_point(pos), list[str]()

    def drag(now: QPoint, point: QPointF) -> None:
        band.setGeometry(QRect(pos, now).normalized())
        band.show()
        area, nodes = QRectF(start, point).normalized(), content.nodes.items()
        inside[:] = [name for name, item in nodes if item.frame().intersects(area)]
        content.mark_selected((*selected, *inside))

    def leave() -> None:
        band.hide()
        content.mark_selected(session.selection)

    def drop(*_: object) -> None:
        session.select((*selected, *inside))

    return Gesture(surface, pos, drag, drop, leave, drop)


def _cut(surface: Surface, pos: QPoint) -> Gesture:
    content, start = surface.content, surface.view.scene_point(pos)

    def drag(_pos: QPoint, point: QPointF) -> None:
        surface.live.show_cut(start, point, content.style.error)

    def drop(_pos: QPoint, point: QPointF) -> None:
        links = tuple(wire.link for wire in wires_crossed(content, start, point))
        if links:
            label = f"Cut {links[0]}" if len(links) == 1 else f"Cut {len(links)} wires"
            surface.session.do(rewire(remove=links, label=label))

    return Gesture(surface, pos, drag, drop, partial(surface.live.setVisible, False))


_LEFT, _MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton
_ALT, _SHIFT = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ShiftModifier
_CTRL = Qt.KeyboardModifier.ControlModifier
_VIEWING = _CTRL | _SHIFT


class Mouse:
    """Begins gestures, leads them and ends them. `dropped` is called for wires on empty ground."""

    def __init__(self, surface: Surface, dropped: Dropped) -> None:
        self._surface, self._marks, self._dropped = surface, surface.marks, dropped
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
            add_dot_at(self._surface, hit.wire, point)

    def _begun(self, event: QMouseEvent, pos: QPoint) -> Gesture | None:
        surface, keys = self._surface, event.modifiers()
        if event.button() == _MIDDLE or (event.button() == _LEFT and keys & _ALT):
            cutting = event.button() == _LEFT and keys & _SHIFT
            return _cut(surface, pos) if cutting else _pan(surface, pos)
        if event.button() != _LEFT:
            return None
        hit = surface.hit(surface.view.scene_point(pos))
        adding = bool(keys & (_SHIFT | _CTRL))
        if hit.port is not None:
            return _wire_drag(surface, pos, hit.port, self._dropped)
        if hit.node is not None:
            return self._on_node(hit.node.id, pos, adding, showing=keys == _VIEWING)
        self._marks.choose(hit.wire.link if hit.wire else None, hit.backdrop, hit.dot)
        if hit.wire is not None:
            surface.session.select(())
            return None if hit.dot is None else _dot_drag(surface, pos, hit.wire, hit.dot)
        if hit.backdrop is not None:
            surface.session.select(())
            if hit.handle:
                return _backdrop_resize(surface, pos, hit.backdrop)
            names = backdrops.nodes_on(
                surface.session.network, hit.backdrop.index, surface.content.sizes()
            )
            return _node_drag(surface, pos, names, hit.backdrop)
        return _rubber_band(surface, pos, surface.session.selection if adding else ())

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
        return _node_drag(self._surface, pos, session.selection, grabbed=grabbed)


# Drawing a wire with the mouse, from a port to another one or to empty ground.

# What is done with a wire that ends on empty ground: its fixed end, the wire it was before, where.
Dropped = Callable[[NodePort, Link | None, QPoint], None]


def _wire_drag(surface: Surface, pos: QPoint, port: NodePort, dropped: Dropped) -> Gesture:
    """Draw a wire from a port, or pick one up at an input; `dropped` ends it on empty ground."""
    session, content, viewport = surface.session, surface.content, surface.view.viewport()
    at_input = content.wires_at(port.node.id) if port.side == "input" else ()
    carried = next((wire for wire in at_input if wire.input_port is port), None)
    fixed: NodePort = carried.output_port if carried is not None else port
    old = carried.link if carried is not None else None
    without = session.network if old is None else rewire(remove=(old,)).apply(session.network)
    begun = False

    def refused(other: NodePort) -> str | None:
        if other.side == fixed.side:
            return f"a wire connects an output to an input; {other.name} is another {other.side}"
        return wiring.refusal(without, session.library, link_between(fixed, other))

    def target(point: QPointF) -> tuple[NodePort | None, str | None]:
        near, node = port_near(content, point, surface.view.zoom), node_at(content, point)
        if near is not None and near is not fixed:
            return near, refused(near)
        if near is fixed or node is None or node is fixed.node:
            return None, None
        if carried is not None and node is carried.input_port.node:
            return carried.input_port, None
        others = [other for other in node.ports.values() if other.side != fixed.side]
        return _fitting(node.id, [other for other in others if refused(other) is None], fixed)

    def mark(fits: Callable[[NodePort], bool | None]) -> None:
        for item in content.nodes.values():
            for other in item.ports.values():
                other.fits = fits(other)
            item.update()

    def drag(pos: QPoint, point: QPointF) -> None:
        nonlocal begun
        if carried is not None:
            carried.setVisible(False)
        if not begun:
            begun = True
            mark(lambda other: None if other is fixed else not refused(other))
        found, why_not = target(point)
        end = found.centre() if found is not None and not why_not else point
        ends = (fixed.centre(), end) if fixed.side == "output" else (end, fixed.centre())
        style = content.style
        surface.live.show_wire(*ends, style.error if why_not else style.port(fixed.types))
        QToolTip.showText(viewport.mapToGlobal(pos), why_not or "", viewport)
        shape = Qt.CursorShape.ForbiddenCursor if why_not else Qt.CursorShape.CrossCursor
        viewport.setCursor(shape)

    def drop(pos: QPoint, point: QPointF) -> None:
        found, why_not = target(point)
        if why_not:
            session.message.emit("error", why_not)
        elif found is not None:
            new = link_between(fixed, found)
            session.do(rewire(add=(new,), remove=(old,) if old else (), label=f"Connect {new}"))
        else:
            dropped(fixed, old, pos)

    def leave() -> None:
        surface.live.setVisible(False)
        QToolTip.hideText()
        viewport.unsetCursor()
        if carried is not None:
            carried.setVisible(True)
        mark(lambda _: None)

    return Gesture(surface, pos, drag, drop, leave)


def _fitting(
    node: str, fitting: Sequence[NodePort], fixed: NodePort
) -> tuple[NodePort | None, str | None]:
    """The first of a node's ports that fit, of inputs one that is free; else why there is none."""
    free = [other for other in fitting if not (other.wires and other.side == "input")]
    if fitting:
        return (free or fitting)[0], None
    side = "input" if fixed.side == "output" else "output"
    return None, f"{node} has no {side} for {' or '.join(fixed.types) or 'this wire'}"


def link_between(one: NodePort, other: NodePort) -> Link:
    output, entry = (one, other) if one.side == "output" else (other, one)
    return Link(output.node.id, output.name, entry.node.id, entry.name)


# Moving nodes and backdrops with the mouse.


def _node_drag(
    surface: Surface,
    pos: QPoint,
    names: Iterable[str],
    backdrop: BackdropItem | None = None,
    grabbed: str = "",
) -> Gesture:
    """Move nodes, or a backdrop with its nodes; a click selects the node `grabbed` alone."""
    session, nodes, start = surface.session, surface.content.nodes, surface.view.scene_point(pos)
    places = {name: nodes[name].pos() for name in names if name in nodes}
    alone = next(iter(places), "")
    frame = backdrop.frame() if backdrop is not None else QRectF()
    target: WireItem | None = None
    inserting: Operation | None = None

    def mark(wire: WireItem | None) -> None:
        nonlocal target
        for each, on in ((target, False), (wire, True)):
            if each is not None:
                each.set_state(target=on)
        target = wire

    def drag(_pos: QPoint, point: QPointF) -> None:
        nonlocal inserting
        by = point - start
        surface.content.place({name: at + by for name, at in places.items()})
        if backdrop is not None:
            backdrop.place(frame.translated(by))
        elif len(places) == 1:
            wire, inserting = insertion_at(surface, alone, point) or (None, None)
            mark(wire)

    def drop(_pos: QPoint, point: QPointF) -> None:
        by, network = point - start, session.network
        there = {name: at + by for name, at in places.items()}
        if backdrop is not None:
            operation = moved_together(network, backdrop, frame.translated(by), there)
        else:
            operation = moved(network, there)
        if inserting is not None:
            operation = together((operation, inserting), inserting.text)
            operation = with_way_made(surface, operation, alone)
        session.do(operation)

    def leave() -> None:
        mark(None)
        surface.content.restore()

    def click() -> None:
        """Of several selected nodes the clicked one stays."""
        if grabbed:
            session.select([grabbed])

    return Gesture(surface, pos, drag, drop, leave, click)


def _backdrop_resize(surface: Surface, pos: QPoint, backdrop: BackdropItem) -> Gesture:
    session, frame, start = surface.session, backdrop.frame(), surface.view.scene_point(pos)

    def resized(point: QPointF) -> QRectF:
        by = point - start
        size = frame.size() + QSizeF(by.x(), by.y())
        return QRectF(frame.topLeft(), size.expandedTo(SMALLEST))

    def drag(_pos: QPoint, point: QPointF) -> None:
        backdrop.place(resized(point))

    def drop(_pos: QPoint, point: QPointF) -> None:
        changed = backdrop_at(backdrop.shown, resized(point))
        session.do(backdrops.change(session.network, backdrop.index, changed))

    return Gesture(surface, pos, drag, drop, surface.content.restore)


def moved_together(
    network: Network, backdrop: BackdropItem, frame: QRectF, places: Mapping[str, QPointF]
) -> Operation:
    ground = backdrops.change(network, backdrop.index, backdrop_at(backdrop.shown, frame))
    return together((ground, moved(network, places)), f"Move {backdrop.title or 'backdrop'}")


def moved(network: Network, places: Mapping[str, QPointF]) -> Operation:
    return backdrops.moved_with_dots(network, {name: whole(at) for name, at in places.items()})


def backdrop_at(backdrop: backdrops.Backdrop, frame: QRectF) -> backdrops.Backdrop:
    x, y = whole(frame.topLeft())
    size = frame.size().expandedTo(SMALLEST)
    width, height = float(round(size.width())), float(round(size.height()))
    return replace(backdrop, x=x, y=y, width=width, height=height)


# Dots of wires: dragged with the mouse, moved by the arrows, put in by double-click or key.

_REACH_PX = 12.0


def _dot_drag(surface: Surface, pos: QPoint, wire: WireItem, index: int) -> Gesture:
    session, link = surface.session, wire.link
    before = wire.dots[index] - surface.view.scene_point(pos)

    def drag(_pos: QPoint, point: QPointF) -> None:
        surface.content.place_dot(link, index, before + point)

    def drop(_pos: QPoint, point: QPointF) -> None:
        session.do(backdrops.move_dot(session.network, link, index, whole(before + point)))

    return Gesture(surface, pos, drag, drop, surface.content.restore)


# What is done at once, without a drag, with dots of the wire that is selected.


def add_dot_at(surface: Surface, wire: WireItem, point: QPointF) -> None:
    index = place_on_wire(wire, point)
    session, link = surface.session, wire.link
    if session.do(backdrops.add_dot(session.network, link, index, whole(point))):
        session.select(())
        surface.marks.choose(link, None, index)


def add_dot(surface: Surface, pos: QPoint | None) -> None:
    """Bend the wire at a pixel, else the selected one, else the first at the selected node."""
    if pos is not None:
        point = surface.view.scene_point(pos)
        for wire in wires_near(surface.content, point, _REACH_PX / surface.view.zoom):
            add_dot_at(surface, wire, point)
            return
    chosen = surface.marks.wire
    if chosen is None:
        for name in surface.session.selection[-1:]:
            wires = surface.content.wires_at(name)
            chosen = min(wires, key=lambda wire: wire.link.source != name, default=None)
    if chosen is None:
        text = "point at a wire or select one to bend it with a dot"
        surface.session.message.emit("note", text)
        return
    line = chosen.line()
    add_dot_at(surface, chosen, line[len(line) // 2])


def remove_dot(surface: Surface) -> bool:
    """Take the selected dot away; whether there was one."""
    session, link, dot = surface.session, surface.marks.link, surface.marks.dot
    if link is not None and dot is not None:
        surface.marks.choose(link, None)
        session.do(backdrops.remove_dot(session.network, link, dot))
    return dot is not None


def nudge_dot(surface: Surface, by: QPointF) -> bool:
    """Move the selected dot, with others of the same key as one step; whether there is one."""
    session, wire, dot = surface.session, surface.marks.wire, surface.marks.dot
    if wire is not None and dot is not None:
        moving = backdrops.move_dot(session.network, wire.link, dot, whole(wire.dots[dot] + by))
        session.do(moving, gesture=("dot", wire.link, dot))
    return dot is not None
