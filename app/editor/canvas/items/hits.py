"""What of the content lies under a point, by geometry alone."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter

from PySide6.QtCore import QPointF, QRectF

from app.editor.canvas.items.canvas_style import Side
from app.editor.canvas.items.content import Content
from app.editor.canvas.items.node_item import BackdropItem, NodeItem, NodePort
from app.editor.canvas.items.wires import DOT_RADIUS, WireItem, length
from core.network.network import Link

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
