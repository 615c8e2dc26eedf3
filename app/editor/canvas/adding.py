"""The lists that add nodes and wires: search, what fits a loose wire, wiring by the keyboard."""

from collections.abc import Callable, Collection, Iterable, Iterator
from functools import partial
from operator import itemgetter
from typing import Any

from PySide6.QtCore import QPoint, QPointF
from PySide6.QtGui import QDropEvent

from app.editor.canvas.canvas_style import face_of, geometry_of
from app.editor.canvas.content import wires_near
from app.editor.canvas.gestures import Surface, whole
from app.editor.canvas.node_item import NodePort
from app.editor.canvas.overlays import Choice, ChoicePopup
from app.editor.canvas.wires import WireItem
from app.editor.gestures import local_files
from app.editor.library_view import dragged_module, found_by
from app.run.preset_files import KEY
from core.editing.backdrops import following
from core.editing.layout import GAP_X, Point, free_places, made_way
from core.editing.operations import Operation, move_nodes, rewire, together
from core.editing.wiring import (
    Bridge,
    Candidate,
    End,
    Side,
    bridged,
    continued,
    fitting,
    inserted,
    new_node,
    refusal,
    transform_behind,
    wired_behind,
    wired_to,
)
from core.errors import ImagechainError
from core.modules.declaration import Library, Port, declaration, local_key
from core.network.macro import declared_node
from core.network.network import Link, Network, Node, reached
from core.records import replace


class Adding:
    def __init__(self, surface: Surface, popup: ChoicePopup) -> None:
        self._surface = surface
        self._popup = popup
        self._loose: Link | None = None
        popup.chosen.connect(self._chosen)
        popup.abandoned.connect(self._abandoned)

    def dismiss(self) -> None:
        self._popup.dismiss()
        self._forget_wire()

    def search(self, at: Point) -> None:
        library = self._surface.session.library
        choices = [self._module_choice(key, partial(self.add, key, at)) for key in library]
        pixel = self._surface.view.pixel(QPointF(*at))
        self._popup.open_at(pixel, "Add a module", choices)

    def find_node(self) -> None:
        session, view = self._surface.session, self._surface.view
        choices = []
        for name, item in self._surface.content.nodes.items():
            colour = self._group_colour(item.face.group)
            module = f"{item.face.module} {session.network.nodes[name].module}"
            show, face = partial(self._show_node, name), item.face
            choices.append(Choice(name, show, face.module, module, face.summary, colour))
        if not choices:
            session.message.emit("note", "the network has no nodes to find yet")
            return
        room = view.viewport().rect()
        self._popup.open_at(QPoint(room.width() // 3, room.height() // 8), "Find a node", choices)

    def _show_node(self, name: str) -> None:
        surface, view = self._surface, self._surface.view
        if name in surface.content.nodes:
            surface.session.select([name])
            frame, seen = surface.content.nodes[name].frame(), view.visible_rect()
            fits = frame.width() < seen.width() and frame.height() < seen.height()
            (view.make_visible if fits else view.frame)(frame)

    def ask_for_wire(self, port: NodePort, loose: Link | None, pos: QPoint) -> None:
        """List the modules that fit a wire from a port that ended on empty ground.

        `loose` is the link the wire was before; it is taken away unless something takes its place.
        """
        surface = self._surface
        end: End = (port.node.id, port.name, port.side)
        other: Side = "input" if port.side == "output" else "output"
        point = surface.view.scene_point(pos)
        choices = [
            self._module_choice(
                candidate.module,
                partial(self._wire_to, end, candidate, point, loose),
                port=candidate.port,
            )
            for candidate in fitting(surface.session.library, port.types, other)
        ]
        if other == "input":
            choices += [
                self._remote_choice(end, bridge, point, loose)
                for bridge in bridged(surface.session.library, port.types)
            ]
        if loose is not None:
            choices.insert(0, Choice(f"Disconnect {loose}", self._disconnect_loose))
        elif not choices:
            kinds = " or ".join(port.types) or "a wire of unknown type"
            surface.session.message.emit("note", f"no module has an {other} for {kinds}")
            return
        start, finish = port.centre(), point
        if port.side == "input":
            start, finish = finish, start
        title = f"Wire {end[0]}.{end[1]} {'to' if other == 'input' else 'from'}"
        self._popup.open_at(pos, title, choices)
        self._loose = loose
        surface.live.show_wire(start, finish, surface.content.style.port(port.types))
        if loose is not None and loose in surface.content.wires:
            surface.content.wires[loose].setVisible(False)

    def connect_selected(self) -> None:
        surface = self._surface
        session = surface.session
        if not session.selection:
            session.message.emit("note", "first select the node that you want to wire")
            return
        possible = possible_links(session.network, session.library, session.selection)
        choices = [
            Choice(str(link), partial(session.do, rewire(add=(link,))), remark)
            for link, remark in possible.items()
        ]
        choices += [
            Choice(f"Disconnect {link}", partial(session.do, rewire(remove=(link,))))
            for link in session.network.links
            if {link.source, link.target} & set(session.selection)
        ]
        if not choices:
            session.message.emit("note", "there is nothing to wire the selected nodes to")
            return
        item = surface.content.nodes[session.selection[-1]]
        title = f"Wire {', '.join(session.selection[:3])}{' …' * (len(session.selection) > 3)}"
        surface.view.make_visible(item.frame())
        self._popup.open_at(surface.view.pixel(item.frame().bottomLeft()), title, choices)

    def _group_colour(self, group: str) -> str:
        theme = self._surface.content.style.theme
        return theme.groups.get(group, theme.line)

    def _module_choice(self, key: str, value: Callable[[], None], port: str = "") -> Choice:
        known = declaration(self._surface.session.library[key])
        _, summary, further = found_by(known)
        return Choice(
            text=known.title,
            value=value,
            detail=port or known.group,
            words=f"{key} {known.group} {known.explained}",
            further=f"{summary} {further}",
            colour=self._group_colour(known.group),
            tip=known.summary,
        )

    def _remote_choice(
        self, end: End, bridge: Bridge, point: QPointF, loose: Link | None
    ) -> Choice:
        transform, _, candidate = bridge
        title = declaration(self._surface.session.library[transform.module]).title
        wiring = partial(self._wire_behind, end, bridge, point, loose)
        choice = self._module_choice(candidate.module, wiring, port=f"after {title}")
        about = f"Its input is of type {candidate.port}: {title} is inserted first.\n{choice.tip}"
        return replace(choice, tip=about, remote=True)

    def add(self, key: str, at: Point) -> None:
        """Add a node at a point of the scene; with a node selected, wired on to that one."""
        session = self._surface.session
        name, operation = added(self._surface, key, at)
        if session.do(operation):
            show_new(self._surface, name)

    def _wire_to(self, end: End, candidate: Candidate, point: QPointF, loose: Link | None) -> None:
        """Wire a new node to an end, so that its port is where the wire was drawn to."""
        at = self._place(end, candidate, point)
        self._wire(loose, lambda network, library: wired_to(network, library, end, candidate, at))

    def _wire_behind(self, end: End, bridge: Bridge, point: QPointF, loose: Link | None) -> None:
        places = _two_places(self._surface, bridge, self._place(end, bridge[0], point))
        self._wire(
            loose, lambda network, library: wired_behind(network, library, end, bridge, places)
        )

    def _place(self, end: End, candidate: Candidate, point: QPointF) -> Point:
        surface = self._surface
        node = Node(local_key(candidate.module), candidate.module)
        face = face_of(node, declaration(surface.session.library[candidate.module]), ())
        side: Side = "input" if end[2] == "output" else "output"
        corner = point - geometry_of(face, surface.content.style).ports[side, candidate.port]
        return free_place(surface, candidate.module, (corner.x(), corner.y()))

    def _wire(
        self, loose: Link | None, wiring: Callable[[Network, Library], tuple[str, Operation]]
    ) -> None:
        surface, session = self._surface, self._surface.session
        removing = rewire(remove=(loose,) if loose is not None else ())
        try:
            name, operation = wiring(removing.apply(session.network), session.library)
        except ImagechainError as error:
            session.message.emit("error", str(error))
            return
        if session.do(together((removing, operation), operation.text)):
            show_new(surface, name)

    def _disconnect_loose(self) -> None:
        if self._loose is not None:
            self._surface.session.do(rewire(remove=(self._loose,)))

    def _chosen(self, value: Any) -> None:
        value()
        self._forget_wire()

    def _abandoned(self) -> None:
        self._disconnect_loose()
        self._forget_wire()

    def _forget_wire(self) -> None:
        link, self._loose = self._loose, None
        self._surface.live.setVisible(False)
        if link is not None and link in self._surface.content.wires:
            self._surface.content.wires[link].setVisible(True)


# Which wires some nodes could have, for the list that wires by the keyboard. Without Qt.


def possible_links(network: Network, library: Library, names: Collection[str]) -> dict[Link, str]:
    """Every link that fits, and what it would replace; first those into inputs that need one."""
    among = names if len(names) > 1 else network.nodes
    ours = set(names)
    possible = [
        found
        for source in among
        for target in among
        if source != target and ours & {source, target}
        for found in _between(network, library, source, target)
    ]
    return {link: remark for _, link, remark in sorted(possible, key=itemgetter(0))}


def _between(
    network: Network, library: Library, source: str, target: str
) -> Iterator[tuple[int, Link, str]]:
    taken = {link.input: link for link in network.links_into(target)}
    for output in _ports(network, library, source, "output"):
        for entry in _ports(network, library, target, "input"):
            link = Link(source, output.name, target, entry.name)
            old = taken.get(entry.name)
            if old == link or not set(output.types) & set(entry.types):
                continue
            if refusal(network, library, link) is None:
                remark = f"instead of {old.source}.{old.output}" if old is not None else ""
                yield 2 if old is not None else 0 if entry.required else 1, link, remark


def _ports(network: Network, library: Library, name: str, side: str) -> tuple[Port, ...]:
    known = declared_node(network.nodes[name], library)
    if known is None:
        return ()
    return known.inputs if side == "input" else known.outputs


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
        onward = continued(session.network, session.library, selected, module, beside)
        if onward is not None:
            return onward[0], _placed(surface, module, selected, *onward)
        if (behind := _added_behind(surface, module, selected, beside)) is not None:
            return behind
    point = free_place(surface, module, at)
    return new_node(session.network, session.library, module, point)


def _added_behind(
    surface: Surface, module: str, selected: str, at: Point
) -> tuple[str, Operation] | None:
    """A new node wired to the selected one by a transform; None where none leads to it."""
    network, library = surface.session.network, surface.session.library
    known = declared_node(network.nodes[selected], library)
    for port in known.outputs if known is not None else ():
        bridge = next((b for b in bridged(library, port.types) if b[2].module == module), None)
        if bridge is None:
            continue
        end: End = (selected, port.name, "output")
        if between := transform_behind(network, end, bridge[0]):
            onward = continued(network, library, between, module, at)
            return onward and (onward[0], _placed(surface, module, between, *onward))
        places = _two_places(surface, bridge, free_place(surface, bridge[0].module, at))
        return wired_behind(network, library, end, bridge, places)
    return None


def _two_places(surface: Surface, bridge: Bridge, first: Point) -> tuple[Point, Point]:
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
    grounds = following(network, pushed, sizes)  # else what is pushed leaves its backdrop
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
    name, adding = new_node(network, library, module, whole(point))
    insertion = _insertion(surface, adding.apply(network), name, (point,))
    if insertion is None:
        at = free_place(surface, module, whole(point))
        return None, *new_node(network, library, module, at)
    wire, leading = insertion
    inserting = together((adding, leading), adding.text)
    return wire, name, with_way_made(surface, inserting, name, size_of(surface, module))


def _insertion(
    surface: Surface, network: Network, name: str, places: Iterable[QPointF]
) -> Insertion | None:
    for place in places:
        for wire in wires_near(surface.content, place, _REACH_PX / surface.view.zoom):
            operation = inserted(network, surface.session.library, wire.link, name)
            if operation is not None:
                return wire, operation
    return None
