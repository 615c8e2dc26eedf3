"""The items on the canvas, made to follow a network: only what differs is touched; what is hit."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import itemgetter
from typing import Any, NamedTuple

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene

from app.editor.canvas.canvas_style import INPUT, OUTPUT, PORT_RADIUS, CanvasStyle, Side, face_of
from app.editor.canvas.node_item import GAP_BESIDE, BackdropItem, NodeItem, NodePort, rect_of
from app.editor.canvas.wires import (
    DOT_RADIUS,
    Ground,
    WireItem,
    course_of,
    length,
    overlap,
    straight,
    wire_path,
)
from app.editor.evaluation.queries import Badge
from core.editing.backdrops import Backdrop, backdrops_of, dots_of
from core.editing.layout import Point, hull, is_in_reach
from core.modules.declaration import Library
from core.network.macro import SEPARATOR, declared_node, face_of_macro
from core.network.network import Link, Network, Node, topological
from core.records import dataclass


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
        touched: dict[str, list[Link]] = {}
        for link in network.links if links_differ else ():
            for name in {link.source, link.target}:
                touched.setdefault(name, []).append(link)
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
            wanted = set(network.links)
            for wire in [wire for link, wire in self.wires.items() if link not in wanted]:
                self._remove_wire(wire)
            for link in network.links:
                if link not in self.wires and {link.source, link.target} <= self.nodes.keys():
                    self._add_wire(link)
            self._links = network.links
            moved = True
        if network.extra is not self._extra or links_differ:
            dots = dots_of(network)
            moved = moved or dots != self._dots
            self._dots = dots
        if moved:
            self.route()
        if network.extra is not self._extra:
            self._extra, moved = network.extra, True
            self._follow_backdrops(backdrops_of(network))
        if moved:
            self._body = network
            self.ends.follow(network, self.nodes, self._ground)

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
        there = self._ground.boxes
        boxes = [*there.values()] if names is None else [there[n] for n in names if n in there]
        left, top, right, bottom = hull(boxes) if boxes else (0.0, 0.0, 0.0, 0.0)
        whole = QRectF(left, top, right - left, bottom - top)
        if names is None:
            for backdrop in self.backdrops:
                whole |= backdrop.frame()
            whole |= self.ends.boundingRect()
            for dot in (dot for wire in self.wires.values() for dot in wire.dots):
                whole |= QRectF(dot, dot).adjusted(-DOT_RADIUS, -DOT_RADIUS, DOT_RADIUS, DOT_RADIUS)
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
        items: list[NodeItem | WireItem | BackdropItem] = [*self.nodes.values(), *self.backdrops]
        for item in (*items, *self.wires.values()):
            item.set_style(style)

    def _follow_node(self, node: Node, links: list[Link]) -> None:
        declared = declared_node(node, self._library)
        face = face_of(node, declared, links, output=node.id in self._marked)
        old = self.nodes.get(node.id)
        if old is not None and old.take_face(face):
            self._drawn[node.id] = node
            for wire in self.wires_at(node.id) if old.face is face else ():
                wire.update()  # dashed at a disabled node
            return
        item = NodeItem(face, self.style)
        if old is not None:
            item.setPos(old.pos())
            self._remove_node(node.id)
        item.set_badge(self._badges.get(node.id))
        item.setSelected(node.id in self._selected)
        self._drawn[node.id] = node
        self.nodes[node.id] = item
        self._ground.put(node.id, item.box())
        self._scene.addItem(item)

    def _follow_backdrops(self, wanted: Sequence[Backdrop]) -> None:
        self._frames = [rect_of(backdrop) for backdrop in wanted]
        while len(self.backdrops) > len(wanted):
            self._scene.removeItem(self.backdrops.pop())
        for item, backdrop in zip(self.backdrops, wanted, strict=False):
            item.shown = backdrop
            item.place(rect_of(backdrop))
        for index in range(len(self.backdrops), len(wanted)):
            self.backdrops.append(BackdropItem(index, wanted[index], self.style))
            self._scene.addItem(self.backdrops[-1])

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
    depths: dict[str, int] = {}
    for name in topological(network.followers):
        for follower in network.followers[name]:
            depths[follower] = max(depths.get(follower, 0), depths.get(name, 0) + 1)
    top = max((y for _, y in points.values()), default=-ROW) + ROW
    rows: dict[int, int] = {}
    for name in lost:
        depth = depths.get(name, 0)
        row = rows[depth] = rows.get(depth, -1) + 1
        points[name] = (depth * COLUMN, top + row * ROW)
    return points


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
            led = {name: _ports(side, ends, nodes) for name, ends in named.items()}
            there = [(name, ports) for name, ports in led.items() if ports]
            y = -math.inf
            for name, ports in sorted(there, key=lambda one: one[1][0].centre().y()):
                y = max(ports[0].centre().y(), y + _PITCH)
                end = self._end(name, side, QPointF(x, y), ports, ground)
                self.ends = (*self.ends, end)
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
            beside = self.style.lane(port.types)
            lane, _ = course_of(start.toTuple(), end.toTuple(), ground, beside)
            wires.append(wire_path(start, end, lane))
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


def _ports(
    side: Side, ends: Sequence[tuple[str, str]], nodes: Mapping[str, NodeItem]
) -> list[NodePort]:
    places = ((nodes[node], (side, port)) for node, port in ends if node in nodes)
    return [node.ports[place] for node, place in places if place in node.ports]


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

    def place_of(spot: QPointF) -> int:
        return min(range(len(line)), key=lambda place: length(line[place] - spot))

    return sum(place_of(dot) < place_of(point) for dot in wire.dots)


def wires_near(content: Content, point: QPointF, reach: float) -> list[WireItem]:
    around = QRectF(point, point).adjusted(-reach, -reach, reach, reach)
    wires = [
        wire
        for wire in content.wires.values()
        if wire.isVisible() and wire.boundingRect().intersects(around)
    ]
    near: list[WireItem] = []
    for width in (0.6 * reach, 2 * reach):  # the nearest first
        near += [w for w in wires if w not in near and w.stroke(width).contains(point)]
    return near


def wires_crossed(content: Content, start: QPointF, end: QPointF) -> list[WireItem]:
    cut = straight(start, end)
    return [wire for wire in content.wires.values() if wire.stroke(0.1).intersects(cut)]


class Marks:
    """What the view alone knows: at most one wire, a dot of it, or one backdrop is selected.

    Held by their names in the document, never as items: items are replaced.
    """

    def __init__(self, content: Content) -> None:
        self._content = content
        self._link: Link | None = None
        self._backdrop: int | None = None
        self._dot: int | None = None
        self._over_port: tuple[str, tuple[Side, str]] | None = None
        self._over_wire: Link | None = None

    @property
    def wire(self) -> WireItem | None:
        return self._content.wires.get(self._link) if self._link is not None else None

    @property
    def link(self) -> Link | None:
        return self.wire.link if self.wire is not None else None

    @property
    def backdrop(self) -> BackdropItem | None:
        backdrops, index = self._content.backdrops, self._backdrop
        return backdrops[index] if index is not None and index < len(backdrops) else None

    @property
    def dot(self) -> int | None:
        there = len(self.wire.dots) if self.wire is not None else 0
        return self._dot if self._dot is not None and self._dot < there else None

    def choose(
        self, link: Link | None, backdrop: BackdropItem | None, dot: int | None = None
    ) -> None:
        self._show_chosen(False)
        self._link, self._dot = link, dot
        self._backdrop = backdrop.index if backdrop is not None else None
        self._show_chosen(True)

    def hover(self, hit: Hit) -> None:
        port = hit.port
        over_port = (port.node.id, (port.side, port.name)) if port is not None else None
        over_wire = hit.wire.link if hit.wire is not None else None
        if (over_port, over_wire) != (self._over_port, self._over_wire):
            self._show_hovered(False)
            self._over_port, self._over_wire = over_port, over_wire
            self._show_hovered(True)

    def _show_chosen(self, on: bool) -> None:
        if self.wire is not None:
            self.wire.chosen_dot = self._dot if on else None
            self.wire.set_state(chosen=on)
            self.wire.update()
        if self.backdrop is not None:
            self.backdrop.setSelected(on)
            self.backdrop.update()

    def _show_hovered(self, on: bool) -> None:
        name, place = self._over_port or ("", None)
        item = self._content.nodes.get(name)
        if item is not None and place in item.ports:
            item.ports[place].hovered = on
            item.update()
        if self._over_wire in self._content.wires:
            self._content.wires[self._over_wire].set_state(hovered=on)
