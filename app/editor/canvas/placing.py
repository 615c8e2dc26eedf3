"""Where the parts of the canvas meet, and where new nodes come: on free ground, or in a wire."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QObject, QPoint, QPointF, Signal
from PySide6.QtGui import QDropEvent

from app.editor.canvas.canvas_style import face_of, geometry_of
from app.editor.canvas.canvas_view import GraphView
from app.editor.canvas.content import Content, Hit, Marks, hit, wires_near
from app.editor.canvas.wires import LiveWire, WireItem
from app.editor.library_view import dragged_module
from app.editor.session import Level
from app.editor.widgets import local_files
from app.run.preset_files import KEY
from core.editing import backdrops, wiring
from core.editing.layout import GAP_X, Point, free_places, made_way
from core.editing.operations import Operation, move_nodes, together
from core.modules.declaration import declaration
from core.network.macro import declared_node
from core.network.network import Link, Network, Node, reached


class Surface(QObject):
    activated = Signal(str)  # (name): a node was double-clicked, or Enter pressed on it
    view_wanted = Signal(str)  # (name): a node was clicked with Ctrl and Shift
    search_wanted = Signal(QPointF)  # (point): a module is to be added at that point of the scene
    title_wanted = Signal(int)  # (index): a backdrop's title is to be edited
    # (paths, point): files were dropped at a point of the scene
    files_dropped = Signal(list, QPointF)
    preset_dropped = Signal(str, QPointF)  # (key, point): a preset of the library was dropped there

    def __init__(self, session: Level, view: GraphView, content: Content, parent: QObject) -> None:
        super().__init__(parent)
        self.session, self.view, self.content = session, view, content
        self.marks = Marks(content)
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


# New nodes: on free ground, behind the selected one, or in a wire whose ends make way.

Size = tuple[float, float]


def show_new(surface: Surface, name: str) -> None:
    """Select a new node, and pan so that all of it is seen."""
    surface.session.select([name])
    surface.view.make_visible(surface.content.nodes[name].frame())


def size_of(surface: Surface, module: str) -> Size:
    known = declaration(surface.session.library[module])
    geometry = geometry_of(face_of(Node(module, module), known, ()), surface.content.style)
    return geometry.width, geometry.height


def free_place(surface: Surface, module: str, at: Point) -> Point:
    """The point, or the nearest at which a new node of the module stands on no other."""
    network, sizes = surface.session.network, surface.content.sizes()
    size = {"": size_of(surface, module)}
    return whole(QPointF(*free_places({"": at}, size, network, sizes)[""]))


def added(surface: Surface, module: str, at: Point) -> tuple[str, Operation]:
    """A new node on free ground; with a node selected, wired on to it and beside it."""
    session = surface.session
    for selected in session.selection[-1:]:
        frame = surface.content.nodes[selected].frame()
        beside = (frame.right() + GAP_X, frame.top())
        onward = wiring.continued(session.network, session.library, selected, module, beside)
        if onward is not None:
            return onward[0], _placed(surface, module, selected, *onward)
        if (behind := _added_behind(surface, module, selected, beside)) is not None:
            return behind
    point = free_place(surface, module, at)
    return wiring.new_node(session.network, session.library, module, point)


def _added_behind(
    surface: Surface, module: str, selected: str, at: Point
) -> tuple[str, Operation] | None:
    """A new node wired to the selected one by a transform; None where none leads to it."""
    network, library = surface.session.network, surface.session.library
    known = declared_node(network.nodes[selected], library)
    for port in known.outputs if known is not None else ():
        bridge = next(
            (b for b in wiring.bridged(library, port.types) if b[2].module == module), None
        )
        if bridge is None:
            continue
        end: wiring.End = (selected, port.name, "output")
        if between := wiring.transform_behind(network, end, bridge[0]):
            onward = wiring.continued(network, library, between, module, at)
            return onward and (onward[0], _placed(surface, module, between, *onward))
        places = two_places(surface, bridge, free_place(surface, bridge[0].module, at))
        return wiring.wired_behind(network, library, end, bridge, places)
    return None


def two_places(surface: Surface, bridge: wiring.Bridge, first: Point) -> tuple[Point, Point]:
    """Of a transform, and of the node behind it."""
    transform, _, candidate = bridge
    beside = first[0] + size_of(surface, transform.module)[0] + GAP_X, first[1]
    return first, free_place(surface, candidate.module, beside)


def with_way_made(
    surface: Surface, operation: Operation, name: str, size: Size | None = None
) -> Operation:
    """Put a node into a wire, neighbours out of its way; `size`: of one not there yet."""
    network = operation.apply(surface.session.network)
    sizes = surface.content.sizes() | ({name: size} if size is not None else {})
    behind = reached(network.followers, {name}) - {name}
    places = made_way(network, sizes, name, network.layout[name], behind)
    pushed = {node: whole(QPointF(*at)) for node, at in places.items()}
    if not pushed:
        return operation
    grounds = backdrops.following(network, pushed, sizes)  # else what is pushed leaves its backdrop
    parts = (operation, move_nodes(pushed), *(() if grounds is None else (grounds,)))
    return together(parts, operation.text)


def _placed(
    surface: Surface, module: str, selected: str, name: str, operation: Operation
) -> Operation:
    grown: Network = operation.apply(surface.session.network)
    size = size_of(surface, module)
    feeding = any(link.target == selected and link.source == name for link in grown.links)
    if grown.followers[name] and not feeding:
        return with_way_made(surface, operation, name, size)
    frame = surface.content.nodes[selected].frame()
    left = frame.left() - GAP_X - size[0] if feeding else frame.right() + GAP_X
    at = free_place(surface, module, (left, frame.top()))
    return together((operation, move_nodes({name: at})), operation.text)


class Dropping:
    """Takes modules, which become nodes, and files and presets, which the window opens."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self._over: Link | None = None

    def over(self, event: QDropEvent) -> bool:
        module = dragged_module(event.mimeData())
        if module in self._surface.session.library:
            wire, *_ = added_at(self._surface, module, self._point(event))
            self._mark(wire.link if wire is not None else None)
            return True
        return module.startswith(KEY) or bool(local_files(event.mimeData()))

    def left(self) -> None:
        self._mark(None)

    def drop(self, event: QDropEvent) -> bool:
        self._mark(None)
        session, point = self._surface.session, self._point(event)
        module = dragged_module(event.mimeData())
        if module in session.library:
            _, name, operation = added_at(self._surface, module, point)
            if session.do(operation):
                show_new(self._surface, name)
                self._surface.view.setFocus()
            return True
        if module.startswith(KEY):
            self._surface.preset_dropped.emit(module, point)
            return True
        paths = local_files(event.mimeData())
        if paths:
            self._surface.files_dropped.emit(paths, point)
        return bool(paths)

    def _point(self, event: QDropEvent) -> QPointF:
        return self._surface.view.scene_point(event.position())

    def _mark(self, link: Link | None) -> None:
        wires = self._surface.content.wires
        for marked, on in ((self._over, False), (link, True)):
            if marked is not None and marked in wires:
                wires[marked].set_state(target=on)
        self._over = link


_REACH_PX = 12.0


Insertion = tuple[WireItem, Operation]


def insertion_at(surface: Surface, name: str, point: QPointF) -> Insertion | None:
    """The wire under the pointer, or under the node's middle, and what leads the node in."""
    middle = surface.content.nodes[name].frame().center()
    return _insertion(surface, surface.session.network, name, (point, middle))


def added_at(
    surface: Surface, module: str, point: QPointF
) -> tuple[WireItem | None, str, Operation]:
    """A new node, in the wire at the point if it fits into one, else on free ground."""
    network, library = surface.session.network, surface.session.library
    name, adding = wiring.new_node(network, library, module, whole(point))
    insertion = _insertion(surface, adding.apply(network), name, (point,))
    if insertion is None:
        at = free_place(surface, module, whole(point))
        return None, *wiring.new_node(network, library, module, at)
    wire, leading = insertion
    inserting = together((adding, leading), adding.text)
    return wire, name, with_way_made(surface, inserting, name, size_of(surface, module))


def _insertion(
    surface: Surface, network: Network, name: str, places: Iterable[QPointF]
) -> Insertion | None:
    for place in places:
        for wire in wires_near(surface.content, place, _REACH_PX / surface.view.zoom):
            operation = wiring.inserted(network, surface.session.library, wire.link, name)
            if operation is not None:
                return wire, operation
    return None
