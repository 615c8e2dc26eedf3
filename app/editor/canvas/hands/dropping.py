"""What is dropped on the canvas from elsewhere: modules of the library, files."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QMimeData, QPointF
from PySide6.QtGui import QDropEvent

from app.editor.canvas.hands.adding import free_place, size_of, with_way_made
from app.editor.canvas.hands.gestures import Surface, whole
from app.editor.canvas.items.hits import wires_near
from app.editor.canvas.items.wire_item import WireItem
from app.editor.library_view import dragged_module
from app.run.preset_files import KEY
from core.editing.operations import Operation, Together
from core.editing.wiring import inserted, new_node
from core.network.network import Link, Network


class Dropping:
    """Takes modules, which become nodes, and files, which the window opens."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self._over: Link | None = None

    def over(self, event: QDropEvent) -> bool:
        """Mark the wire that a module would be put into; whether anything can be dropped."""
        module = dragged_module(event.mimeData())
        if module in self._surface.session.library:
            wire = wire_for_new(self._surface, module, self._point(event))
            self._mark(wire.link if wire is not None else None)
            return True
        return module.startswith(KEY) or bool(_files(event.mimeData()))

    def left(self) -> None:
        self._mark(None)

    def drop(self, event: QDropEvent) -> bool:
        """Put it there; whether it could be."""
        self._mark(None)
        session, point = self._surface.session, self._point(event)
        module = dragged_module(event.mimeData())
        if module in session.library:
            name, operation = added_at(self._surface, module, point)
            if session.do(operation):
                session.select([name])
                self._surface.view.setFocus()
            return True
        if module.startswith(KEY):
            self._surface.preset_dropped.emit(module, point)
            return True
        paths = _files(event.mimeData())
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


def _files(data: QMimeData) -> list[str]:
    return [url.toLocalFile() for url in data.urls() if url.isLocalFile()]


# Putting a node into a wire that it is dropped on.

_REACH_PX = 12.0


Insertion = tuple[WireItem, Operation]


def insertion_at(surface: Surface, name: str, point: QPointF) -> Insertion | None:
    """The wire under the pointer, or else under the node's middle, and what leads it through.

    None where there is no wire that the node fits into.
    """
    middle = surface.content.nodes[name].frame().center()
    return _insertion(surface, surface.session.network, name, (point, middle))


def added_at(surface: Surface, module: str, point: QPointF) -> tuple[str, Operation]:
    """A new node of a module, in the wire at the point if there is one that it fits into.

    Its neighbours there make way for it; elsewhere it stands on free ground.
    """
    session, at = surface.session, whole(point)
    name, adding = new_node(session.network, session.library, module, at)
    insertion = _insertion(surface, adding.apply(session.network), name, (point,))
    if insertion is None:
        free = free_place(surface, module, at)
        return new_node(session.network, session.library, module, free)
    inserting = Together((adding, insertion[1]), adding.text)
    return name, with_way_made(surface, inserting, name, size_of(surface, module))


def wire_for_new(surface: Surface, module: str, point: QPointF) -> WireItem | None:
    session = surface.session
    name, adding = new_node(session.network, session.library, module, None)
    insertion = _insertion(surface, adding.apply(session.network), name, (point,))
    return insertion[0] if insertion else None


def _insertion(
    surface: Surface, network: Network, name: str, places: Iterable[QPointF]
) -> Insertion | None:
    for place in places:
        for wire in wires_near(surface.content, place, _REACH_PX / surface.view.zoom):
            operation = inserted(network, surface.session.library, wire.link, name)
            if operation is not None:
                return wire, operation
    return None
