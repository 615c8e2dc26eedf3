"""New nodes: on free ground, behind the selected one, or in a wire whose ends make way."""

from __future__ import annotations

from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.items.faces import face_of
from app.editor.canvas.items.geometry import geometry_of
from core.editing.backdrops import following
from core.editing.layout import Point
from core.editing.links import reached_from
from core.editing.operations import Move, Operation, Together
from core.editing.room import GAP_X, free_places, made_way
from core.editing.wiring import continued, new_node
from core.modules.declaration import declaration
from core.network.network import Network, Node

Size = tuple[float, float]


def size_of(surface: Surface, module: str) -> Size:
    """Width and height that a new node of a module will have."""
    known = declaration(surface.session.library[module])
    geometry = geometry_of(face_of(Node(module, module), known, ()), surface.content.style)
    return geometry.width, geometry.height


def free_place(surface: Surface, module: str, at: Point) -> Point:
    """The point, or the nearest at which a new node of the module stands on no other."""
    network, sizes = surface.session.network, surface.content.sizes()
    size = {"": size_of(surface, module)}
    x, y = free_places({"": at}, size, network, sizes)[""]
    return float(round(x)), float(round(y))


def added(surface: Surface, module: str, at: Point) -> tuple[str, Operation]:
    """A new node on free ground; with a node selected, wired on to it and beside it."""
    session = surface.session
    for selected in session.selection[-1:]:
        frame = surface.content.nodes[selected].frame()
        beside = (frame.right() + GAP_X, frame.top())
        onward = continued(session.network, session.library, selected, module, beside)
        if onward is not None:
            return onward[0], _placed(surface, module, selected, *onward)
    point = free_place(surface, module, at)
    return new_node(session.network, session.library, module, point)


def with_way_made(
    surface: Surface, operation: Operation, name: str, size: Size | None = None
) -> Operation:
    """The operation that puts a node into a wire, with the neighbours moved out of its way.

    `size` is that of a node that is not on the canvas yet.
    """
    network = operation.apply(surface.session.network)
    sizes = surface.content.sizes() | ({name: size} if size is not None else {})
    behind = reached_from(network, {name}) - {name}
    places = made_way(network, sizes, name, network.layout[name], behind)
    whole = {node: (float(round(x)), float(round(y))) for node, (x, y) in places.items()}
    if not whole:
        return operation
    grounds = following(network, whole, sizes)  # else what is pushed leaves its backdrop
    parts = (operation, Move(dict(whole)), *(() if grounds is None else (grounds,)))
    return Together(parts, operation.text)


def _placed(
    surface: Surface, module: str, selected: str, name: str, operation: Operation
) -> Operation:
    """What adds it, with a place that suits its wires."""
    grown: Network = operation.apply(surface.session.network)
    size = size_of(surface, module)
    if any(link.target == selected and link.source == name for link in grown.links):
        frame = surface.content.nodes[selected].frame()
        at = free_place(surface, module, (frame.left() - GAP_X - size[0], frame.top()))
        return Together((operation, Move({name: at})), operation.text)
    if grown.followers[name]:
        return with_way_made(surface, operation, name, size)
    frame = surface.content.nodes[selected].frame()
    at = free_place(surface, module, (frame.right() + GAP_X, frame.top()))
    return Together((operation, Move({name: at})), operation.text)
