"""The items on the canvas, made to follow a network: only what differs is touched; what is hit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter
from typing import Any, NamedTuple

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene

from app.editor.canvas.canvas_style import (
    INPUT,
    OUTPUT,
    PORT_RADIUS,
    CanvasStyle,
    Side,
    face_of,
)
from app.editor.canvas.node_item import GAP_BESIDE, BackdropItem, NodeItem, NodePort, rect_of
from app.editor.canvas.wires import (
    DOT_RADIUS,
    Ground,
    WireItem,
    course_of,
    length,
    overlap,
    wire_path,
)
from app.editor.evaluation.queries import Badge
from core.editing.backdrops import Backdrop, backdrops_of
from core.editing.layout import Point, hull, is_in_reach
from core.editing.wire_dots import dots_of
from core.modules.declaration import Library
from core.network.macro import SEPARATOR, declared_node, face_of_macro
from core.network.network import Link, Network, Node, topological


class Content:
    """The scene's nodes by id, wires by link and backdrops in order."""

    def __init__(self, scene: QGraphicsScene, library: Library, style: CanvasStyle) -> None:
        self.nodes: dict[str, NodeItem] = {}
        self.wires: dict[Link, WireItem] = {}
        self.backdrops: list[BackdropItem] = []
        self.style = style
        self._scene = scene
        self._library = library
        self._drawn: dict[str, Node] = {}
        self._links: tuple[Link, ...] = ()
        self._points: dict[str, Point] = {}
        self._body = Network()
        self._ground = Ground()
        self._frames: list[QRectF] = []
        self._extra: Mapping[str, Any] | None = None
        self._dots: Mapping[Link, tuple[Point, ...]] = {}
        self._badges: Mapping[str, Badge] = {}
        self._at: dict[str, list[WireItem]] = {}
        self._selected: frozenset[str] = frozenset()
        self._marked: frozenset[str] = frozenset()
        self.ends = MacroEnds(style)
        scene.addItem(self.ends)
        self.on_placed: Callable[[], None] | None = None
        """Called once nodes stand elsewhere, for what stands beside them."""

    def clear(self) -> None:
        self._badges = {}
        self.follow(Network())

    def follow(self, network: Network) -> None:
        links_differ = network.links != self._links
        touched = links_at(network) if links_differ else {}
        for name in [name for name in self.nodes if name not in network.nodes]:
            self._remove_node(name)
        marked = frozenset(name.partition(SEPARATOR)[0] for name in network.output_nodes)
        marked |= frozenset(network.output_nodes)
        remarked = marked ^ self._marked
        self._marked = marked
        for name, node in network.nodes.items():
            if links_differ or name in remarked or self._drawn.get(name) is not node:
                self._follow_node(node, touched.get(name) or [w.link for w in self.wires_at(name)])
        points = points_of(network)
        moved = points != self._points
        if moved:
            self._points = points
            self.place({name: QPointF(*at) for name, at in points.items()})
            for name, item in self.nodes.items():
                item.title_room = self._room_for_title(name)
            # The scene marks later, in a call that waits in its queue, where items were painted
            # last; a part of the view that is painted before makes it forget, and they would stay
            # drawn there.
            for view in self._scene.views():
                view.viewport().update()
        if links_differ or len(self.wires) != len(network.links):
            self._follow_links(network)
            moved = True
        if network.extra is not self._extra or links_differ:
            dots = dots_of(network)
            moved = moved or dots != self._dots
            self._dots = dots
        if moved:
            self.route()
        if moved or network.extra is not self._extra:
            self._body = network
            self.ends.follow(network, self.nodes, self._ground)
        if network.extra is not self._extra:
            self._extra = network.extra
            self._follow_backdrops(backdrops_of(network))

    def wires_at(self, name: str) -> list[WireItem]:
        return self._at.get(name, [])

    def place(self, places: Mapping[str, QPointF]) -> None:
        moved = {name for name, at in places.items() if self.nodes[name].pos() != at}
        for name in moved:
            self.nodes[name].setPos(places[name])
            self._ground.put(name, self.nodes[name].box())
        if moved:
            for wire in {wire for name in moved for wire in self.wires_at(name)}:
                self._lead(wire)
            self.ends.follow(self._body, self.nodes, self._ground)
            if self.on_placed is not None:
                self.on_placed()

    def _room_for_title(self, name: str) -> float:
        """The width of a node, and what of the gaps to its neighbours is its own: half of each."""
        left, top, right, bottom = self._ground.boxes[name]
        gaps = {-1: GAP_BESIDE, 1: GAP_BESIDE}
        for box in self._ground.within((left - GAP_BESIDE, top, right + GAP_BESIDE, bottom)):
            side, gap = (1, box[0] - right) if box[0] >= right else (-1, left - box[2])
            if gap >= 0:
                gaps[side] = min(gaps[side], gap)
        return right - left + min(gaps.values())

    def restore(self) -> None:
        """Put everything back where the network has it, after something was only shown."""
        self.place({name: QPointF(*at) for name, at in self._points.items()})
        for item, frame in zip(self.backdrops, self._frames, strict=True):
            if item.frame() != frame:
                item.place(frame)
        self.route()

    def sizes(self) -> dict[str, tuple[float, float]]:
        return {name: item.size for name, item in self.nodes.items()}

    def route(self) -> None:
        """Lead those wires anew that have dots, and those in whose reach nodes came or went."""
        changed, self._ground.changed = self._ground.changed, None
        for link, wire in self.wires.items():
            reach = wire.reach
            if reach is None or link in self._dots or (changed and overlap(reach, changed)):
                self._lead(wire)

    def place_dot(self, link: Link, index: int, at: QPointF) -> None:
        wire = self.wires[link]
        wire.lead((*wire.dots[:index], at, *wire.dots[index + 1 :]), self._ground)

    def _lead(self, wire: WireItem) -> None:
        """Its dots go along where both its nodes stand elsewhere alike."""
        dots = self._dots.get(wire.link, ())
        ends = (wire.link.source, wire.link.target)
        one, other = (self.nodes[name].pos() - QPointF(*self._points[name]) for name in ends)
        by = one if one == other else QPointF()
        wire.lead([QPointF(*at) + by for at in dots], self._ground)

    def bounds(self, names: Iterable[str] | None = None) -> QRectF:
        """What the nodes take up; of all, the backdrops too. Null where there is nothing."""
        whole, there, reach = QRectF(), self._ground.boxes, QPointF(DOT_RADIUS, DOT_RADIUS)
        boxes = [*there.values()] if names is None else [there[n] for n in names if n in there]
        if boxes:
            left, top, right, bottom = hull(boxes)
            whole = QRectF(left, top, right - left, bottom - top)
        for backdrop in self.backdrops if names is None else ():
            whole = whole.united(backdrop.frame())
        if names is None:
            whole = whole.united(self.ends.boundingRect())
        for wire in self.wires.values() if names is None else ():
            for dot in wire.dots:
                whole = whole.united(QRectF(dot - reach, dot + reach))
        return whole

    def mark_selected(self, names: Iterable[str]) -> None:
        chosen = frozenset(name for name in names if name in self.nodes)
        touched = chosen ^ self._selected
        self._selected = chosen
        for name in touched & self.nodes.keys():
            self.nodes[name].setSelected(name in chosen)
            self.nodes[name].setZValue(2.0 if name in chosen else 1.0)
            for wire in self.wires_at(name):
                wire.set_state(lit=bool({wire.link.source, wire.link.target} & chosen))

    def set_badges(self, badges: Mapping[str, Badge]) -> None:
        self._badges = badges
        for name, item in self.nodes.items():
            item.set_badge(badges.get(name))

    def set_style(self, style: CanvasStyle) -> None:
        self.style = self.ends.style = style
        for node in self.nodes.values():
            node.set_style(style)
        for wire in self.wires.values():
            wire.set_style(style)
        for backdrop in self.backdrops:
            backdrop.set_style(style)

    def _follow_node(self, node: Node, links: list[Link]) -> None:
        declared = declared_node(node, self._library)
        face = face_of(node, declared, links, output=node.id in self._marked)
        old = self.nodes.get(node.id)
        was_disabled = old is not None and old.face.disabled
        self._drawn[node.id] = node
        if old is not None and old.take_face(face):
            if old.face.disabled != was_disabled:
                for wire in self.wires_at(node.id):
                    wire.update()
            return
        item = NodeItem(face, self.style)
        if old is not None:
            item.setPos(old.pos())
            self._remove_node(node.id)
            self._drawn[node.id] = node
        item.set_badge(self._badges.get(node.id))
        if node.id in self._selected:
            item.setSelected(True)
        self.nodes[node.id] = item
        self._ground.put(node.id, item.box())
        self._scene.addItem(item)

    def _follow_links(self, network: Network) -> None:
        wanted = set(network.links)
        for wire in [wire for link, wire in self.wires.items() if link not in wanted]:
            self._remove_wire(wire)
        for link in network.links:
            if link not in self.wires and {link.source, link.target} <= self.nodes.keys():
                self._add_wire(link)
        self._links = network.links

    def _follow_backdrops(self, wanted: Sequence[Backdrop]) -> None:
        self._frames = [rect_of(backdrop) for backdrop in wanted]
        while len(self.backdrops) > len(wanted):
            self._scene.removeItem(self.backdrops.pop())
        for index, backdrop in enumerate(wanted):
            if index == len(self.backdrops):
                item = BackdropItem(index, backdrop, self.style)
                self.backdrops.append(item)
                self._scene.addItem(item)
            self.backdrops[index].show_backdrop(backdrop)

    def _add_wire(self, link: Link) -> None:
        source, target = self.nodes[link.source], self.nodes[link.target]
        output, entry = source.ports["output", link.output], target.ports["input", link.input]
        wire = WireItem(link, output, entry, self.style)
        if {link.source, link.target} & self._selected:
            wire.set_state(lit=True)
        self.wires[link] = wire
        for name in {link.source, link.target}:
            self._at.setdefault(name, []).append(wire)
            self.nodes[name].update()
        self._scene.addItem(wire)

    def _remove_wire(self, wire: WireItem) -> None:
        del self.wires[wire.link]
        for name in {wire.link.source, wire.link.target}:
            self._at[name].remove(wire)
        wire.forget()

    def _remove_node(self, name: str) -> None:
        for wire in list(self.wires_at(name)):
            self._remove_wire(wire)
        self._at.pop(name, None)
        self._drawn.pop(name, None)
        self._ground.drop(name)
        item = self.nodes.pop(name)
        item.ports.clear()
        self._scene.removeItem(item)


def links_at(network: Network) -> dict[str, list[Link]]:
    links: dict[str, list[Link]] = {}
    for link in network.links:
        for name in {link.source, link.target}:
            links.setdefault(name, []).append(link)
    return links


# Where nodes stand: as in the document, else in columns by their depth.

COLUMN, ROW = 240.0, 160.0


def points_of(network: Network) -> dict[str, Point]:
    """A point for every node; those without one stand below the others, each after its sources.

    A point that the canvas does not reach is none.
    """
    points: dict[str, Point] = {name: at for name, at in network.layout.items() if is_in_reach(*at)}
    lost = [name for name in network.nodes if name not in points]
    if not lost:
        return points
    depths = _depths(network)
    top = max((y for _, y in points.values()), default=-ROW) + ROW
    rows: dict[int, int] = {}
    for name in lost:
        depth = depths.get(name, 0)
        row = rows[depth] = rows.get(depth, -1) + 1
        points[name] = (depth * COLUMN, top + row * ROW)
    return points


def _depths(network: Network) -> dict[str, int]:
    depths: dict[str, int] = {}
    for name in topological(network.followers):
        for follower in network.followers[name]:
            depths[follower] = max(depths.get(follower, 0), depths.get(name, 0) + 1)
    return depths


_AWAY = 60.0  # of the plates from the nodes, for their wires
_HIGH, _PITCH, _PADDING = 32.0, 38.0, 12.0
_LETTERS = 21  # units: larger than a port's name, which nobody reads in the overview


class End(NamedTuple):
    name: str
    side: Side
    plate: QRectF
    wires: tuple[QPainterPath, ...]
    types: tuple[str, ...]


class MacroEnds(QGraphicsItem):
    def __init__(self, style: CanvasStyle) -> None:
        super().__init__()
        self.style = style
        self.ends: tuple[End, ...] = ()
        self._bounds = QRectF()
        self.setZValue(-1.5)  # behind the wires of the inside
        self.setAcceptedMouseButtons(Qt.MouseButton.NoButton)

    def follow(self, body: Network, nodes: Mapping[str, NodeItem], ground: Ground) -> None:
        """Stand left and right of the nodes, at the height of those they lead to."""
        face = face_of_macro(body)
        if not (face.inputs or face.outputs or self.ends):
            return
        frames = [node.frame() for node in nodes.values()]
        left = min((frame.left() for frame in frames), default=0.0) - _AWAY
        right = max((frame.right() for frame in frames), default=0.0) + _AWAY
        outputs = {name: (end,) for name, end in face.outputs.items()}
        self.prepareGeometryChange()
        self.ends, self._bounds = (), QRectF()
        for side, named, x in ((INPUT, face.inputs, left), (OUTPUT, outputs, right)):
            lowest = -math.inf
            for name, ports in _in_order(side, named, nodes):
                y = max(ports[0].centre().y(), lowest + _PITCH)
                end = self._end(name, side, QPointF(x, y), ports, ground)
                self.ends, lowest = (*self.ends, end), y
                for part in (end.plate, *(wire.controlPointRect() for wire in end.wires)):
                    self._bounds |= part.adjusted(-4, -4, 4, 4)
        self.update()

    def _end(
        self, name: str, side: Side, at: QPointF, ports: Sequence[NodePort], ground: Ground
    ) -> End:
        wide = self.style.metrics(_LETTERS).horizontalAdvance(name) + 2 * _PADDING
        plate = QRectF(at.x() - (wide if side == INPUT else 0), at.y() - _HIGH / 2, wide, _HIGH)
        wires = []
        for port in ports:
            start, end = (at, port.centre()) if side == INPUT else (port.centre(), at)
            course = course_of(start.toTuple(), end.toTuple(), ground, self.style.lane(port.types))
            wires.append(wire_path(start, end, course.lane))
        return End(name, side, plate, tuple(wires), ports[0].types)

    def boundingRect(self) -> QRectF:
        return self._bounds

    def paint(self, painter: QPainter, *_: Any) -> None:
        style = self.style
        painter.setFont(style.sized(_LETTERS))
        for end in self.ends:
            colour = style.port(end.types)
            painter.setPen(QPen(colour, 1.7, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            for wire in end.wires:
                painter.drawPath(wire)
            painter.setPen(QPen(colour, 1.4))
            painter.setBrush(style.node)
            painter.drawRoundedRect(end.plate, _HIGH / 2, _HIGH / 2)
            painter.setPen(style.text)
            painter.drawText(end.plate, Qt.AlignmentFlag.AlignCenter, end.name)
            x = end.plate.right() if end.side == INPUT else end.plate.left()
            painter.setBrush(colour)
            painter.drawEllipse(QPointF(x, end.plate.center().y()), PORT_RADIUS, PORT_RADIUS)


def _in_order(
    side: Side, named: Mapping[str, Sequence[tuple[str, str]]], nodes: Mapping[str, NodeItem]
) -> list[tuple[str, list[NodePort]]]:
    """The macro's ends with the ports they lead to, from the highest port down."""
    found = []
    for name, ends in named.items():
        ports = [nodes[node].ports.get((side, port)) for node, port in ends if node in nodes]
        found.append((name, [port for port in ports if port is not None]))
    there = [(name, ports) for name, ports in found if ports]
    return sorted(there, key=lambda one: one[1][0].centre().y())


_PORT_PX, _PORT_LEAST, _PORT_MOST = 9.0, 9.0, 26.0
_PORTS_FROM = 0.25  # below this zoom ports are too small to be picked
_WIRE_PX = 6.0
_DOT_PX = 8.0


@dataclass(frozen=True)
class Hit:
    """The foremost item under a point, or none. A port comes with its node, a dot with its wire."""

    port: NodePort | None = None
    node: NodeItem | None = None
    wire: WireItem | None = None
    backdrop: BackdropItem | None = None
    handle: bool = False
    dot: int | None = None


def hit(content: Content, point: QPointF, zoom: float) -> Hit:
    node = node_at(content, point)
    port = port_near(content, point, zoom)
    if port is not None and (node is None or node is port.node):
        return Hit(port=port, node=port.node)
    if node is not None:
        return Hit(node=node)
    dotted = dot_near(content, point, max(_DOT_PX / zoom, DOT_RADIUS))
    if dotted is not None:
        return Hit(wire=dotted[0], dot=dotted[1])
    for wire in wires_near(content, point, _WIRE_PX / zoom):
        return Hit(wire=wire)
    for backdrop in reversed(content.backdrops):
        if backdrop.handle().contains(point):
            return Hit(backdrop=backdrop, handle=True)
        if backdrop.head(zoom).contains(point):
            return Hit(backdrop=backdrop)
    return Hit()


def node_at(content: Content, point: QPointF) -> NodeItem | None:
    under_point = [item for item in content.nodes.values() if item.frame().contains(point)]
    return max(reversed(under_point), key=NodeItem.zValue, default=None)


def port_near(content: Content, point: QPointF, zoom: float) -> NodePort | None:
    if zoom / content.style.natural_zoom < _PORTS_FROM:
        return None
    reach = min(max(_PORT_PX / zoom, _PORT_LEAST), _PORT_MOST)
    near = [
        (away, port)
        for item in content.nodes.values()
        if item.frame().adjusted(-reach, -reach, reach, reach).contains(point)
        for port in item.ports.values()
        if (away := length(port.centre() - point)) <= reach
    ]
    return min(near, key=itemgetter(0))[1] if near else None


def dot_near(content: Content, point: QPointF, reach: float) -> tuple[WireItem, int] | None:
    """The nearest dot within reach: its wire, and its place on it."""
    near = [
        (away, wire, index)
        for wire in content.wires.values()
        if wire.isVisible()
        for index, dot in enumerate(wire.dots)
        if (away := length(dot - point)) <= reach
    ]
    return min(near, key=itemgetter(0))[1:] if near else None


def place_on_wire(wire: WireItem, point: QPointF) -> int:
    """Before which of its dots a point of a wire lies; their number where behind all."""
    line = wire.line()
    nearest = min(range(len(line)), key=lambda place: length(line[place] - point))
    places = [
        min(range(len(line)), key=lambda place: length(line[place] - dot)) for dot in wire.dots
    ]
    return sum(place < nearest for place in places)


def wires_near(content: Content, point: QPointF, reach: float) -> list[WireItem]:
    nearby = []
    for wire in content.wires.values():
        around = wire.boundingRect().adjusted(-reach, -reach, reach, reach)
        if wire.isVisible() and around.contains(point):
            away = distance(wire.line(), point)
            if away <= reach:
                nearby.append((away, wire))
    return [wire for _, wire in sorted(nearby, key=itemgetter(0))]


def wires_crossed(content: Content, start: QPointF, end: QPointF) -> list[WireItem]:
    area = QRectF(start, end).normalized().adjusted(-1, -1, 1, 1)
    return [
        wire
        for wire in content.wires.values()
        if wire.boundingRect().intersects(area) and _crossed(wire.line(), start, end)
    ]


def distance(line: list[QPointF], point: QPointF) -> float:
    best = float("inf")
    px, py = point.x(), point.y()
    for a, b in pairwise(line):
        ax, ay, dx, dy = a.x(), a.y(), b.x() - a.x(), b.y() - a.y()
        square = dx * dx + dy * dy
        t = 0.0 if not square else ((px - ax) * dx + (py - ay) * dy) / square
        t = min(max(t, 0.0), 1.0)
        away = (ax + t * dx - px) ** 2 + (ay + t * dy - py) ** 2
        best = min(best, away)
    return float(best**0.5)


def _crossed(line: list[QPointF], start: QPointF, end: QPointF) -> bool:
    return any(
        _side(start, end, a) * _side(start, end, b) <= 0
        and _side(a, b, start) * _side(a, b, end) <= 0
        for a, b in pairwise(line)
    )


def _side(a: QPointF, b: QPointF, point: QPointF) -> float:
    return (b.x() - a.x()) * (point.y() - a.y()) - (b.y() - a.y()) * (point.x() - a.x())


# Which wire and which backdrop are selected, and what the pointer is over: the view's alone.
#
# Held by their names in the document, never as items: items are replaced.


class Marks:
    """At most one wire, one dot of it, or one backdrop is selected; nodes are in the session."""

    def __init__(self, content: Content) -> None:
        self._content = content
        self._link: Link | None = None
        self._backdrop: int | None = None
        self._dot: int | None = None
        self._over_port: tuple[str, Side, str] | None = None
        self._over_wire: Link | None = None

    @property
    def link(self) -> Link | None:
        return self._link if self._link in self._content.wires else None

    @property
    def backdrop(self) -> BackdropItem | None:
        backdrops = self._content.backdrops
        index = self._backdrop
        return backdrops[index] if index is not None and index < len(backdrops) else None

    @property
    def dot(self) -> int | None:
        wire = self._content.wires.get(self._link) if self._link is not None else None
        there = wire is not None and self._dot is not None and self._dot < len(wire.dots)
        return self._dot if there else None

    def choose(
        self, link: Link | None, backdrop: BackdropItem | None, dot: int | None = None
    ) -> None:
        self._show_chosen(False)
        self._link, self._dot = link, dot
        self._backdrop = backdrop.index if backdrop is not None else None
        self._show_chosen(True)

    def hover(self, hit: Hit) -> None:
        port = hit.port
        over = (port.node.id, port.side, port.name) if port is not None else None
        if over != self._over_port:
            self._show_port(False)
            self._over_port = over
            self._show_port(True)
        link = hit.wire.link if hit.wire is not None else None
        if link != self._over_wire:
            self._show_wire(False)
            self._over_wire = link
            self._show_wire(True)

    def _show_chosen(self, on: bool) -> None:
        wire = self._content.wires.get(self._link) if self._link is not None else None
        if wire is not None:
            wire.chosen_dot = self._dot if on else None
            wire.set_state(chosen=on)
            wire.update()
        if self.backdrop is not None:
            self.backdrop.setSelected(on)
            self.backdrop.update()

    def _show_port(self, on: bool) -> None:
        if self._over_port is None:
            return
        name, side, port = self._over_port
        item = self._content.nodes.get(name)
        if item is not None and (side, port) in item.ports:
            item.ports[side, port].hovered = on
            item.update()

    def _show_wire(self, on: bool) -> None:
        wire = self._content.wires.get(self._over_wire) if self._over_wire is not None else None
        if wire is not None:
            wire.set_state(hovered=on)
