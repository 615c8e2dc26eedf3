"""Putting a node into a wire that it is dropped on."""

from __future__ import annotations

from PySide6.QtCore import QPointF

from app.editor.canvas.hands.new_nodes import free_place, size_of, with_way_made
from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.items.hits import wires_near
from app.editor.canvas.items.wire_item import WireItem
from core.editing.operations import Operation, Together
from core.editing.wiring import inserted, new_node

_REACH_PX = 12.0


def insertion_at(surface: Surface, name: str, point: QPointF) -> tuple[WireItem, Operation] | None:
    """The wire under the pointer, or else under the node's middle, and what leads it through.

    None where there is no wire that the node fits into.
    """
    session = surface.session
    item = surface.content.nodes[name]
    for place in (point, item.frame().center()):
        for wire in wires_near(surface.content, place, _reach(surface)):
            operation = inserted(session.network, session.library, wire.link, name)
            if operation is not None:
                return wire, operation
    return None


def added_at(surface: Surface, module: str, point: QPointF) -> tuple[str, Operation]:
    """A new node of a module, in the wire at the point if there is one that it fits into.

    Its neighbours there make way for it; elsewhere it stands on free ground.
    """
    session = surface.session
    at = (float(round(point.x())), float(round(point.y())))
    name, adding = new_node(session.network, session.library, module, at)
    insertion = _new_insertion(surface, name, adding, point)
    if insertion is None:
        free = free_place(surface, module, at)
        return new_node(session.network, session.library, module, free)
    inserting = Together((adding, insertion[1]), adding.text)
    return name, with_way_made(surface, inserting, name, size_of(surface, module))


def wire_for_new(surface: Surface, module: str, point: QPointF) -> WireItem | None:
    """The wire at the point that a new node of a module would be put into."""
    session = surface.session
    name, adding = new_node(session.network, session.library, module, None)
    insertion = _new_insertion(surface, name, adding, point)
    return insertion[0] if insertion else None


def _new_insertion(
    surface: Surface, name: str, adding: Operation, point: QPointF
) -> tuple[WireItem, Operation] | None:
    wires = wires_near(surface.content, point, _reach(surface))
    if not wires:
        return None
    grown = adding.apply(surface.session.network)
    for wire in wires:
        operation = inserted(grown, surface.session.library, wire.link, name)
        if operation is not None:
            return wire, operation
    return None


def _reach(surface: Surface) -> float:
    return _REACH_PX / surface.view.zoom
